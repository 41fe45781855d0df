#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/imu_sample.h"
#include "core/lie.h"

namespace alidade {

class FilterState;

/// What one track contributed to an update.
struct TracedBlock {
  int first = 0;  ///< of its rows in FilterRows
  int rows = 0;
  std::int64_t track_id = 0;
  std::vector<int> serials;  ///< clones whose observations entered, base first; empty: not followed
  /// rows x 2 serials.size(): the rows' noise is this times the noise of the observations, whitened by their
  /// true standard deviation (weights of base re-use, gate and kernel included).
  Eigen::MatrixXd noise;
};

/// The sensor whose measurements made the rows of an update.
enum class RowSource { kVision, kRest, kGnss, kMeasurement };

/// The rows of one update as the filter applies them: y = H xi + n, n ~ N(0, I) as the filter assumes.
struct FilterRows {
  Eigen::MatrixXd jacobian;    ///< rows x error dimension, weighted; a refused track's rows are zero
  Eigen::VectorXd innovation;  ///< weighted likewise
  /// Of tracks whose observations alone made their rows: none for rest, or for rows out of a track memory.
  std::vector<TracedBlock> blocks;
  RowSource source = RowSource::kVision;
};

/// Receives every linear operation of the filter on its error, with the matrices that the filter uses. The
/// error is [landmarks, newest first | clock 6, once aligned with GNSS | core 15 | clones, newest first];
/// without landmarks in the state (filter.slam_features: 0) the core, or its clock, comes first. Default
/// functions do nothing, and a filter without observer does no extra work.
class FilterObserver {
 public:
  virtual ~FilterObserver() = default;

  /// The error is the core alone again.
  virtual void OnReset(const FilterState& /*state*/) {}
  /// What the next propagation integrates: consecutive samples from the stamp of `state` on.
  virtual void OnImu(const FilterState& /*state*/, std::span<const ImuSample> /*samples*/) {}
  /// core <- phi core + w, w ~ N(0, q).
  virtual void OnPropagate(const Matrix15d& /*phi*/, const Matrix15d& /*q*/) {}
  /// A copy of the core's rows [first, first + size) enters directly after the core.
  virtual void OnClone(int /*first*/, int /*size*/) {}
  /// A landmark enters as rows [first, first + 3): `rows` (3 x dimension with the landmark) are the
  /// unit-noise measurements that define it; their 3 x 3 block at `first` is invertible.
  virtual void OnAddLandmark(int /*first*/, const Eigen::MatrixXd& /*rows*/) {}
  /// The rows [landmark, landmark + 3) += m times the rows [source, source + 3) of a clone: the landmark's
  /// error refers to another anchor.
  virtual void OnAddToLandmark(int /*landmark*/, const Eigen::Matrix3d& /*m*/, int /*source*/) {}
  /// The rows [first, first + size) leave.
  virtual void OnRemove(int /*first*/, int /*size*/) {}
  /// Core and clones <- turn times them (square, of both together) at the rotation into ENU; the added errors
  /// of yaw and position are along directions that are unobservable anyway. Then six rows of the clock enter
  /// before the core if `has_clock`. There are no landmarks.
  virtual void OnAlign(const Eigen::MatrixXd& /*turn*/, bool /*has_clock*/) {}
  /// The error x becomes x + column (row . x).
  virtual void OnShear(const Eigen::VectorXd& /*column*/, const Eigen::VectorXd& /*row*/) {}
  /// The clock's six rows <- phi times them + w, w ~ N(0, q).
  virtual void OnPropagateClock(const Matrix6d& /*phi*/, const Matrix6d& /*q*/) {}
  /// An update is about to be applied to `state`.
  virtual void OnUpdate(const FilterState& /*state*/, const FilterRows& /*rows*/) {}
  /// A frame is done.
  virtual void OnFrame(const FilterState& /*state*/) {}
};

}  // namespace alidade
