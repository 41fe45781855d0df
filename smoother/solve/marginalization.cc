#include "smoother/solve/marginalization.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "smoother/solve/marginal_stack.h"

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The columns of a window whose oldest frame leaves. First what is eliminated: the oldest frame, its clock,
/// landmarks that leave. Then those of the next prior.
struct LeavingColumns {
  LeavingColumns(const Window& window, const LinearPrior& prior, const WindowCalibration& calibration,
                 const SlamChange& slam);

  ColumnMap columns;
  Index leaving = 0;
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
  int landmarks = 0;
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

/// What the old prior and the landmarks' views contribute.
class PriorRows {
 public:
  PriorRows(const Window& window, const LinearPrior& prior, const WindowCalibration& calibration,
            const SlamChange& slam, const LeavingColumns& leaving, MarginalStack* stack)
      : window_(window),
        prior_(prior),
        columns_(prior.columns()),
        calibration_(calibration),
        slam_(slam),
        leaving_(leaving),
        stack_(*stack) {
    CHECK(slam.before.size() == prior.landmarks.size());
    CHECK(calibration.size() == prior.calibration_origin.size());
    if (!slam.before.empty() || !slam.after.empty()) {
      geometry_ = MakeGeometry(window, calibration.mean);
    }
  }

  void AddPrior();
  void AddLandmarkViews();

 private:
  [[nodiscard]] ColumnMap::Range Pose(int frame) const {
    return {stack_.columns().Frame(frame).first, kPoseColumns};
  }
  void AddLandmark(size_t landmark, Index rows, VectorXd* residual);
  void AddView(const WindowTrack& track, const WindowView& view, int landmark);

  const Window& window_;
  const LinearPrior& prior_;
  ColumnMap columns_;  ///< of the old prior
  const WindowCalibration& calibration_;
  const SlamChange& slam_;
  const LeavingColumns& leaving_;
  MarginalStack& stack_;
  std::vector<FrameGeometry> geometry_;
};

void PriorRows::AddPrior() {
  const Index count = prior_.jacobian.rows();
  const Index first = stack_.NewRows(count);
  const auto columns = [&](const ColumnMap::Range& of) {
    return prior_.jacobian.middleCols(of.first, of.size);
  };
  VectorXd residual = prior_.residual;
  for (size_t i = 0; i < prior_.anchors.size(); ++i) {
    const LinearPrior::Anchor& anchor = prior_.anchors[i];
    const ColumnMap::Range from = columns_.Frame(static_cast<int>(i));
    Vector15d xi;
    xi.head<9>() = Local(prior_.convention, anchor.origin, anchor.frame->nav_state());
    const ImuBias bias = anchor.frame->imu_bias();
    xi.tail<6>() << bias.gyro - anchor.bias_origin.gyro, bias.accel - anchor.bias_origin.accel;
    const ColumnMap::Range to{stack_.columns().Frame(anchor.frame->index).first, from.size};
    stack_.Columns(to, first, count) = columns(from);
    residual.noalias() += columns(from) * xi.head(from.size);
  }
  if (prior_.clock_origin) {
    const MatrixXd jacobian = columns(columns_.Clock(0));
    stack_.Columns(stack_.columns().Clock(0), first, count) = jacobian;
    residual.noalias() += jacobian * (window_.frame(0).clock_state() - *prior_.clock_origin);
  }
  const WindowCalibration& origin = prior_.calibration_origin;
  const MatrixXd jacobian = columns(columns_.Calibration());
  stack_.Columns(stack_.columns().Calibration(), first, count) = jacobian;
  residual.noalias() += jacobian * Local(origin.layout, origin.mean, calibration_.mean);
  for (size_t i = 0; i < prior_.landmarks.size(); ++i) {
    AddLandmark(i, count, &residual);
  }
  stack_.Residual(first, count) = residual;
}

void PriorRows::AddLandmark(size_t landmark, Index rows, VectorXd* residual) {
  const LinearPrior::Landmark& known = prior_.landmarks[landmark];
  const WindowTrack* track = slam_.before[landmark];
  const MatrixXd columns =
      prior_.jacobian.middleCols<kLandmarkColumns>(columns_.Landmark(static_cast<int>(landmark)).first);
  auto own = stack_.Columns(stack_.columns().Landmark(leaving_.before[landmark]), 0, rows);
  if (track == nullptr) {
    own = columns;
    return;
  }
  if (track->anchor == known.anchor) {
    own = columns;
    residual->noalias() += columns * (track->landmark - known.origin);
    return;
  }
  // The track has changed its anchor: the old coordinates as a function of the new ones and both frames.
  const int from = known.anchor->index;
  const int to = track->anchor->index;
  AnchorChange back;
  CHECK(ChangeAnchor(geometry_[static_cast<size_t>(to)], geometry_[static_cast<size_t>(from)],
                     track->landmark, &back, {}, {track->plane(), known.plane}));
  AnchorChange change;
  CHECK(ChangeAnchor(geometry_[static_cast<size_t>(from)], geometry_[static_cast<size_t>(to)], back.to,
                     &change, calibration_.layout, {known.plane, track->plane()}));
  own.noalias() = columns * change.landmark;
  stack_.Columns(Pose(from), 0, rows).noalias() += columns * (change.from_frame * stack_.PoseChart(from));
  stack_.Columns(Pose(to), 0, rows).noalias() += columns * (change.to_frame * stack_.PoseChart(to));
  stack_.Columns(stack_.columns().Calibration(), 0, rows).noalias() += columns * change.calibration;
  residual->noalias() += columns * (back.to - known.origin);
}

void PriorRows::AddView(const WindowTrack& track, const WindowView& view, int landmark) {
  AnchoredRows rows;
  const int anchor = track.anchor->index;
  const int seen = view.frame->index;
  FrameGeometry row;
  if (!LinearizeAnchoredView(geometry_[static_cast<size_t>(anchor)], AtRow(geometry_, view, &row),
                             view.observation, slam_.kernel, track.landmark, &rows, true, calibration_,
                             track.plane())) {
    return;
  }
  const Index first = stack_.NewRows(2);
  const double root = std::sqrt(rows.weight);
  if (anchor != seen) {
    stack_.Columns(Pose(anchor), first, 2) =
        Eigen::Matrix<double, 2, 6>(root * rows.anchor * stack_.PoseChart(anchor));
    stack_.Columns(Pose(seen), first, 2) =
        Eigen::Matrix<double, 2, 6>(root * rows.view * stack_.PoseChart(seen));
  }
  stack_.Columns(stack_.columns().Calibration(), first, 2) = root * rows.calibration;
  stack_.Columns(stack_.columns().Landmark(landmark), first, 2) = root * rows.landmark;
  stack_.Residual(first, 2) = root * rows.residual;
}

void PriorRows::AddLandmarkViews() {
  for (size_t i = 0; i < slam_.before.size(); ++i) {
    for (size_t k = 0; leaving_.leaves[i] && slam_.before[i] != nullptr && k < slam_.before[i]->views.size();
         ++k) {
      AddView(*slam_.before[i], slam_.before[i]->views[k], leaving_.before[i]);
    }
  }
  for (size_t i = 0; i < slam_.after.size(); ++i) {
    const std::vector<WindowView>& views = slam_.after[i]->views;
    if (!views.empty() && views.front().frame->index == 0) {
      AddView(*slam_.after[i], views.front(), leaving_.after[i]);
    }
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
  const ColumnMap columns = next->columns();
  for (size_t i = 0; i < next->anchors.size(); ++i) {
    const LinearPrior::Anchor& anchor = next->anchors[i];
    if (anchor.frame->first) {  // the origin is another than the present state
      const ColumnMap::Range of = columns.Frame(static_cast<int>(i));
      const Index width = std::min(of.size, kNavColumns);
      const Vector9d xi = Local(next->convention, anchor.origin, anchor.frame->nav_state());
      next->residual.noalias() -= next->jacobian.middleCols(of.first, width) * xi.head(width);
    }
  }
}

}  // namespace

Result<LinearPrior> MarginalizeOldest(const Window& window, const LinearPrior& prior,
                                      const WindowCalibration& calibration, const WindowTerms& terms,
                                      const SlamChange& slam) {
  const LeavingColumns leaving(window, prior, calibration, slam);
  MarginalStack stack(window, prior.convention, leaving.columns, leaving.leaving);
  PriorRows rows(window, prior, calibration, slam, leaving, &stack);
  rows.AddPrior();
  LinearTerm linear;
  for (const std::unique_ptr<WindowTerm>& term : terms) {
    if (term->Concerns({Unknown::Kind::kFrame, 0}) || term->Concerns({Unknown::Kind::kClock, 0})) {
      ALIDADE_RETURN_IF_ERROR(term->Linearize(&linear));
      stack.Add(&linear);
    }
  }
  rows.AddLandmarkViews();
  LinearPrior next;
  next.convention = prior.convention;
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
    window->frame(anchor.frame->index).first = FirstEstimate{prior.convention, anchor.origin, i == 0};
  }
}

}  // namespace alidade
