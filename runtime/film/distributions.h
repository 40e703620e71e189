// The normal and Student's t distribution, far into their tails.
#pragma once

#include <cstddef>

namespace gradus {

/// Probability that a standard normal variable exceeds z.
double normal_upper_tail(double z);

/// The z >= 0 whose upper tail is `tail`, for tail in (0, 0.5]; tails below 1e-300 give the z of 1e-300 (37.0).
double normal_quantile_of_tail(double tail);

/// Probability that a variable of Student's t distribution exceeds t >= 0; degrees of freedom > 0, not only whole.
double student_upper_tail(double t, double degrees_of_freedom);

/// The standard normal quantile of the same probability and sign as t of Student's distribution: what a t statistic
/// is as a z score. Infinite degrees of freedom give t itself; beyond +-37 it stays there.
double student_to_normal(double t, double degrees_of_freedom);

/// The |z| that the largest of `count` independent standard normal variables exceeds with probability `alpha`, both
/// signs counted (Sidak 1967). Dependent ones exceed it less often.
double sidak_limit(std::size_t count, double alpha);

/// Smallest k such that a binomial variable of `count` trials of probability p exceeds k with probability < alpha.
std::size_t binomial_limit(std::size_t count, double p, double alpha);

} // namespace gradus
