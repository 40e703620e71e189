// Stratified random numbers: their strata, that they are uniform, and that pixels and dimensions do not know each
// other; and the choices that are made with them.
#define TRAIT_STRATIFIED 1
#define TRAIT_LOBE_LEVELS 1
#include "tests/kernels/precision.h"
#include "tests/support/chi_square.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <vector>

// After GoogleTest, which has template parameters of the names of its macros.
#include "kernels/lib/bsdf_dielectric.h"
#include "kernels/lib/stratified.h"

using namespace gradus::testing;

namespace {

constexpr int chi_square_tests = 4 + 6 + 3;

std::array<double, 4> draw(std::uint32_t pixel, std::uint32_t number, std::uint32_t dimension) {
    const lib::random_bits key = lib::random_key(1, 0, pixel, 0, 0);
    const lib::random4 u = lib::stratified_draw(key.x, number, dimension);
    return {double(u.a), double(u.b), double(u.c), double(u.d)};
}

int cell(double u, int cells) { return int(u * cells); }

} // namespace

// 2^m samples from a multiple of 2^m on: one in each rectangle of 2^-k by 2^-(m - k), for every k.
TEST(Stratified, PairsOfSamplesAreNets) {
    for (std::uint32_t pixel : {0u, 3u, 70001u})
        for (std::uint32_t dimension : {0u, 1u, 2u, 9u})
            for (int m = 0; m <= 10; ++m)
                for (std::uint32_t block : {0u, 1u, 5u})
                    for (int pair : {0, 2})
                        for (int k = 0; k <= m; ++k) {
                            std::vector<int> found(std::size_t(1) << m);
                            for (std::uint32_t i = 0; i < 1u << m; ++i) {
                                const auto u = draw(pixel, (block << m) + i, dimension);
                                ++found[std::size_t(cell(u[std::size_t(pair)], 1 << k) << (m - k)) +
                                        std::size_t(cell(u[std::size_t(pair) + 1], 1 << (m - k)))];
                            }
                            for (const int count : found)
                                ASSERT_EQ(count, 1)
                                    << "pixel " << pixel << ", dimension " << dimension << ", 2^" << m << " samples";
                        }
}

// One sample each of many pixels, by number.
TEST(Stratified, EachSampleIsUniform) {
    constexpr int cells = 1024, pixels = 200'000;
    for (std::uint32_t number : {0u, 1u, 6u, 1000u}) {
        std::vector<double> counts(cells);
        for (std::uint32_t pixel = 0; pixel < pixels; ++pixel)
            for (const double u : draw(pixel, number, 2)) // four independent numbers
                counts[std::size_t(cell(u, cells))] += 1;
        EXPECT_GT(chi_square(counts, std::vector<double>(cells, 4.0 * pixels / cells)).p_value,
                  sidak_level(1e-3, chi_square_tests))
            << "sample " << number;
    }
}

// Any two numbers of a draw, of one sample each of many pixels.
TEST(Stratified, NumbersOfADrawAreIndependent) {
    constexpr int cells = 32, pixels = 200'000;
    for (std::size_t one = 0; one < 4; ++one)
        for (std::size_t other = one + 1; other < 4; ++other) {
            std::vector<double> counts(cells * cells);
            for (std::uint32_t pixel = 0; pixel < pixels; ++pixel) {
                const auto u = draw(pixel, 3, 1);
                counts[std::size_t(cell(u[one], cells) * cells + cell(u[other], cells))] += 1;
            }
            EXPECT_GT(chi_square(counts, std::vector<double>(counts.size(), double(pixels) / (cells * cells))).p_value,
                      sidak_level(1e-3, chi_square_tests))
                << one << " and " << other;
        }
}

// Two samples of a pixel in different dimensions, neighbouring pixels, and the two samples that share a stratum least.
TEST(Stratified, PixelsAndDimensionsAreIndependent) {
    constexpr int cells = 32, pixels = 200'000;
    std::vector<double> dimensions(cells * cells), neighbours(cells * cells), pairs(cells * cells);
    for (std::uint32_t pixel = 0; pixel < pixels; ++pixel) {
        const auto u = draw(pixel, 5, 0), of_other = draw(pixel, 5, 1), of_next = draw(pixel + 1, 5, 0);
        dimensions[std::size_t(cell(u[0], cells) * cells + cell(of_other[0], cells))] += 1;
        neighbours[std::size_t(cell(u[0], cells) * cells + cell(of_next[0], cells))] += 1;
        pairs[std::size_t(cell(u[1], cells) * cells + cell(draw(pixel, 6, 0)[3], cells))] += 1;
    }
    for (const auto *counts : {&dimensions, &neighbours, &pairs})
        EXPECT_GT(chi_square(*counts, std::vector<double>(counts->size(), double(pixels) / (cells * cells))).p_value,
                  sidak_level(1e-3, chi_square_tests));
}

// The area under an edge through the square: nets have a variance that falls with n^1.5, independent samples with n.
TEST(Stratified, AnEdgeHasFarLessVariance) {
    constexpr std::uint32_t samples = 64;
    constexpr int pixels = 4000;
    double sum = 0, squares = 0;
    for (std::uint32_t pixel = 0; pixel < pixels; ++pixel) {
        double mean = 0;
        for (std::uint32_t i = 0; i < samples; ++i) {
            const auto u = draw(pixel, i, 0);
            mean += (u[0] * 0.8 + u[1] * 0.6 < 0.6 ? 1.0 : 0.0) / samples;
        }
        sum += mean;
        squares += mean * mean;
    }
    const double mean = sum / pixels, variance = squares / pixels - mean * mean;
    // The triangle below the line, within the unit square: 0.6 / 0.8 wide and 1 high.
    const double area = 0.5 * 0.75;
    const double independent = area * (1 - area) / samples;
    std::printf("mean %.5f of %.5f, variance over that of independent samples %.3f\n", mean, area,
                variance / independent);
    EXPECT_NEAR(mean, area, 4 * std::sqrt(variance / pixels));
    EXPECT_LT(variance, 0.25 * independent);
}

// Each lobe of smooth glass brings on average what it does where it is chosen by its share, as importance does.
TEST(StratifiedChoice, OfALobeBringsItsShare) {
    for (const double ior : {1.0001, 1.33, 1.5, 2.4, 0.7})
        for (int i = 1; i <= 400; ++i)
            for (const int side : {1, -1}) {
                lib::material glass{};
                glass.ior = real(ior);
                glass.specular_reflectance_r = R(1);
                glass.specular_transmittance_r = R(1);
                const double cosine = i / 400.0;
                const lib::vec3 wi = lib::v3(real(std::sqrt(1 - cosine * cosine)), R(0), real(side * cosine));
                for (const bool reflects : {true, false}) {
                    const real u = reflects ? R(0) : R(1 - 0x1p-24);
                    const auto ours = lib::dielectric_sample(glass, wi, u, 0, 0, lib::transport_radiance);
                    const auto plain = lib::dielectric_sample(glass, wi, u, 0, 0, lib::transport_importance);
                    ASSERT_GT(ours.wo.z * plain.wo.z, 0);
                    const double scale = 1 / (double(ours.eta) * ours.eta);
                    EXPECT_NEAR(ours.pdf * ours.weight.r, plain.pdf * plain.weight.r * scale, 1e-6 * scale);
                    EXPECT_LE(ours.weight.r, 1.5001 * scale);
                }
            }
}

// The levels are eighths, so that eight samples have no noise, and none is far below the share of either lobe.
TEST(StratifiedChoice, IsAtLevels) {
    for (int i = 6; i <= 994; ++i) {
        const double share = i / 1000.0, level = double(lib::level_near(real(share)));
        EXPECT_EQ(level * 8, std::floor(level * 8)) << share;
        EXPECT_LT(share / level, 1.51) << share;
        EXPECT_LT((1 - share) / (1 - level), 1.51) << share;
    }
    for (const double share : {0.0, 0.004, 0.996, 1.0})
        EXPECT_EQ(lib::level_near(real(share)), real(share));
}
