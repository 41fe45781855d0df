#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "core/fix_config.h"
#include "core/position_fix.h"
#include "gnss/alignment/alignment.h"
#include "gnss/alignment/fix_rows.h"
#include "gnss/alignment/state_matcher.h"

namespace alidade {

/// Finds how the local world W stands in the frame N of position fixes, from the fixes and the
/// visual-inertial estimate at their times: least squares over yaw, shift and a constant error of the
/// estimate's velocity,
///
///   r = Rz(yaw) (p_WB + R_WB p_BA + (t - t_newest) dv_W) + p_NW - p_NA,
///
/// with dv_W held by the estimate's own covariance of velocity. The least median of squares over all pairs of
/// fixes (Rousseeuw 1984) starts it, so that up to half of the fixes may be wrong; then Gauss-Newton steps
/// with the weights of fix.robust_kernel over the fixes inside a gate. A row's deviation contains the growth
/// of the estimate's covariance of position from then to the newest fix. Neglected: what else is correlated;
/// align_inflation covers it.
class FixAligner {
 public:
  /// `enu`: what N is, if its place on the Earth is known.
  FixAligner(const FixConfig& config, std::vector<FixSensor> sensors, const std::optional<EnuFrame>& enu);

  /// The estimate in the local world; rising stamps.
  void AddState(const NavEstimate& estimate);
  /// A fix in IMU time and in N; rising stamps. One that is no measurement (MakeFixMeasurement) is passed
  /// over.
  void AddFix(const PositionFix& fix);
  /// The estimate was lost, and the next one stands elsewhere.
  void ForgetEstimate();

  /// The alignment, without a clock, once its yaw is known well enough; report() names what is missing.
  std::optional<GnssAlignment> TryAlign();
  [[nodiscard]] const std::string& report() const { return report_; }

 private:
  /// A fix with the estimate at its time.
  struct Sample {
    AlignmentState state;
    FixMeasurement fix;
    Eigen::Vector3d p_WA = Eigen::Vector3d::Zero();  ///< of the estimate
  };
  struct Normal;
  struct Fit;

  void MatchFixes();
  [[nodiscard]] std::vector<FixPoint> Points() const;
  [[nodiscard]] static FixGuess FirstGuess(const std::vector<FixPoint>& points);
  [[nodiscard]] Normal NormalEquations(const std::vector<FixPoint>& points, const FixGuess& guess) const;
  [[nodiscard]] Fit Refine(const std::vector<FixPoint>& points, FixGuess guess) const;
  std::optional<GnssAlignment> Accept(const Fit& fit, std::size_t points);

  FixConfig config_;
  std::vector<FixSensor> sensors_;
  std::optional<EnuFrame> enu_;
  StateMatcher<PositionFix> matcher_;
  std::deque<Sample> samples_;
  TimeNs tried_ns_ = INT64_MIN;
  std::string report_;
};

}  // namespace alidade
