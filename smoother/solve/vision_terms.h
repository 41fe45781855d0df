#pragma once

#include <ceres/loss_function.h>

#include <optional>
#include <span>

#include "smoother/factors/inverse_depth_factor.h"
#include "smoother/factors/pose_only_cost.h"
#include "smoother/solve/reduced_term.h"

namespace alidade {

/// Tracks of a window, all landmarks eliminated (PoseOnlyCost).
class PoseOnlyTerm final : public ReducedTerm {
 public:
  /// `tracks` have landmarks; they, the window and the calibration must outlive the term. `motion`: that
  /// of the landmarks in a solve.
  PoseOnlyTerm(const Window& window, std::vector<const WindowTrack*> tracks,
               const WindowCalibration& calibration, const ObservationKernel& kernel,
               LandmarkMotion motion = LandmarkMotion::kSolved);

  /// At the states and landmarks of the first call: a term is made anew once they have moved.
  Status Linearize(LinearTerm* linear) const override;

  /// What Linearize gives, with its counts.
  [[nodiscard]] const PoseSystem& system() const;
  /// The tracks in system(): all but those behind a view, or whose landmark is not determined.
  [[nodiscard]] const std::vector<const WindowTrack*>& used() const;

  /// The landmarks of each track that go with the present states, none behind a view, if the last solve of
  /// Ceres left them and the rows there; else empty.
  [[nodiscard]] std::span<const std::optional<Eigen::Vector3d>> SolvedLandmarks() const;
  /// Takes tracks out of system(), before their views change.
  void Remove(std::span<const WindowTrack* const> tracks);

 private:
  [[nodiscard]] ReducedCost* cost() const override { return &cost_; }
  [[nodiscard]] WindowPoint Present() const;
  /// Of the tracks at their landmarks and the present states; appends those that it holds to `used`.
  [[nodiscard]] PoseSystem SystemOf(std::span<const WindowTrack* const> tracks,
                                    std::vector<const WindowTrack*>* used) const;

  const Window* window_;
  std::vector<const WindowTrack*> tracks_;
  const WindowCalibration* calibration_;
  ObservationKernel kernel_;
  mutable PoseOnlyCost cost_;
  mutable std::optional<PoseSystem> system_;
  mutable std::vector<const WindowTrack*> used_;
};

/// What the views of a window's tracks share.
struct ViewContext {
  ViewContext(const WindowFrames& frames, const WindowCalibration& camera, const ObservationKernel& kernel);

  const WindowCalibration* calibration;
  ObservationKernel kernel;
  std::unique_ptr<ceres::LossFunction> loss;  ///< of the kernel
  std::vector<FrameGeometry> geometry;        ///< of every frame, at the present states
  std::unique_ptr<GeometryCache> cache;       ///< likewise, at the solver's
};

/// One view of a track with an explicit landmark. In Ceres the landmark's coordinates move with the base
/// frame (InverseDepthFactor, BaseBearingFactor); linearised it is a point of the world (LinearizeView), so
/// that a view concerns one frame alone. Once the landmark is eliminated both are equal.
class ViewTerm final : public WindowTerm {
 public:
  /// `landmark`: the track's index among the landmarks of the problem. The track must outlive the term.
  ViewTerm(std::shared_ptr<const ViewContext> context, const WindowTrack* track, int landmark, size_t view);

  Status Linearize(LinearTerm* linear) const override;
  void AddTo(WindowProblem* problem) override;

 private:
  std::shared_ptr<const ViewContext> context_;
  const WindowTrack* track_;
  int landmark_;
  size_t view_;
  std::unique_ptr<ceres::CostFunction> cost_;
};

/// The weak prior on the inverse depth of a track without parallax, linearised as its views are.
class DepthPriorTerm final : public WindowTerm {
 public:
  DepthPriorTerm(std::shared_ptr<const ViewContext> context, const WindowTrack* track, int landmark);

  Status Linearize(LinearTerm* linear) const override;
  void AddTo(WindowProblem* problem) override;

 private:
  std::shared_ptr<const ViewContext> context_;
  const WindowTrack* track_;
  int landmark_;
  LiftedCost<DepthPriorFactor> cost_;
};

/// Appends the views and depth priors of tracks with explicit landmarks, track by track. All must outlive the
/// terms.
void AddTrackTerms(const WindowFrames& frames, const std::vector<WindowTrack*>& tracks,
                   const WindowCalibration& calibration, const ObservationKernel& kernel, WindowTerms* terms);

}  // namespace alidade
