#include "smoother/solve/marginalization.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "smoother/manifold/dense_blas.h"
#include "smoother/solve/frame_rows.h"

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Whitened rows over all that the oldest frame's leaving concerns. Columns: the oldest frame (15), with GNSS
/// its clock (6), landmarks that leave (3 each), the next frame (15), poses of the others (6 each), with GNSS
/// the next clock (6), the calibration where it is estimated, landmarks that stay (3 each), the residual.
class OldestStack {
 public:
  OldestStack(const Window& window, const LinearPrior& prior, const SlamChange& slam,
              const GnssFactorContext* gnss, const WindowCalibration* calibration);

  void AddPrior();
  void AddImu(const Eigen::Vector3d& gravity_W);
  void AddVision(const PoseSystem& vision);
  void AddRest();
  void AddGnss();
  void AddLandmarkViews();
  [[nodiscard]] LinearPrior Eliminate();

 private:
  [[nodiscard]] Index Frame(int frame) const {
    return frame == 0 ? 0 : leaving_ + (frame == 1 ? 0 : 15 + 6 * (frame - 2));
  }
  [[nodiscard]] Index Clock() const { return Frame(window_.size()); }
  [[nodiscard]] Index Calibration() const { return Clock() + clock_; }
  [[nodiscard]] Index calibration_size() const { return prior_.calibration_size(); }
  [[nodiscard]] Index Staying(size_t landmark) const {
    return Calibration() + calibration_size() + 3 * static_cast<Index>(landmark);
  }
  [[nodiscard]] Index residual_column() const { return Staying(slam_.after.size()); }
  Index NewRows(Index count);
  /// d (phi, dp) of a frame's body / d its columns.
  [[nodiscard]] Matrix6d Chart(int frame) const;
  /// The same of its whole state.
  [[nodiscard]] Matrix15d ImuChart(int frame) const;
  void AddPriorLandmark(size_t landmark, Index rows, VectorXd* residual);
  void AddView(const WindowTrack& track, const WindowView& view, Index landmark_column);

  const Window& window_;
  const LinearPrior& prior_;
  const SlamChange& slam_;
  const GnssFactorContext* gnss_;
  const WindowCalibration* calibration_;
  Index clock_;
  Index leaving_;                 ///< columns
  std::vector<Index> column_of_;  ///< of the old prior's landmarks
  std::vector<bool> leaves_;
  std::vector<FrameGeometry> geometry_;
  MatrixXd stack_;
  Index rows_ = 0;
};

OldestStack::OldestStack(const Window& window, const LinearPrior& prior, const SlamChange& slam,
                         const GnssFactorContext* gnss, const WindowCalibration* calibration)
    : window_(window),
      prior_(prior),
      slam_(slam),
      gnss_(gnss),
      calibration_(calibration),
      clock_(gnss != nullptr ? 6 : 0) {
  CHECK(slam.before.size() == prior.landmarks.size());
  CHECK((calibration == nullptr) == !prior.calibration_origin.has_value());
  if (!slam.before.empty() || !slam.after.empty()) {
    geometry_ =
        calibration == nullptr ? MakeGeometry(window, slam.T_BC) : MakeGeometry(window, calibration->mean);
  }
  leaving_ = 15 + clock_;
  for (const WindowTrack* track : slam.before) {
    const auto stays = std::find(slam.after.begin(), slam.after.end(), track);
    leaves_.push_back(track == nullptr || stays == slam.after.end());
    column_of_.push_back(leaves_.back() ? leaving_ : stays - slam.after.begin());
    leaving_ += leaves_.back() ? 3 : 0;
  }
  for (size_t i = 0; i < column_of_.size(); ++i) {
    column_of_[i] = leaves_[i] ? column_of_[i] : Staying(static_cast<size_t>(column_of_[i]));
  }
  stack_.resize(2 * residual_column(), residual_column() + 1);
}

Index OldestStack::NewRows(Index count) {
  const Index first = rows_;
  rows_ += count;
  if (rows_ > stack_.rows()) {
    stack_.conservativeResize(std::max(rows_, 2 * stack_.rows()), residual_column() + 1);
  }
  stack_.middleRows(first, count).setZero();
  return first;
}

Matrix6d OldestStack::Chart(int frame) const {
  if (window_.frame(frame).first) {
    return ImuChart(frame).topLeftCorner<6, 6>();
  }
  return ChartJacobian(prior_.convention, window_.frame(frame).nav_state().T_WB());
}

Matrix15d OldestStack::ImuChart(int frame) const {
  const WindowFrame& of = window_.frame(frame);
  const NavState state = of.nav_state();
  Matrix15d chart = ImuChartJacobian(prior_.convention, state);
  if (of.first) {
    // The columns are the prior's coordinates, around the first estimate.
    const Matrix9d moved = LocalJacobian(prior_.convention, of.first->Point(state), state);
    chart.topLeftCorner<9, 9>() = (chart.topLeftCorner<9, 9>() * moved.inverse()).eval();
  }
  return chart;
}

void OldestStack::AddPrior() {
  const Index count = prior_.jacobian.rows();
  const Index first = NewRows(count);
  CHECK(first == 0);
  VectorXd residual = prior_.residual;
  for (size_t i = 0; i < prior_.anchors.size(); ++i) {
    const LinearPrior::Anchor& anchor = prior_.anchors[i];
    const Index width = i == 0 ? 15 : 6;
    const Index from = LinearPrior::Column(static_cast<int>(i));
    Vector15d xi;
    xi.head<9>() = Local(prior_.convention, anchor.origin, anchor.frame->nav_state());
    const ImuBias bias = anchor.frame->imu_bias();
    xi.tail<6>() << bias.gyro - anchor.bias_origin.gyro, bias.accel - anchor.bias_origin.accel;
    stack_.block(0, Frame(anchor.frame->index), count, width) = prior_.jacobian.middleCols(from, width);
    residual.noalias() += prior_.jacobian.middleCols(from, width) * xi.head(width);
  }
  if (gnss_ != nullptr) {
    const MatrixXd jacobian = prior_.jacobian.middleCols<6>(prior_.ClockColumn());
    stack_.block(0, 15, count, 6) = jacobian;
    residual.noalias() += jacobian * (window_.frame(0).clock_state() - *prior_.clock_origin);
  }
  if (calibration_ != nullptr) {
    const WindowCalibration& origin = *prior_.calibration_origin;
    const MatrixXd jacobian = prior_.jacobian.middleCols(prior_.CalibrationColumn(), calibration_size());
    stack_.block(0, Calibration(), count, calibration_size()) = jacobian;
    residual.noalias() += jacobian * Local(origin.layout, origin.mean, calibration_->mean);
  }
  for (size_t i = 0; i < prior_.landmarks.size(); ++i) {
    AddPriorLandmark(i, count, &residual);
  }
  stack_.col(residual_column()).head(count) = residual;
}

void OldestStack::AddPriorLandmark(size_t landmark, Index rows, VectorXd* residual) {
  const LinearPrior::Landmark& known = prior_.landmarks[landmark];
  const WindowTrack* track = slam_.before[landmark];
  const MatrixXd columns = prior_.jacobian.middleCols<3>(prior_.LandmarkColumn(static_cast<int>(landmark)));
  const Index at = column_of_[landmark];
  if (track == nullptr) {
    stack_.block(0, at, rows, 3) = columns;
    return;
  }
  if (track->anchor == known.anchor) {
    stack_.block(0, at, rows, 3) = columns;
    residual->noalias() += columns * (track->landmark - known.origin);
    return;
  }
  // The track has changed its anchor: the old coordinates as a function of the new ones and both frames.
  const int from = known.anchor->index;
  const int to = track->anchor->index;
  AnchorChange back;
  CHECK(ChangeAnchor(geometry_[static_cast<size_t>(to)], geometry_[static_cast<size_t>(from)],
                     track->landmark, &back));
  AnchorChange change;
  CHECK(ChangeAnchor(geometry_[static_cast<size_t>(from)], geometry_[static_cast<size_t>(to)], back.to,
                     &change, calibration_ == nullptr ? nullptr : &calibration_->layout));
  stack_.block(0, at, rows, 3).noalias() = columns * change.landmark;
  stack_.block(0, Frame(from), rows, 6).noalias() += columns * (change.from_frame * Chart(from));
  stack_.block(0, Frame(to), rows, 6).noalias() += columns * (change.to_frame * Chart(to));
  if (calibration_ != nullptr) {
    stack_.block(0, Calibration(), rows, calibration_size()).noalias() += columns * change.calibration;
  }
  residual->noalias() += columns * (back.to - known.origin);
}

void OldestStack::AddImu(const Eigen::Vector3d& gravity_W) {
  const Index first = NewRows(15);
  const ImuRows imu = LinearizeImu(window_.frame(0), window_.frame(1), gravity_W);
  stack_.block<15, 15>(first, 0) = imu.first * ImuChart(0);
  stack_.block<15, 15>(first, Frame(1)) = imu.second * ImuChart(1);
  stack_.col(residual_column()).segment<15>(first) = imu.residual;
}

void OldestStack::AddVision(const PoseSystem& vision) {
  MatrixXd jacobian;
  VectorXd residual;
  SquareRootRows(vision.hessian, vision.gradient, &jacobian, &residual);
  const Index count = residual.size();
  const Index first = NewRows(count);
  for (int i = 0; i < window_.size(); ++i) {
    stack_.block(first, Frame(i), count, 6).noalias() = jacobian.middleCols<6>(6 * i) * Chart(i);
  }
  stack_.block(first, Calibration(), count, calibration_size()) = jacobian.rightCols(calibration_size());
  stack_.col(residual_column()).segment(first, count) = residual;
}

void OldestStack::AddRest() {
  if (!window_.frame(0).rest) {
    return;
  }
  const Index first = NewRows(RestModel::kRows);
  const RestRows rest(window_.frame(0));
  stack_.block<RestModel::kRows, 15>(first, 0) = rest.jacobian * ImuChart(0);
  stack_.col(residual_column()).segment<RestModel::kRows>(first) = rest.residual;
}

void OldestStack::AddGnss() {
  if (gnss_ == nullptr) {
    return;
  }
  const WindowFrame& oldest = window_.frame(0);
  const FrameEpochRows epochs = EpochRows(*gnss_, oldest);
  const Index count = epochs.residual.size();
  const Index first = NewRows(count + clock_);
  stack_.block(first, 0, count, 15) = epochs.frame * ImuChart(0);
  stack_.block(first, 15, count, 6) = epochs.clock;
  stack_.col(residual_column()).segment(first, count) = epochs.residual;
  const ClockStep step = StepTo(*gnss_, oldest, window_.frame(1));
  stack_.block<6, 6>(first + count, 15) = -step.root * step.phi;
  stack_.block<6, 6>(first + count, Clock()) = step.root;
  stack_.col(residual_column()).segment<6>(first + count) =
      step.root * (window_.frame(1).clock_state() - step.phi * oldest.clock_state());
}

void OldestStack::AddView(const WindowTrack& track, const WindowView& view, Index landmark_column) {
  AnchoredRows rows;
  const int anchor = track.anchor->index;
  const int seen = view.frame->index;
  if (!LinearizeAnchoredView(geometry_[static_cast<size_t>(anchor)], geometry_[static_cast<size_t>(seen)],
                             view.observation, slam_.kernel, track.landmark, &rows, true, calibration_)) {
    return;
  }
  const Index first = NewRows(2);
  const double root = std::sqrt(rows.weight);
  if (anchor != seen) {
    stack_.block<2, 6>(first, Frame(anchor)) = root * rows.anchor * Chart(anchor);
    stack_.block<2, 6>(first, Frame(seen)) = root * rows.view * Chart(seen);
  }
  if (calibration_ != nullptr) {
    stack_.block(first, Calibration(), 2, calibration_size()) = root * rows.calibration;
  }
  stack_.block<2, 3>(first, landmark_column) = root * rows.landmark;
  stack_.col(residual_column()).segment<2>(first) = root * rows.residual;
}

void OldestStack::AddLandmarkViews() {
  for (size_t i = 0; i < slam_.before.size(); ++i) {
    for (size_t k = 0; leaves_[i] && slam_.before[i] != nullptr && k < slam_.before[i]->views.size(); ++k) {
      AddView(*slam_.before[i], slam_.before[i]->views[k], column_of_[i]);
    }
  }
  for (size_t i = 0; i < slam_.after.size(); ++i) {
    const std::vector<WindowView>& views = slam_.after[i]->views;
    if (!views.empty() && views.front().frame->index == 0) {
      AddView(*slam_.after[i], views.front(), Staying(i));
    }
  }
}

LinearPrior OldestStack::Eliminate() {
  const Index columns = residual_column();
  if (rows_ < columns + 1) {
    NewRows(columns + 1 - rows_);
  }
  MatrixXd rows = stack_.topRows(rows_);
  Triangularize(&rows);
  LinearPrior next;
  next.convention = prior_.convention;
  const Index kept = columns - leaving_;
  next.jacobian = rows.block(leaving_, leaving_, kept, kept).triangularView<Eigen::Upper>();
  next.residual = rows.col(columns).segment(leaving_, kept);
  if (gnss_ != nullptr) {
    next.clock_origin = window_.frame(1).clock_state();
  }
  if (calibration_ != nullptr) {
    next.calibration_origin = *calibration_;
  }
  for (int i = 1; i < window_.size(); ++i) {
    const WindowFrame& frame = window_.frame(i);
    const NavState now = frame.nav_state();
    next.anchors.push_back({&frame, frame.first ? frame.first->Point(now) : now, frame.imu_bias()});
    if (frame.first) {  // the rows hold at the present state, the origin is another
      const Index width = i == 1 ? 9 : 6;
      const Vector9d xi = Local(next.convention, next.anchors.back().origin, now);
      next.residual.noalias() -= next.jacobian.middleCols(LinearPrior::Column(i - 1), width) * xi.head(width);
    }
  }
  for (const WindowTrack* track : slam_.after) {
    next.landmarks.push_back({track->id, track->anchor, track->landmark});
  }
  return next;
}

}  // namespace

LinearPrior MarginalizeOldest(const Window& window, const LinearPrior& prior, const PoseSystem& vision,
                              const Eigen::Vector3d& gravity_W, const GnssFactorContext* gnss,
                              const SlamChange& slam) {
  OldestStack stack(window, prior, slam, gnss, vision.calibration);
  stack.AddPrior();
  stack.AddImu(gravity_W);
  stack.AddVision(vision);
  stack.AddRest();
  stack.AddGnss();
  stack.AddLandmarkViews();
  return stack.Eliminate();
}

void KeepFirstEstimates(const LinearPrior& prior, Window* window) {
  for (size_t i = 0; i < prior.anchors.size(); ++i) {
    const LinearPrior::Anchor& anchor = prior.anchors[i];
    window->frame(anchor.frame->index).first = FirstEstimate{prior.convention, anchor.origin, i == 0};
  }
}

}  // namespace alidade
