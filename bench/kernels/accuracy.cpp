// Errors of the float and relaxed builds of kernels/lib, on the device, against the double build of the same source on
// the same device with the same arguments, which float holds exactly; and what each build does in a second.
#include "bench/kernels/interleaved.h"
#include "bench/kernels/measured_function.h"
#include "bench/kernels/measurements.h"
#include "bench/spread.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace gradus::bench {

namespace {

/// One build of a function's kernel with room for so many cases.
class Build {
  public:
    Build(Device &device, const MeasuredFunction &function, Precision precision, std::size_t arguments,
          std::size_t cases)
        : device_(device), precision_(precision), cases_(cases), arguments_(arguments),
          results_(function.result_columns), in_(device, "in", real_bytes(precision) * arguments * cases),
          out_(device, "out", real_bytes(precision) * function.result_columns * cases),
          kernel_(KernelLibrary(device, {}, precision)
                      .build({{function.name, function.file, function.entry, function.definitions}})
                      .front()) {
        kernel_.bind(in_);
        kernel_.bind(out_);
        kernel_.set("count", static_cast<std::uint32_t>(cases));
    }

    Columns run(const Columns &arguments) {
        if (precision_ == Precision::double_)
            fill<double>(arguments);
        else
            fill<float>(arguments);
        kernel_.launch(cases_);
        finish(device_);
        return precision_ == Precision::double_ ? results<double>() : results<float>();
    }

    /// Of one more launch.
    double seconds() {
        kernel_.reset_usage();
        kernel_.launch(cases_);
        return kernel_.usage().seconds;
    }

  private:
    template <class Real>
    void fill(const Columns &arguments) {
        const auto view = in_.map(Access::write);
        for (std::size_t c = 0; c < arguments_; ++c)
            std::copy(arguments[c].begin(), arguments[c].end(), view.as<Real>() + c * cases_);
    }
    template <class Real>
    Columns results() {
        const auto view = out_.map(Access::read);
        Columns columns(results_);
        for (std::size_t c = 0; c < results_; ++c)
            columns[c].assign(view.as<Real>() + c * cases_, view.as<Real>() + (c + 1) * cases_);
        return columns;
    }

    Device &device_;
    Precision precision_;
    std::size_t cases_, arguments_, results_;
    Buffer in_, out_;
    Kernel kernel_;
};

/// One unit in the last place of a float of this size.
double ulp(double value) {
    const int exponent = std::max(std::ilogb(std::max(std::fabs(value), 1e-37)), -126);
    return std::ldexp(1.0, exponent - 23);
}

/// The errors of one output in one domain.
struct Errors {
    std::vector<double> relative, ulps;
    std::size_t other_way = 0, non_finite = 0;

    static double quantile(std::vector<double> &values, double share) {
        if (values.empty())
            return 0;
        const auto place = values.begin() + std::ptrdiff_t(share * double(values.size() - 1));
        std::nth_element(values.begin(), place, values.end());
        return *place;
    }
};

Errors compare(const Output &output, std::size_t choice, const Columns &results, const Columns &exact,
               const std::vector<bool> &remain) {
    Errors errors;
    for (std::size_t i = 0; i < remain.size(); ++i) {
        if (!remain[i])
            continue;
        double difference = 0, size = 0;
        for (std::size_t c = output.column; c < output.column + output.width; ++c) {
            difference = std::hypot(difference, results[c][i] - exact[c][i]);
            size = std::hypot(size, exact[c][i]);
        }
        if (!std::isfinite(difference)) {
            ++errors.non_finite;
            continue;
        }
        if (output.has_choice && std::fabs(results[choice][i] - exact[choice][i]) > 1e-6) {
            ++errors.other_way;
            continue;
        }
        if (!output.is_absolute && size <= output.floor)
            continue;
        const double scale = output.is_absolute ? 1 : size;
        errors.relative.push_back(difference / scale);
        errors.ulps.push_back(difference / ulp(scale));
    }
    return errors;
}

} // namespace

nlohmann::json measure_accuracy(const Settings &settings) {
    fmt::print("\nErrors against the double build: 99.9 % of cases and the largest, relative (directions and warps: "
               "absolute), and in units in the last place\n  {:<24} {:<20} {:<31} {:<8} {:>8} {:>8} {:>9} {:>9}\n",
               "function", "result", "domain", "build", "99.9 %", "largest", "99.9 % ULP", "largest");
    nlohmann::json rows = nlohmann::json::array(), rates = nlohmann::json::array();
    for (const MeasuredFunction &f : measured_functions(settings.kinds)) {
        std::mt19937_64 random(17);
        const std::size_t arguments = f.domains.front().draw(random).size(), cases = settings.cases;
        Build single(settings.device, f, Precision::single, arguments, cases);
        Build relaxed(settings.device, f, Precision::relaxed, arguments, cases);
        Build exact(settings.device, f, Precision::double_, arguments, cases);
        bool is_inside = true;
        for (const MeasuredFunction::Domain &domain : f.domains) {
            Columns in(arguments, std::vector<double>(cases));
            for (std::size_t i = 0; i < cases; ++i) {
                const std::vector<double> row = domain.draw(random);
                for (std::size_t c = 0; c < arguments; ++c)
                    in[c][i] = row[c];
            }
            std::vector<bool> remain(cases, true);
            if (domain.is_adjusted)
                f.adjust(in, exact.run(in));
            for (std::size_t i = 0; is_inside && f.is_edge && i < cases; ++i)
                remain[i] = !f.is_edge(in, i);
            const Columns truth = exact.run(in);
            for (auto &[name, build] : {std::pair<const char *, Build *>("float", &single), {"relaxed", &relaxed}}) {
                const Columns results = build->run(in);
                for (const Output &output : f.outputs) {
                    Errors errors = compare(output, f.choice, results, truth, remain);
                    if (errors.relative.empty() && errors.non_finite == 0)
                        continue; // a Dirac kind has no value
                    const double most = Errors::quantile(errors.relative, 0.999),
                                 largest = Errors::quantile(errors.relative, 1),
                                 most_ulp = Errors::quantile(errors.ulps, 0.999),
                                 largest_ulp = Errors::quantile(errors.ulps, 1);
                    rows.push_back({{"function", f.name},
                                    {"result", output.name},
                                    {"domain", domain.name},
                                    {"is_edge", !is_inside},
                                    {"build", name},
                                    {"cases", errors.relative.size()},
                                    {"relative_99.9", most},
                                    {"relative_largest", largest},
                                    {"ulp_99.9", most_ulp},
                                    {"ulp_largest", largest_ulp},
                                    {"other_way", errors.other_way},
                                    {"non_finite", errors.non_finite}});
                    fmt::print("  {:<24} {:<20} {:<31} {:<8} {:>8.1e} {:>8.1e} {:>9.3g} {:>9.3g}{}\n", f.name,
                               output.name, domain.name, name, most, largest, most_ulp, largest_ulp,
                               errors.non_finite ? fmt::format("  {} not finite", errors.non_finite) : "");
                }
            }
            is_inside = false;
        }
        const auto seconds = run_interleaved({{"float", [&] { return single.seconds(); }},
                                              {"relaxed", [&] { return relaxed.seconds(); }},
                                              {"double", [&] { return exact.seconds(); }}},
                                             settings.repeats);
        nlohmann::json rate = {{"function", f.name}};
        for (const auto &[build, of] : seconds)
            rate["items_per_second"][build] = double(cases) / median(of);
        rates.push_back(rate);
    }
    return {{"errors", rows}, {"rates", rates}};
}

} // namespace gradus::bench
