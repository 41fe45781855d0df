#pragma once

#include <limits>
#include <string>
#include <vector>

#include "eval/comparison/aggregate.h"
#include "eval/comparison/comparison.h"

namespace alidade {

/// Verdict of a paired difference at 95 %, about the first of the two.
enum class PairVerdict {
  kTooFew,        ///< fewer than two pairs: no interval
  kNoDifference,  ///< the interval contains zero
  kBetter,
  kWorse,
  kLower,  ///< of a figure for which lower is not better, such as the NEES
  kHigher,
};
/// "significantly better", "no significant difference", ...
[[nodiscard]] std::string ToString(PairVerdict verdict);

/// Two-sided 95 % interval and p-value of the mean of differences by Student's t with n - 1 degrees of
/// freedom; NaN with fewer than two. If all differences are equal, the interval has zero width.
struct PairedT {
  int count = 0;
  double mean = 0;
  double standard_error = 0;
  double low = 0, high = 0;
  double p_value = 0;
};
[[nodiscard]] PairedT TestPairs(const std::vector<double>& differences);

/// Two-sided p-value of the sign test: chance of a split at least this uneven when either sign is as likely.
/// 1 without any pair.
[[nodiscard]] double SignTest(int lower, int higher);

/// The p-values corrected for their number by Holm's step-down method (Holm 1979), in the same order: of m
/// sorted ones p(i) becomes the largest min(1, (m - j + 1) p(j)) of j <= i. Of those below alpha then none is
/// by chance with a probability of at least 1 - alpha, however the tests depend on each other. NaN stays and
/// is not counted.
[[nodiscard]] std::vector<double> HolmCorrect(const std::vector<double>& p_values);

/// One figure of two estimators on the runs of one sequence that both finished on the same input.
struct PairedDifference {
  std::string sequence;
  std::string first, second;  ///< labels; `first` comes first in the comparison
  size_t figure = 0;          ///< index into the list of figures
  double first_mean = 0, second_mean = 0;
  PairedT difference;                     ///< of first - second
  int first_lower = 0, second_lower = 0;  ///< runs
  /// HolmCorrect over the pairs of the same sequence and figure; NaN with too few runs.
  double holm_p_value = std::numeric_limits<double>::quiet_NaN();
  double sign_p_value = 0;              ///< SignTest of these, robust against outliers
  int only_first = 0, only_second = 0;  ///< runs that only one of them has a value for
  int neither = 0;                      ///< runs of the sequence that none of them has a value for
  PairVerdict verdict = PairVerdict::kTooFew;
};

/// The name used as sequence in pairs over all sequences.
inline constexpr const char* kAllSequences = "all sequences";

/// Measured times depend on the load of the machine and are not compared in pairs.
[[nodiscard]] bool IsPaired(const Figure& figure);

/// All pairs of rows of each sequence and each figure that IsPaired, by sequence, figure, first, second. A
/// pair of runs has the same seed and input digest and both runs ended ok. Pairs of rows of which no run has
/// the value are left out; of a figure of all runs (Figure::of_all_runs) the end does not matter, nor does a
/// digest that is missing because the run was killed. With Comparison::pair_across rows over all sequences
/// follow, one sample a sequence (its mean difference), so the interval generalises over sequences; their
/// counts of runs are sums, `pairs` and `lower` count sequences. Intervals and verdicts are not corrected for
/// the number of comparisons: of twenty pairs without a difference one will look significant. `holm_p_value`
/// is.
[[nodiscard]] std::vector<PairedDifference> ComparePairs(const Comparison& comparison,
                                                         const std::vector<Figure>& figures);

/// The pairs of `pairs` over all sequences, one sample a sequence, as ComparePairs appends them with
/// Comparison::pair_across.
[[nodiscard]] std::vector<PairedDifference> PoolSequences(const std::vector<PairedDifference>& pairs,
                                                          const std::vector<Figure>& figures);

}  // namespace alidade
