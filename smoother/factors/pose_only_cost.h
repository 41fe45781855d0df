#pragma once

#include <optional>
#include <span>
#include <vector>

#include "smoother/factors/reduced_cost.h"
#include "smoother/tracks/track_system.h"

namespace alidade {

/// How the landmarks of a PoseOnlyCost follow the states.
///
/// kSolved: to where their cost is least. kJointStep: as explicit unknowns, from the tracks' landmarks on.
/// Each takes its part of the joint Gauss-Newton step from the last linearisation, then one Newton step of
/// its own: the kernel's curvature, which the joint step neglects, would take three times as many steps of
/// all. Both have the same minimum.
enum class LandmarkMotion { kSolved, kJointStep };

/// All tracks of a window as one cost over the frames' poses and the calibration, the landmarks eliminated:
///
///     F(X) = sum over tracks and views of rho(|W (pi(X, f) - z)|^2),
///
/// at landmarks f(X) by LandmarkMotion.
class PoseOnlyCost final : public ReducedCost {
 public:
  /// `tracks` have landmarks to start from; they, the window and the calibration must outlive the cost.
  PoseOnlyCost(const Window& window, std::vector<const WindowTrack*> tracks,
               const WindowCalibration& calibration, const ObservationKernel& kernel,
               LandmarkMotion motion = LandmarkMotion::kSolved);

  double Solve(const WindowPoint& point) override;
  [[nodiscard]] bool Linearize(NormalEquations* equations) override;

  /// The landmarks of the last Solve, of each track; none behind a view.
  [[nodiscard]] std::span<const std::optional<Eigen::Vector3d>> landmarks() const { return landmarks_; }
  /// What Linearize gave at `point`, with its counts. Null: it was elsewhere.
  [[nodiscard]] const PoseSystem* SystemAt(const WindowPoint& point) const;
  /// The tracks in that system: all but those behind a view, or whose landmark is not determined.
  [[nodiscard]] const std::vector<const WindowTrack*>& used() const { return used_; }

 private:
  /// A track at the last linearisation, from which its landmark moves with the states.
  struct LinearTrack {
    Eigen::Vector3d landmark;
    double cost = 0;
    EliminatedLandmark eliminated;
  };
  struct Linearization {
    WindowPoint point;
    std::vector<FrameGeometry> geometry;
    std::vector<std::optional<LinearTrack>> tracks;
  };
  /// How far the states of the last Solve are from the linearisation.
  struct Step {
    std::vector<Vector6d> poses;  ///< (phi, dp) of each frame
    Eigen::VectorXd calibration;  ///< in the layout's coordinates
  };

  [[nodiscard]] Step StepFromLinearization() const;
  /// The landmark of least cost, from `landmark` on, and that cost. False: it lies behind a view.
  bool SolveTrack(size_t track, std::span<const WindowView> views, Eigen::Vector3d* landmark,
                  double* cost) const;
  static Eigen::Vector3d JointStep(const EliminatedLandmark& landmark, std::span<const WindowView> views,
                                   const Step& step);
  /// That of kJointStep, likewise.
  bool MoveTrack(size_t track, std::span<const WindowView> views, const Step& step, Eigen::Vector3d* landmark,
                 double* cost) const;

  const Window* window_;
  const WindowCalibration* calibration_;
  std::vector<const WindowTrack*> tracks_;
  ObservationKernel kernel_;
  LandmarkMotion motion_;
  WindowPoint point_;
  WindowCalibration camera_;
  std::vector<FrameGeometry> geometry_;
  std::vector<std::optional<Eigen::Vector3d>> landmarks_;
  std::optional<PoseSystem> system_;
  std::vector<const WindowTrack*> used_;
  Linearization linear_;  ///< kJointStep; no tracks before the first
  TrackWorkspace workspace_;
};

}  // namespace alidade
