#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "smoother/factors/prior_factor.h"
#include "smoother/factors/reduced_cost.h"
#include "smoother/tracks/anchored_landmark.h"

namespace alidade {

/// Tracks of the prior's landmarks, in their order; null where the track was lost or refused, then only the
/// prior has information about the landmark.
[[nodiscard]] std::vector<const WindowTrack*> PriorTracks(const LinearPrior& prior, const Window& window);

/// A LinearPrior together with the views of its landmarks (SLAM features), as a function of the frames alone:
///
///     F(X) = min_L |r0 + J_x xi(X) + J_l (D(X) L - L0)|^2 + sum over views of rho(|W (pi(X, l) - z)|^2),
///
/// D multiplies inverse depths by the ratio of the spread (LinearPrior::SpreadAt).
///
/// Variable projection (ReducedCost). The prior couples the landmarks, so that they are solved for together
/// (3L x 3L, damped, re-weighted Gauss-Newton).
class SlamPrior {
 public:
  /// `prior`, `tracks` (PriorTracks), `window` and `calibration` must outlive it.
  SlamPrior(const LinearPrior* prior, std::vector<const WindowTrack*> tracks, const Window& window,
            const WindowCalibration& calibration, const ObservationKernel& kernel);

  /// PriorColumns of all frames of the window, without landmarks.
  [[nodiscard]] const ColumnMap& columns() const { return columns_; }
  [[nodiscard]] const LinearPrior& prior() const { return *prior_; }
  [[nodiscard]] std::span<const WindowTrack* const> tracks() const { return tracks_; }

  /// Landmarks of the tracks, the prior's origins where there is none: where Reduce may start.
  [[nodiscard]] Eigen::VectorXd StartingLandmarks() const;
  /// The landmarks (3L; start and result) that minimise F, and its value. False: behind a view, or not
  /// finite.
  bool SolveLandmarks(const WindowPoint& point, Eigen::VectorXd* landmarks, double* cost) const;
  /// Normal equations over columns(), landmarks eliminated, canonical chart, at landmarks that SolveLandmarks
  /// gave there; false as there.
  bool Linearize(const WindowPoint& point, const Eigen::VectorXd& landmarks,
                 NormalEquations* equations) const;

 private:
  struct Views;  // information of the views at a point
  /// Where the cameras are at a point, and the rays they see.
  struct Scene {
    std::vector<FrameGeometry> geometry;
    WindowCalibration calibration;
    std::vector<const std::vector<WindowView>*> views;  ///< of each track; null: lost
    std::vector<std::vector<WindowView>> renormalized;  ///< likewise: what `views` may refer to
    LinearPrior::SpreadChange spread;
    LinearPrior::FrameErrors frames;
    Eigen::VectorXd units;  ///< diagonal of D, 3L
  };
  [[nodiscard]] Scene MakeScene(const WindowPoint& point) const;
  bool See(const Scene& scene, const Eigen::VectorXd& landmarks, bool with_frames, Views* views) const;
  [[nodiscard]] Eigen::VectorXd Displacement(const WindowPoint& point, const Scene& scene) const;
  [[nodiscard]] Eigen::MatrixXd ChainFrames(const WindowPoint& point, const Scene& scene,
                                            const Eigen::MatrixXd& columns) const;
  /// The slope of the spread, over columns().
  [[nodiscard]] Eigen::RowVectorXd SpreadRow(const LinearPrior::SpreadChange& spread) const;
  /// Over the landmarks, of the prior and the views, made regular.
  [[nodiscard]] Eigen::MatrixXd LandmarkHessian(const Views& views, const Scene& scene, double damping) const;
  /// The prior's part of F with the landmarks at its origins. xi: Displacement.
  [[nodiscard]] double CostAtOrigins(const Eigen::VectorXd& xi) const;
  /// SolveLandmarks for at least one of them. xi: Displacement.
  bool Minimize(const Eigen::VectorXd& xi, const Scene& scene, Eigen::VectorXd* landmarks,
                double* cost) const;

  const LinearPrior* prior_;
  std::vector<const WindowTrack*> tracks_;
  ObservationKernel kernel_;
  const Window* window_;
  const WindowCalibration* calibration_;
  ColumnMap prior_columns_;
  ColumnMap columns_;
  Eigen::MatrixXd gram_;  ///< [J r0]^T [J r0]: frames, clock and calibration first, then landmarks, then r0
  Eigen::VectorXd origins_;
};

}  // namespace alidade
