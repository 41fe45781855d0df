#include "smoother/solve/marginalization.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "core/check.h"
#include "smoother/factors/spread.h"
#include "smoother/solve/carried_terms.h"
#include "smoother/solve/marginal_stack.h"

namespace alidade {
namespace {

using Eigen::Index;

/// The columns of a window whose oldest frame leaves. First what is eliminated: the oldest frame, its clock,
/// landmarks that leave. Then those of the next prior.
struct LeavingColumns {
  LeavingColumns(const Window& window, const LinearPrior& prior, const WindowCalibration& calibration,
                 const SlamChange& slam);

  /// Whether a term concerns what leaves.
  [[nodiscard]] bool Reach(const InformationTerm& term) const;

  ColumnMap columns;
  Index leaving = 0;
  int landmarks = 0;        ///< that leave
  std::vector<int> before;  ///< number of each landmark of SlamChange::before
  std::vector<bool> leaves;
  std::vector<int> after;  ///< of each of SlamChange::after
};

LeavingColumns::LeavingColumns(const Window& window, const LinearPrior& prior,
                               const WindowCalibration& calibration, const SlamChange& slam) {
  columns.AddState(0);
  if (prior.clock_origin) {
    columns.AddClock(0);
  }
  for (const WindowTrack* track : slam.before) {
    const auto stays = std::find(slam.after.begin(), slam.after.end(), track);
    leaves.push_back(track == nullptr || stays == slam.after.end());
    before.push_back(leaves.back() ? landmarks++ : static_cast<int>(stays - slam.after.begin()));
  }
  for (size_t i = 0; i < before.size(); ++i) {
    before[i] += leaves[i] ? 0 : landmarks;
  }
  for (int i = 0; i < landmarks; ++i) {
    columns.AddLandmark(i);
  }
  leaving = columns.size();
  for (int i = 1; i < window.size(); ++i) {
    i == 1 ? columns.AddState(i) : columns.AddPose(i);
  }
  if (prior.clock_origin) {
    columns.AddClock(1);
  }
  columns.AddCalibration(calibration.size());
  for (size_t i = 0; i < slam.after.size(); ++i) {
    after.push_back(landmarks + static_cast<int>(i));
    columns.AddLandmark(after.back());
  }
}

bool LeavingColumns::Reach(const InformationTerm& term) const {
  return std::any_of(term.parts().begin(), term.parts().end(), [&](const TermPart& part) {
    const ColumnMap::Range at = columns.Find(part.of);
    return at.size > 0 && at.first < leaving;
  });
}

/// The old prior and the landmarks' views that leave (SlamChange), as terms.
class CarriedTerms {
 public:
  CarriedTerms(const Window& window, const LinearPrior& prior, const StateChart& next,
               const WindowCalibration& calibration, const SlamChange& slam, const LeavingColumns& leaving);
  CarriedTerms(const CarriedTerms&) = delete;  // the terms refer to geometry_
  CarriedTerms& operator=(const CarriedTerms&) = delete;
  CarriedTerms(CarriedTerms&&) = delete;
  CarriedTerms& operator=(CarriedTerms&&) = delete;
  ~CarriedTerms() = default;

  [[nodiscard]] const InformationTerm& prior() const { return *prior_; }
  [[nodiscard]] const std::vector<AnchoredViewTerm>& views() const { return views_; }

 private:
  std::vector<FrameGeometry> geometry_;
  std::optional<CarriedPrior> prior_;
  std::vector<AnchoredViewTerm> views_;
};

CarriedTerms::CarriedTerms(const Window& window, const LinearPrior& prior, const StateChart& next,
                           const WindowCalibration& calibration, const SlamChange& slam,
                           const LeavingColumns& leaving) {
  if (!slam.before.empty() || !slam.after.empty()) {
    geometry_ = MakeGeometry(window, calibration.mean);
  }
  CHECK(slam.before.size() == prior.landmarks.size());
  std::vector<PriorLandmark> landmarks;
  const auto add_view = [&](const WindowTrack& track, const WindowView& view, int number) {
    views_.emplace_back(geometry_, calibration, slam.kernel, track, view, number);
  };
  for (size_t i = 0; i < slam.before.size(); ++i) {
    landmarks.push_back({slam.before[i], leaving.before[i]});
    if (leaving.leaves[i] && slam.before[i] != nullptr) {
      for (const WindowView& view : slam.before[i]->views) {
        add_view(*slam.before[i], view, leaving.before[i]);
      }
    }
  }
  for (size_t i = 0; i < slam.after.size(); ++i) {
    for (const WindowView& view : slam.after[i]->views) {
      if (view.frame->index == 0) {
        add_view(*slam.after[i], view, leaving.after[i]);
      }
    }
  }
  prior_.emplace(prior, next, window, calibration, std::move(landmarks), geometry_);
}

/// Inverse depths times the ratio of the spread in place of the inverse depths.
void RelateToSpread(const WindowPoint& present, LinearPrior* next) {
  next->spread = SpreadOf(std::span(present.states).subspan(1), present.camera.T_BC.translation).metres;
  const Eigen::Matrix<double, 6, Eigen::Dynamic> slope =
      SpreadPriorSlope(*next, next->SpreadAt(present.states), next->chart);
  const ColumnMap columns = next->columns();
  Eigen::VectorXd along_scale = Eigen::VectorXd::Zero(next->jacobian.rows());
  for (size_t i = 0; i < next->landmarks.size(); ++i) {
    const Index inverse_depth = columns.Landmark(static_cast<int>(i)).first + 2;
    along_scale += next->landmarks[i].origin.z() * next->jacobian.col(inverse_depth);
  }
  for (size_t i = 0; i < next->anchors.size(); ++i) {
    next->jacobian.middleCols<kPoseColumns>(columns.Frame(static_cast<int>(i)).first).noalias() -=
        along_scale * slope.col(static_cast<Index>(i)).transpose();
  }
}

/// Names what the rows of a new prior are about. They hold at the present states.
void AnchorPrior(const Window& window, const SlamChange& slam, LinearPrior* next) {
  for (int i = 1; i < window.size(); ++i) {
    const WindowFrame& frame = window.frame(i);
    const NavState now = frame.nav_state();
    next->anchors.push_back({&frame, frame.first ? frame.first->Point(now) : now, frame.imu_bias()});
  }
  for (const WindowTrack* track : slam.after) {
    next->landmarks.push_back({track->id, track->anchor, track->landmark, track->plane()});
  }
  if (slam.relative_to_spread) {
    RelateToSpread(PointOf(window, next->calibration_origin.mean), next);
  }
  const ColumnMap columns = next->columns();
  for (size_t i = 0; i < next->anchors.size(); ++i) {
    const LinearPrior::Anchor& anchor = next->anchors[i];
    if (anchor.frame->first) {  // the origin is another than the present state
      const ColumnMap::Range of = columns.Frame(static_cast<int>(i));
      const Index width = std::min(of.size, kNavColumns);
      const Vector9d xi = next->chart.Local(anchor.origin, anchor.frame->nav_state());
      next->residual.noalias() -= next->jacobian.middleCols(of.first, width) * xi.head(width);
    }
  }
}

}  // namespace

Result<LinearPrior> MarginalizeOldest(const Window& window, const LinearPrior& prior,
                                      const WindowCalibration& calibration, const WindowTerms& terms,
                                      const SlamChange& slam) {
  const LeavingColumns leaving(window, prior, calibration, slam);
  LinearPrior next;
  next.chart = {prior.chart.convention, window.frame(1).nav_state().p_WB};
  MarginalStack stack(window, next.chart, leaving.columns, leaving.leaving);
  const CarriedTerms carried(window, prior, next.chart, calibration, slam, leaving);
  std::vector<const InformationTerm*> all = {&carried.prior()};
  for (const std::unique_ptr<WindowTerm>& term : terms) {
    all.push_back(term.get());
  }
  for (const AnchoredViewTerm& view : carried.views()) {
    all.push_back(&view);
  }
  LinearTerm linear;
  for (const InformationTerm* term : all) {
    if (leaving.Reach(*term)) {
      ALIDADE_RETURN_IF_ERROR(term->Linearize(&linear));
      stack.Add(&linear);
    }
  }
  for (int i = 0; i < leaving.landmarks; ++i) {  // a refused track's may have a single view in the prior
    stack.MakeRegular(leaving.columns.Landmark(i));
  }
  stack.Eliminate(&next.jacobian, &next.residual);
  if (prior.clock_origin) {
    next.clock_origin = window.frame(1).clock_state();
  }
  next.calibration_origin = calibration;
  AnchorPrior(window, slam, &next);
  return next;
}

void KeepFirstEstimates(const LinearPrior& prior, Window* window) {
  for (size_t i = 0; i < prior.anchors.size(); ++i) {
    const LinearPrior::Anchor& anchor = prior.anchors[i];
    window->frame(anchor.frame->index).first = FirstEstimate{prior.chart, anchor.origin, i == 0};
  }
}

}  // namespace alidade
