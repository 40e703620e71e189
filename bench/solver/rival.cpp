#include "bench/solver/rival.h"

#include "bench/solver/bands.h"
#include "runtime/seconds_since.h"
#include "runtime/trace/clones.h"

#include <fftw3.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace gradus::bench {

namespace {

/// A row of the right side, but for the differences to the rows above and below.
GRADUS_CLONES void add_row(float *b, const float *primal, const float *dx, std::size_t width, float alpha2) {
    b[0] = alpha2 * primal[0] - (width > 1 ? dx[0] : 0.0f);
    for (std::size_t x = 1; x + 1 < width; ++x)
        b[x] = alpha2 * primal[x] + (dx[x - 1] - dx[x]);
    if (width > 1)
        b[width - 1] = alpha2 * primal[width - 1] + dx[width - 2];
}

GRADUS_CLONES void add_scaled(float *b, const float *a, std::size_t count, float factor) {
    for (std::size_t i = 0; i < count; ++i)
        b[i] += factor * a[i];
}

GRADUS_CLONES void divide_row(float *b, const float *eigenvalues, std::size_t count, float offset, float norm) {
    for (std::size_t i = 0; i < count; ++i)
        b[i] *= norm / (eigenvalues[i] + offset);
}

std::vector<float> eigenvalues(std::uint32_t size) {
    std::vector<float> values(size);
    for (std::uint32_t i = 0; i < size; ++i)
        values[i] = float(2 - 2 * std::cos(std::numbers::pi * i / size));
    return values;
}

struct Transforms {
    fftwf_plan forward = nullptr, backward = nullptr;
    std::uint32_t calls = 1; ///< for all channels
};

} // namespace

struct Rival::Implementation {
    std::uint32_t width, height, channels;
    int threads;
    std::vector<float> eigenvalues_x, eigenvalues_y;
    float *values; ///< right side, transform and result in one place: the least traffic
    Transforms together, apart;
    bool takes_together = true;
    double planning_seconds = 0;

    std::size_t pixels() const { return std::size_t(width) * height; }
    Transforms plan(std::uint32_t calls) {
        const int sizes[] = {int(height), int(width)};
        const fftwf_r2r_kind forward[] = {FFTW_REDFT10, FFTW_REDFT10}, backward[] = {FFTW_REDFT01, FFTW_REDFT01};
        const auto make = [&](const fftwf_r2r_kind *kinds) {
            return fftwf_plan_many_r2r(2, sizes, int(channels / calls), values, nullptr, 1, int(pixels()), values,
                                       nullptr, 1, int(pixels()), kinds,
                                       FFTW_MEASURE |
                                           (pixels() % 16 ? FFTW_UNALIGNED : 0)); // the other channels' place
        };
        return {make(forward), make(backward), calls};
    }
    void build_right_side(const HostImages &images, float alpha2) {
        in_bands(std::size_t(channels) * height, threads, [&](std::size_t first, std::size_t last) {
            for (std::size_t row = first; row < last; ++row) {
                float *b = values + row * width;
                const float *dy = images.dy + row * width;
                add_row(b, images.primal + row * width, images.dx + row * width, width, alpha2);
                if (row % height > 0)
                    add_scaled(b, dy - width, width, 1);
                if (row % height + 1 < height)
                    add_scaled(b, dy, width, -1);
            }
        });
    }
    void divide(float alpha2) {
        const float norm = float(1 / (4.0 * double(width) * height)); // FFTW's transforms are not normalised
        in_bands(std::size_t(channels) * height, threads, [&](std::size_t first, std::size_t last) {
            for (std::size_t row = first; row < last; ++row)
                divide_row(values + row * width, eigenvalues_x.data(), width, alpha2 + eigenvalues_y[row % height],
                           norm);
        });
    }
    void transform(fftwf_plan plan, std::uint32_t calls) {
        for (std::uint32_t c = 0; c < calls; ++c)
            fftwf_execute_r2r(plan, values + c * pixels(), values + c * pixels());
    }
    void solve(const HostImages &images, double alpha, const Transforms &transforms) {
        const float alpha2 = float(alpha * alpha);
        build_right_side(images, alpha2);
        transform(transforms.forward, transforms.calls);
        divide(alpha2);
        transform(transforms.backward, transforms.calls);
    }
    double seconds_of(const Transforms &transforms) {
        const std::vector<float> zeros(channels * pixels());
        HostImages images;
        images.primal = images.dx = images.dy = zeros.data();
        double least = std::numeric_limits<double>::infinity();
        for (int turn = 0; turn < 5; ++turn) {
            const auto start = std::chrono::steady_clock::now();
            solve(images, 1, transforms);
            least = std::min(least, seconds_since(start));
        }
        return least;
    }
};

Rival::Rival(std::uint32_t width, std::uint32_t height, std::uint32_t channels, int threads)
    : implementation_(new Implementation{
          width, height, channels, threads, eigenvalues(width), eigenvalues(height), nullptr, {}, {}, true, 0}) {
    Implementation &i = *implementation_;
    const auto start = std::chrono::steady_clock::now();
    fftwf_init_threads();
    fftwf_plan_with_nthreads(threads);
    i.values = fftwf_alloc_real(channels * i.pixels());
    i.together = i.plan(1);
    i.apart = i.plan(channels);
    i.takes_together = i.seconds_of(i.together) <= i.seconds_of(i.apart);
    i.planning_seconds = seconds_since(start);
}

Rival::~Rival() {
    for (const Transforms *t : {&implementation_->together, &implementation_->apart}) {
        fftwf_destroy_plan(t->forward);
        fftwf_destroy_plan(t->backward);
    }
    fftwf_free(implementation_->values);
}

const float *Rival::solve(const HostImages &images, double alpha) {
    Implementation &i = *implementation_;
    i.solve(images, alpha, i.takes_together ? i.together : i.apart);
    return i.values;
}

const char *Rival::way() const {
    return implementation_->takes_together ? "all channels in one transform" : "channel by channel";
}

double Rival::planning_seconds() const { return implementation_->planning_seconds; }

} // namespace gradus::bench
