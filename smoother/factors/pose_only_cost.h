#pragma once

#include <optional>
#include <span>
#include <vector>

#include "smoother/factors/reduced_cost.h"
#include "smoother/tracks/track_system.h"

namespace alidade {

/// All pose-only tracks of a window as one cost over the frames' poses and the calibration:
///
///     F(X) = min_f  sum over tracks and views of rho(|W (pi(X, f) - z)|^2).
class PoseOnlyCost final : public ReducedCost {
 public:
  /// `tracks` have landmarks to start from; they, the window and the calibration must outlive the cost.
  PoseOnlyCost(const Window& window, std::vector<const WindowTrack*> tracks,
               const WindowCalibration& calibration, const ObservationKernel& kernel);

  double Solve(const WindowPoint& point) override;
  [[nodiscard]] bool Linearize(NormalEquations* equations) override;

  /// The landmarks of the last Solve, of each track; none behind a view.
  [[nodiscard]] std::span<const std::optional<Eigen::Vector3d>> landmarks() const { return landmarks_; }
  /// What Linearize gave at `point`, with its counts. Null: it was elsewhere.
  [[nodiscard]] const PoseSystem* SystemAt(const WindowPoint& point) const;
  /// The tracks in that system: all but those behind a view, or whose landmark is not determined.
  [[nodiscard]] const std::vector<const WindowTrack*>& used() const { return used_; }

 private:
  const Window* window_;
  const WindowCalibration* calibration_;
  std::vector<const WindowTrack*> tracks_;
  ObservationKernel kernel_;
  WindowPoint point_;
  WindowCalibration camera_;
  std::vector<FrameGeometry> geometry_;
  std::vector<std::optional<Eigen::Vector3d>> landmarks_;
  std::optional<PoseSystem> system_;
  std::vector<const WindowTrack*> used_;
  TrackWorkspace workspace_;
};

}  // namespace alidade
