#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "core/clock_state.h"
#include "core/rig_calibration.h"
#include "core/yaw_shift.h"
#include "gnss/alignment/alignment_fit.h"
#include "gnss/alignment/state_matcher.h"
#include "gnss/positioning/single_point_solution.h"

namespace alidade {

/// How the local world W stands in the ENU frame N at an anchor, or in a gravity-aligned frame of position
/// fixes: p_N = Rz(yaw) p_W + p_NW. Both are gravity-aligned (core/yaw_shift.h).
struct GnssAlignment {
  TimeNs stamp_ns = 0;          ///< IMU time of the last epoch used
  std::optional<EnuFrame> enu;  ///< N; nothing: a frame whose place on the Earth is not known
  double yaw_rad = 0;
  Eigen::Vector3d p_NW = Eigen::Vector3d::Zero();
  /// Of (yaw, p_NW): truth = estimate + error.
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  std::optional<Vector6d> clock;  ///< of the GNSS receiver at stamp_ns; nothing: from position fixes alone
  double time_offset_s = 0;       ///< estimated, to be added to the receiver's
  std::string report;

  [[nodiscard]] YawShift Transform() const { return {yaw_rad, p_NW}; }
};

/// The alignment of a state that stands in N already, its uncertainty there included: the same frame, no turn
/// and no shift.
[[nodiscard]] GnssAlignment AlreadyAligned(GnssAlignment alignment, TimeNs stamp_ns);

/// An estimate of the local world in the ENU frame, with the alignment's own uncertainty in its covariance.
[[nodiscard]] NavEstimate TurnIntoEnu(const GnssAlignment& alignment, const NavEstimate& estimate);

/// Finds the alignment from epochs and the visual-inertial estimate at their times: least squares over yaw,
/// p_NW, the clock of each epoch (tied by its process) and the biases between systems, with the weights of
/// gnss.robust_kernel. Every pseudorange and range rate counts, so that epochs with few satellites
/// accumulate, at any rate, and the rates give the yaw from the first metres on. Yaw starts from the best of
/// a ring of candidates.
///
/// The estimate's velocity may have a constant error of the size of its covariance
/// (gnss/alignment/alignment_fit.h). Its drift over the window is not modelled otherwise; align_inflation
/// covers it, and what all epochs share.
class GnssAligner {
 public:
  GnssAligner(const GnssConfig& config, const GnssReceiver& receiver);

  /// The estimate in the local world (covariance: of its velocity) and the gyroscope's measurement at its
  /// stamp; rising stamps.
  void AddState(TimeNs stamp_ns, const NavState& nav, const ImuBias& bias, const Eigen::Vector3d& gyro_radps,
                const Eigen::Matrix3d& velocity_covariance_W);
  /// `approximate_E`: an antenna position (kilometres are enough) or empty; the last value is used.
  /// `solution`: the epoch's single-point solution, if it has one; satellites that it rejected are not used.
  void AddEpoch(const GnssEpoch& epoch, const std::optional<Eigen::Vector3d>& approximate_E,
                const std::optional<SinglePointSolution>& solution = std::nullopt);

  /// The estimate was lost, and the next one stands elsewhere.
  void ForgetEstimate();

  /// The alignment once it is good enough; report() names what is missing.
  std::optional<GnssAlignment> TryAlign();
  [[nodiscard]] const std::string& report() const { return report_; }

 private:
  void MatchEpochs();
  void Locate();
  /// What became of the satellites, where no epoch could be used; else empty.
  [[nodiscard]] std::string LeftOut() const;
  /// Every how many epochs one is chosen.
  [[nodiscard]] std::size_t ChoiceStep() const;
  [[nodiscard]] std::vector<const AlignmentSample*> Choose() const;
  [[nodiscard]] std::optional<AlignmentGuess> FirstGuess(const AlignmentFit& fit) const;
  /// The alignment, if its yaw is known well enough; sets the report.
  std::optional<GnssAlignment> AcceptFit(const AlignmentGuess& guess, const AlignmentStep& fit);

  GnssConfig config_;
  GnssReceiver receiver_;
  StateMatcher<GnssEpoch> matcher_;
  std::deque<AlignmentSample> samples_;
  std::optional<Eigen::Vector3d> approximate_E_;
  std::shared_ptr<const MeasurementBuilder> builder_;
  EnuFrame enu_;
  bool located_ = false;
  bool any_epoch_ = false;  ///< with enough satellites
  MeasurementCounts left_out_;
  TimeNs tried_ns_ = INT64_MIN;
  std::string report_;
};

}  // namespace alidade
