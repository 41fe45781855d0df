#include "smoother/solve/carried_terms.h"

#include <cmath>
#include <utility>

#include "core/check.h"
#include "smoother/factors/slam_prior.h"
#include "smoother/solve/marginal_stack.h"
#include "smoother/tracks/anchored_landmark.h"

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

}  // namespace

/// Rows in the making.
struct CarriedPrior::Rows {
  Rows(Index rows, Index columns) : count(rows), jacobian(MatrixXd::Zero(rows + rows % 2, columns)) {}

  [[nodiscard]] Eigen::Block<MatrixXd> Columns(const ColumnMap::Range& range) {
    return jacobian.block(0, range.first, count, range.size);
  }

  Index count;
  LinearPrior::SpreadChange spread;
  VectorXd along_scale;  ///< what changes per relative change of the spread, landmarks held fixed
  /// An even number of rows: all columns are aligned alike, so that products are rounded alike in each.
  MatrixXd jacobian;
  VectorXd residual;
};

CarriedPrior::CarriedPrior(const LinearPrior& prior, const StateChart& next, const Window& window,
                           const WindowCalibration& calibration, std::vector<PriorLandmark> landmarks,
                           const std::vector<FrameGeometry>& geometry)
    : prior_(prior),
      next_(next),
      window_(window),
      calibration_(calibration),
      landmarks_(std::move(landmarks)),
      geometry_(geometry),
      prior_columns_(prior.columns()) {
  CHECK(landmarks_.size() == prior.landmarks.size());
  CHECK(calibration.size() == prior.calibration_origin.size());
  for (int i = 0; i < window.size(); ++i) {  // a landmark may be anchored in any frame
    AddPart({Unknown::Kind::kFrame, i}, i == 0 ? kStateColumns : kPoseColumns);
  }
  AddPart({Unknown::Kind::kClock, 0}, prior.clock_origin ? kClockColumns : 0);
  AddPart({Unknown::Kind::kCalibration, 0}, calibration.size());
  for (const PriorLandmark& landmark : landmarks_) {
    AddPart({Unknown::Kind::kLandmark, landmark.number}, kLandmarkColumns);
  }
  for (const TermPart& part : parts()) {
    columns_.Add(part.of, part.width);
  }
}

Status CarriedPrior::Linearize(LinearTerm* linear) const {
  Rows rows(prior_.jacobian.rows(), columns_.size());
  rows.residual = prior_.residual;
  rows.spread = prior_.SpreadAt(PointOf(window_, calibration_.mean).states);
  rows.along_scale.setZero(rows.count);
  AddFrames(&rows);
  AddClockAndCalibration(&rows);
  for (size_t i = 0; i < landmarks_.size(); ++i) {
    AddLandmark(i, &rows);
  }
  AddSpread(&rows);
  linear->ResizeRows(parts(), rows.count);
  linear->chart = LinearTerm::Chart::kPrior;
  linear->jacobian = rows.jacobian.topRows(rows.count);
  linear->residual = rows.residual;
  return Status::Ok();
}

void CarriedPrior::AddFrames(Rows* rows) const {
  const Eigen::Matrix3d turn = prior_.chart.TurnOfCentre(next_);
  const LinearPrior::FrameErrors errors = prior_.ErrorsAt(PointOf(window_, calibration_.mean).states,
                                                          rows->spread, LinearPrior::Derivative::kAsMade);
  Eigen::MatrixX3d on_positions = Eigen::MatrixX3d::Zero(rows->count, 3);
  for (size_t i = 0; i < prior_.anchors.size(); ++i) {
    const WindowFrame& frame = *prior_.anchors[i].frame;
    const ColumnMap::Range from = prior_columns_.Frame(static_cast<int>(i));
    const MatrixXd::ConstColsBlockXpr columns = prior_.jacobian.middleCols(from.first, from.size);
    Vector15d xi;
    xi << errors.xi[i], prior_.BiasError(frame.imu_bias());
    rows->residual.noalias() += columns * xi.head(from.size);
    Eigen::Block<MatrixXd> moved = rows->Columns({columns_.Frame(frame.index).first, from.size});
    moved = columns;
    if (prior_.spread > 0 && !frame.first) {
      const Index width = std::min(from.size, kNavColumns);
      const MatrixXd own = columns.leftCols(width) * errors.chain[i].topLeftCorner(width, width);
      moved.leftCols(width).noalias() = own * next_.Jacobian(frame.nav_state()).topLeftCorner(width, width);
      on_positions += own.middleCols<3>(3);
      rows->along_scale.noalias() += columns.leftCols(width) * errors.along[i].head(width);
    } else {
      moved.leftCols<3>().noalias() += columns.middleCols<3>(3) * turn;
    }
  }
  const WindowFrame& first = *prior_.anchors.front().frame;
  rows->Columns({columns_.Frame(first.index).first, kPoseColumns}).noalias() +=
      on_positions * errors.on_first * next_.Jacobian(first.nav_state()).topLeftCorner<6, 6>();
}

void CarriedPrior::AddClockAndCalibration(Rows* rows) const {
  if (prior_.clock_origin) {
    const ColumnMap::Range from = prior_columns_.Clock(0);
    const MatrixXd jacobian = prior_.jacobian.middleCols(from.first, from.size);
    rows->Columns(columns_.Clock(0)) = jacobian;
    rows->residual.noalias() += jacobian * prior_.ClockError(window_.frame(0).clock_state());
  }
  const ColumnMap::Range from = prior_columns_.Calibration();
  const MatrixXd jacobian = prior_.jacobian.middleCols(from.first, from.size);
  rows->Columns(columns_.Calibration()) = jacobian;
  rows->residual.noalias() += jacobian * prior_.CalibrationError(calibration_.mean);
}

void CarriedPrior::AddLandmark(size_t landmark, Rows* rows) const {
  const LinearPrior::Landmark& known = prior_.landmarks[landmark];
  const WindowTrack* track = landmarks_[landmark].track;
  // Over the landmark itself: its inverse depth times the ratio of the spread is what the prior has.
  MatrixXd columns =
      prior_.jacobian.middleCols<kLandmarkColumns>(prior_columns_.Landmark(static_cast<int>(landmark)).first);
  columns.col(2) *= rows->spread.ratio;
  Eigen::Vector3d origin = known.origin;
  origin.z() /= rows->spread.ratio;
  Eigen::Block<MatrixXd> own = rows->Columns(columns_.Landmark(landmarks_[landmark].number));
  const auto at = [&](const Eigen::Vector3d& in_known_anchor) {
    rows->along_scale.noalias() += in_known_anchor.z() * columns.col(2);
    rows->residual.noalias() += columns * (in_known_anchor - origin);
  };
  if (track == nullptr || track->anchor == known.anchor) {
    own = columns;
    at(track == nullptr ? origin : track->landmark);
    return;
  }
  // The track has changed its anchor: the old coordinates as a function of the new ones and both frames.
  const WindowFrame& from = *known.anchor;
  const WindowFrame& to = *track->anchor;
  const FrameGeometry& from_geometry = geometry_[static_cast<size_t>(from.index)];
  const FrameGeometry& to_geometry = geometry_[static_cast<size_t>(to.index)];
  AnchorChange back;
  CHECK(ChangeAnchor(to_geometry, from_geometry, track->landmark, &back, {}, {track->plane(), known.plane}));
  AnchorChange change;
  CHECK(ChangeAnchor(from_geometry, to_geometry, back.to, &change, calibration_.layout,
                     {known.plane, track->plane()}));
  const auto pose = [&](const WindowFrame& frame) -> Eigen::Block<MatrixXd> {
    return rows->Columns({columns_.Frame(frame.index).first, kPoseColumns});
  };
  own.noalias() = columns * change.landmark;
  pose(from).noalias() += columns * (change.from_frame * PosePriorChart(next_, from));
  pose(to).noalias() += columns * (change.to_frame * PosePriorChart(next_, to));
  rows->Columns(columns_.Calibration()).noalias() += columns * change.calibration;
  at(back.to);
}

void CarriedPrior::AddSpread(Rows* rows) const {
  const Eigen::Matrix<double, 6, Eigen::Dynamic> slope = SpreadPriorSlope(prior_, rows->spread, next_);
  for (size_t i = 0; i < prior_.anchors.size(); ++i) {
    rows->Columns({columns_.Frame(prior_.anchors[i].frame->index).first, kPoseColumns}).noalias() +=
        rows->along_scale * slope.col(static_cast<Index>(i)).transpose();
  }
}

AnchoredViewTerm::AnchoredViewTerm(const std::vector<FrameGeometry>& geometry,
                                   const WindowCalibration& calibration, const ObservationKernel& kernel,
                                   const WindowTrack& track, const WindowView& view, int landmark)
    : geometry_(geometry),
      calibration_(calibration),
      kernel_(kernel),
      track_(track),
      view_(view),
      by_anchor_(track.anchor == view.frame) {
  if (!by_anchor_) {  // seen from its own anchor a landmark concerns no pose
    AddPart({Unknown::Kind::kFrame, track.anchor->index}, kPoseColumns);
    AddPart({Unknown::Kind::kFrame, view.frame->index}, kPoseColumns);
  }
  AddPart({Unknown::Kind::kLandmark, landmark}, kLandmarkColumns);
  AddPart({Unknown::Kind::kCalibration, 0}, calibration.size());
}

Status AnchoredViewTerm::Linearize(LinearTerm* linear) const {
  AnchoredRows rows;
  if (!LinearizeAnchoredView(track_, view_, geometry_, kernel_, track_.landmark, &rows, true, calibration_)) {
    linear->ResizeRows(parts(), 0);
    return Status::Ok();
  }
  linear->ResizeRows(parts(), 2);
  const double root = std::sqrt(rows.weight);
  const Index landmark = by_anchor_ ? 0 : 2 * kPoseColumns;
  if (!by_anchor_) {
    linear->jacobian.leftCols<kPoseColumns>() = root * rows.anchor;
    linear->jacobian.middleCols<kPoseColumns>(kPoseColumns) = root * rows.view;
  }
  linear->jacobian.middleCols<kLandmarkColumns>(landmark) = root * rows.landmark;
  linear->jacobian.rightCols(calibration_.size()) = root * rows.calibration;
  linear->residual = root * rows.residual;
  return Status::Ok();
}

}  // namespace alidade
