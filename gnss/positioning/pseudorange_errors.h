#pragma once

#include <algorithm>
#include <array>
#include <deque>
#include <vector>

#include "gnss/base/satellite_id.h"
#include "gnss/model/satellite_measurement.h"
#include "gnss/positioning/single_point_solution.h"

namespace alidade {

/// Measures how large the errors of pseudoranges are beside what is stated, and how long they last, from the
/// residuals of single-point solutions.
///
/// Multipath, orbits and atmosphere change over seconds to hours. A filter that takes them for white noise
/// averages them away: its covariance becomes far too small, the more so the higher the rate is. Errors with
/// the covariance c(l) at lag l are taken as white noise, of their stated deviations times a scale, and
/// errors of variance c that last. The mean of the latter over a time T has the variance of white errors that
/// are larger by
///
///   m = 1 + 2 / (c dt) int_0^T (1 - l / T) c(l) dl,   dt: interval of the epochs
///
/// (Priestley, "Spectral Analysis and Time Series", 5.3.2). c(l) is measured at lags of 0.25 to 64 s: with
/// the whitened residuals w of a satellite of the stated variance V at either end, sum(w w') / sum(1 / V),
/// less the degrees of freedom that the solution takes. The integral ends at the first lag at which c
/// is not significant. What is not reached yet is assumed to last, so that a constant error counts as one
/// epoch.
///
/// The share of an error that is common to all satellites, or looks like a shift of the position, is not seen
/// in the residuals; it is assumed to behave as the rest.
class PseudorangeErrors {
 public:
  /// The first one gives the variance.
  static constexpr std::array<double, 10> kLagsS = {0, 0.25, 0.5, 1, 2, 4, 8, 16, 32, 64};
  /// Older products count less, with these time constants; the larger m c counts: the first notices a
  /// change of the surroundings, the second what is small.
  static constexpr std::array<double, 2> kMemoriesS = {10, 300};
  /// Of a covariance, in its deviations for white errors.
  static constexpr double kSignificance = 4;
  /// Before so much time has been measured, a covariance that is not significant counts as larger by so many
  /// deviations: an estimate that began with too much confidence never loses it again.
  static constexpr double kSettlingS = 5;
  static constexpr double kDoubt = 1;

  /// In the order of tags.
  void Add(const SinglePointSolution& solution);
  [[nodiscard]] PseudorangeNoise noise() const;

 private:
  struct Whitened {
    SatelliteId satellite;
    double residual = 0;     ///< over its stated deviation
    double information = 0;  ///< of the stated deviation [1/m^2]
  };
  struct Epoch {
    TimeNs tag_ns = 0;
    std::vector<Whitened> residuals;  ///< rising satellites
  };
  /// A mean product: the smaller one of the mean over all satellites and epochs and the mean over epochs of
  /// what the median over the satellites says, so that a minority of them, such as reflections, counts
  /// little. Weights are of each satellite, times its share of the degrees of freedom.
  struct Mean {
    double sum = 0;
    double of_medians = 0;
    double freedom = 0;
    double information = 0;  ///< sum of 1 / V [1/m^2]
    double squares = 0;      ///< variance of the sum for independent errors as stated

    void Forget(double keep);
    /// Over the stated variances.
    [[nodiscard]] double Relative() const;
    /// Of Relative, for independent errors as stated; infinite without any.
    [[nodiscard]] double Deviation() const;
    /// V where all are equal [m^2].
    [[nodiscard]] double StatedVariance() const { return freedom / information; }
  };
  using Memory = std::array<Mean, kLagsS.size()>;
  /// Errors that last: their variance c, the integrals of c(l) [s] and l c(l) [s^2], over the stated
  /// variance.
  struct Lasting {
    double variance = 0;
    double integral = 0;
    double moment = 0;

    /// From lag a to lag b, linear in between.
    void Add(double from_s, double from, double to_s, double to);
  };

  [[nodiscard]] static Epoch Whiten(const SinglePointSolution& solution);
  void Forget(double since_s);
  void AddProducts(const Epoch& earlier, const Epoch& now, std::size_t lag);
  [[nodiscard]] Lasting Integrate(const Memory& memory) const;

  std::array<Memory, kMemoriesS.size()> memories_;
  std::deque<Epoch> history_;  ///< of the longest lag
  TimeNs first_ns_ = 0;
  double interval_s_ = 0;  ///< mean of the epochs
};

}  // namespace alidade
