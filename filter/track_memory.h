#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/filter_config.h"
#include "filter/clone_conditional.h"
#include "filter/filter_state.h"

namespace alidade {

/// What the updates of a track have left over about its landmark: three rows t = R f~ + T x + n, n ~ N(0, I),
/// independent of everything already applied. f~ is a LandmarkError, so that the yaw and translation columns
/// cancel in every row even when p^_W changes later; x are the errors of the clones.
struct TrackMemory {
  bool active = false;
  int anchor = -1;  ///< serial of the anchor clone of an anchored error
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();
  Eigen::Matrix3d landmark_rows = Eigen::Matrix3d::Identity();  ///< R
  /// T: six columns a clone slot, then the calibration's
  Eigen::Matrix<double, 3, Eigen::Dynamic> clone_rows;
  bool carried = false;                                   ///< a clone that it saw has left
  int refusals = 0;                                       ///< observations refused in a row
  Eigen::Vector2d residual = Eigen::Vector2d::Zero();     ///< of the last view, before its update; whitened
  Eigen::Vector2d innovations = Eigen::Vector2d::Zero();  ///< sum over the further views, each whitened
  int further_views = 0;

  /// Takes the last view's innovation, of normalised square `nis`, into the sum, along the view's residual.
  void AddInnovation(double nis);
  /// Whether the innovations are too much alike: those of a point that stands still are independent, so that
  /// |sum|^2 / n has the chi-square distribution of two degrees of freedom. `limit`: its largest value.
  [[nodiscard]] bool Drifts(double limit) const {
    return innovations.squaredNorm() > limit * static_cast<double>(further_views);
  }
};

/// Starts, extends and carries the memories of tracks (docs/track_memory.md).
class TrackMemoryKeeper {
 public:
  /// calibration_size: of the state's CalibrationLayout.
  TrackMemoryKeeper(const FilterConfig& filter, int max_clones, int calibration_size = 0);

  /// Whether the state is certain enough for rows that stay linearised at it; arguments as for Start.
  [[nodiscard]] bool StateAllows(const FilterState& state, const Eigen::Vector3d& p_W,
                                 const Eigen::Matrix3d& landmark_rows,
                                 const Eigen::Ref<const Eigen::MatrixXd>& clone_rows,
                                 const std::vector<int>& clones);

  /// The memory that a first update leaves: the three landmark rows of EliminateLandmark. `clone_rows`: over
  /// six columns a view, in the order of `clones` (indices into the state's clones), then the calibration's.
  /// Not active when the state does not allow it.
  void Start(const FilterState& state, const Eigen::Vector3d& p_W, const Eigen::Matrix3d& landmark_rows,
             const Eigen::Ref<const Eigen::MatrixXd>& clone_rows, const std::vector<int>& clones,
             TrackMemory* memory);

  /// Stacks a view's two rows under the memory's and eliminates the landmark again: the memory that follows
  /// into `extended`, the two landmark-free rows into jacobian() and innovation().
  bool Extend(const FilterState& state, const TrackMemory& memory, size_t clone,
              const NormalizedObservation& observation, double weight, TrackMemory* extended);
  /// 2 x (6 max_clones + calibration) over clone slots and calibration, and 2: the rows of the last Extend.
  [[nodiscard]] const Eigen::Matrix<double, 2, Eigen::Dynamic>& jacobian() const { return jacobian_; }
  [[nodiscard]] const Eigen::Vector2d& innovation() const { return innovation_; }

  /// Moves the landmark to where its rows put it after the state was corrected (called before the state
  /// itself is).
  void Correct(const FilterState& state, const Eigen::Ref<const Eigen::VectorXd>& correction,
               TrackMemory* memory) const;

  /// Replaces the leaving clone in the rows by its conditional mean and whitens its noise away.
  void Carry(const FilterState& state, const CloneConditional& conditional, TrackMemory* memory) const;

  /// Whether a landmark at p_W is known well enough for a memory that starts; `point_jacobian`: whitened rows
  /// over p_W.
  [[nodiscard]] bool MayStart(
      const Eigen::Ref<const Eigen::Matrix<double, Eigen::Dynamic, 3>>& point_jacobian,
      const Eigen::Vector3d& p_W, const Eigen::Vector3d& camera_W) const;
  /// Whether the memory's own linearisation still holds.
  [[nodiscard]] bool MayStay(const TrackMemory& memory, const Eigen::Vector3d& camera_W) const;

 private:
  /// What the state's uncertainty adds to the deviation of the landmark's depth from the newest view, `ray`
  /// its vector from there; m.
  double StateDepthDeviation(const FilterState& state, const Eigen::Vector3d& ray,
                             const Eigen::Matrix3d& landmark_rows,
                             const Eigen::Ref<const Eigen::MatrixXd>& clone_rows,
                             const std::vector<int>& clones);

  LandmarkError error_;
  double max_depth_deviation_;
  Eigen::Index calibration_;  ///< size of the calibration's error
  Eigen::Index columns_;
  Eigen::Matrix<double, 5, Eigen::Dynamic> stacked_;
  Eigen::Matrix<double, 2, Eigen::Dynamic> jacobian_;
  Eigen::Vector2d innovation_ = Eigen::Vector2d::Zero();
  Eigen::VectorXd depth_row_;
  Eigen::VectorXd whitened_depth_row_;
};

}  // namespace alidade
