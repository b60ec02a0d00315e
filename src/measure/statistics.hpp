/// @file
/// Errors of correlated averages, and what they allow one to say.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

namespace dpd {

/// A mean with its standard error, from `blocks` block averages that may be taken as independent.
struct Estimate {
    double value = 0.0;       ///< the mean
    double error = 0.0;       ///< one standard error; NaN with fewer than two blocks
    std::size_t blocks = 0;   ///< the error has blocks-1 degrees of freedom
    double inefficiency = 1;  ///< samples per independent sample
    bool slow_mode = false;   ///< the blocks remember each other, so that fewer count (`of_slow_mode`)
};

/// Mean of a correlated series; the error by blocking (Flyvbjerg & Petersen, J. Chem. Phys. 91, 461 (1989)).
/// The block length is the first power of two that exceeds (2 n inefficiency^2)^(1/3) (Lee et al., Phys. Rev.
/// E 83, 066706 (2011)): there the truncation error and the noise of the error balance.
Estimate blocking(std::span<double const> series);

/// Mean over independent runs, each a list of blocks that are independent of each other. All blocks are
/// pooled, unless the runs' means scatter more than their blocks explain (F test at 0.1 %: a correlation
/// longer than the runs): then each run counts as one value.
Estimate pool(std::span<std::vector<double> const> runs);

/// Mean over independent runs of one quantity: `pool` of block averages at the longest block length that any
/// run asks for. Runs shorter than two such blocks count as one block each.
Estimate combine(std::span<std::vector<double> const> runs);

/// Means of so many consecutive blocks of equal length; what is left over at the end is left out. None if the
/// series is shorter.
std::vector<double> equal_blocks(std::span<double const> series, std::size_t blocks);

/// Mean and error of numbers that are already independent.
Estimate independent(std::span<double const> values);

/// `of_blocks`, the mean of blocks of equal length of so many runs, where the blocks remember each other:
/// what they are means of fluctuates as exp(-t/tau), and a block lasts `x` tau. The error becomes the one
/// expected, and the number of blocks one more than Satterthwaite's degrees of freedom (Biometrics Bull. 2,
/// 110 (1946)). Whole runs share nothing: with one block for each run nothing changes. x counts as at least
/// 1e-4.
Estimate of_slow_mode(Estimate const& of_blocks, std::size_t runs, double x);

/// a - b of independent estimates, with the combined error and, rounded down, Welch's degrees of freedom
/// (Biometrika 34, 28 (1947)): (ea^2+eb^2)^2/(ea^4/(blocks_a-1) + eb^4/(blocks_b-1)).
Estimate difference(Estimate const& a, Estimate const& b);

/// What a comparison says.
enum class Verdict { agrees, disagrees, undecided };

std::string_view name_of(Verdict verdict);

/// The critical |z| of a two-sided test at the probability `false_alarm`, Student's t for the estimate's
/// degrees of freedom.
double critical_z(double false_alarm, std::size_t blocks);

/// Compares an estimate with a closed form.
///
/// With `tolerance` = 0 the theory is exact: *disagrees* if value and theory differ by more than the critical
/// z times the error, *agrees* if they do not and the error is at most `resolution*|theory|`, else
/// *undecided*. With `tolerance` > 0 the theory is approximate, within +-tolerance*|theory|: *agrees* if the
/// whole confidence interval lies inside this band, *disagrees* if all of it lies outside, else *undecided*.
Verdict judge(Estimate const& estimate, double theory, double tolerance, double resolution,
              double false_alarm);

/// By what factor the run time must grow for the comparison to be decided: the error falls as t^(-1/2). 1 if
/// it is decided; infinity if no error bar would decide (the value sits on the band's edge).
double time_factor_to_decide(Estimate const& estimate, double theory, double tolerance, double resolution,
                             double false_alarm);

}  // namespace dpd
