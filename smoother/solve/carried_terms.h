#pragma once

#include <Eigen/Core>
#include <vector>

#include "smoother/factors/prior_factor.h"
#include "smoother/solve/window_term.h"
#include "smoother/window/frame_geometry.h"

namespace alidade {

/// A landmark of a LinearPrior: its track, and its number among the window's unknowns.
struct PriorLandmark {
  const WindowTrack* track = nullptr;  ///< null: lost
  int number = 0;
};

/// A prior as it enters the next one: its landmarks explicit, the residual at the present states, the
/// Jacobian as it was made (first estimates; LinearTerm::Chart::kPrior), over the errors in the next chart.
/// The residual is that of PriorFactor; MakePriorTerm and SlamPriorTerm are the same information for the
/// solver.
class CarriedPrior final : public InformationTerm {
 public:
  /// `landmarks`: as the prior's. All must outlive the term. `geometry`: of every frame, used where a
  /// landmark has changed its anchor.
  CarriedPrior(const LinearPrior& prior, const StateChart& next, const Window& window,
               const WindowCalibration& calibration, std::vector<PriorLandmark> landmarks,
               const std::vector<FrameGeometry>& geometry);

  Status Linearize(LinearTerm* linear) const override;

 private:
  struct Rows;

  void AddFrames(Rows* rows) const;
  void AddClockAndCalibration(Rows* rows) const;
  void AddLandmark(size_t landmark, Rows* rows) const;
  void AddSpread(Rows* rows) const;

  const LinearPrior& prior_;
  StateChart next_;
  const Window& window_;
  const WindowCalibration& calibration_;
  std::vector<PriorLandmark> landmarks_;
  const std::vector<FrameGeometry>& geometry_;
  ColumnMap prior_columns_;
  ColumnMap columns_;  ///< of the term
};

/// A view of a landmark that has columns of its own (a SLAM feature), which moves with its anchor. No rows
/// where the landmark lies behind the view.
class AnchoredViewTerm final : public InformationTerm {
 public:
  /// All must outlive the term; `view` is one of the track's.
  AnchoredViewTerm(const std::vector<FrameGeometry>& geometry, const WindowCalibration& calibration,
                   const ObservationKernel& kernel, const WindowTrack& track, const WindowView& view,
                   int landmark);

  Status Linearize(LinearTerm* linear) const override;

 private:
  const std::vector<FrameGeometry>& geometry_;
  const WindowCalibration& calibration_;
  ObservationKernel kernel_;
  const WindowTrack& track_;
  const WindowView& view_;
  bool by_anchor_;
};

}  // namespace alidade
