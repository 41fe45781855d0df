#pragma once

#include <span>
#include <vector>

#include "core/error_convention.h"
#include "core/imu_propagation.h"
#include "core/measurement_log.h"
#include "filter/filter_observer.h"
#include "filter/square_root_covariance.h"

namespace alidade {

/// A past body pose kept in the state. `serial` counts frames and never repeats.
struct Clone {
  int serial = 0;
  int slot = 0;  ///< in [0, max_clones), its own as long as it lives
  TimeNs stamp_ns = 0;
  Pose T_WB;
  // Derived from T_WB and the extrinsics; refreshed after every correction.
  Pose T_WC;
  Matrix6d camera_from_error = Matrix6d::Identity();  ///< d zeta_C / d xi of this clone
};

/// State and covariance of the filter: current navigation state, biases and a window of clones. The error is
/// [theta p v bg ba | clones newest first], each pose in the configured convention.
class FilterState {
 public:
  FilterState(ErrorConvention convention, const Pose& T_BC, int max_clones);

  /// Null, the default, observes nothing. It must outlive the state.
  void SetObserver(FilterObserver* observer) { observer_ = observer; }

  /// `initial.covariance` is in the canonical chart.
  Status Reset(const NavEstimate& initial);
  /// Propagates state and covariance over consecutive samples.
  void Propagate(std::span<const ImuSample> samples, const ImuNoise& noise, const Eigen::Vector3d& gravity_W);
  void AddClone(int serial);
  void RemoveClone(size_t index);
  /// Retracts every state by its part of the correction (error order of the class).
  void Correct(const Eigen::VectorXd& correction);

  /// First error row of clone `index` (0 = oldest).
  [[nodiscard]] int CloneOffset(size_t index) const {
    return SquareRootCovariance::kCore + 6 * static_cast<int>(clones_.size() - 1 - index);
  }
  /// Index of the clone with this serial, or -1.
  [[nodiscard]] int FindClone(int serial) const;
  [[nodiscard]] NavEstimate Estimate() const;

  [[nodiscard]] const std::vector<Clone>& clones() const { return clones_; }  ///< oldest first
  [[nodiscard]] const NavState& nav() const { return nav_; }
  [[nodiscard]] const ImuBias& bias() const { return bias_; }
  [[nodiscard]] TimeNs stamp_ns() const { return stamp_ns_; }
  [[nodiscard]] SquareRootCovariance& covariance() { return covariance_; }
  [[nodiscard]] const SquareRootCovariance& covariance() const { return covariance_; }
  [[nodiscard]] ErrorConvention convention() const { return convention_; }
  [[nodiscard]] bool AllFinite() const;

 private:
  void RefreshClone(Clone* clone) const;

  ErrorConvention convention_;
  Pose T_BC_;
  TimeNs stamp_ns_ = 0;
  NavState nav_;
  ImuBias bias_;
  std::vector<Clone> clones_;
  std::vector<int> free_slots_;
  SquareRootCovariance covariance_;
  FilterObserver* observer_ = nullptr;
};

}  // namespace alidade
