#include <algorithm>

#include "smoother/factors/slam_prior.h"

// The coordinates of a SlamPrior's linear part: where a window is in them, and how they move with its frames.

namespace alidade {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd SlamPrior::Displacement(const WindowPoint& point, const Scene& scene) const {
  VectorXd xi(prior_columns_.size() - origins_.size());
  for (size_t i = 0; i < prior_->anchors.size(); ++i) {
    const ColumnMap::Range columns = prior_columns_.Frame(static_cast<int>(i));
    const Index width = std::min(columns.size, kNavColumns);
    xi.segment(columns.first, width) = scene.frames.xi[i].head(width);
  }
  xi.segment<kBiasColumns>(prior_columns_.Frame(0).first + kNavColumns) = prior_->BiasError(point.bias);
  if (prior_->clock_origin) {
    xi.segment<kClockColumns>(prior_columns_.Clock(0).first) = prior_->ClockError(*point.clock);
  }
  const ColumnMap::Range camera = prior_columns_.Calibration();
  xi.segment(camera.first, camera.size) = prior_->CalibrationError(point.camera);
  return xi;
}

Eigen::RowVectorXd SlamPrior::SpreadRow(const LinearPrior::SpreadChange& spread) const {
  Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(columns_.size());
  for (size_t i = 0; i < prior_->anchors.size(); ++i) {
    row.segment<kPoseColumns>(columns_.Frame(prior_->anchors[i].frame->index).first) =
        spread.slope.col(static_cast<Index>(i)).transpose();
  }
  return row;
}

/// Columns over the prior's frames, clock and calibration to columns of the reduced system.
MatrixXd SlamPrior::ChainFrames(const WindowPoint& point, const Scene& scene, const MatrixXd& columns) const {
  MatrixXd chained = MatrixXd::Zero(columns.rows(), columns_.size());
  const LinearPrior::FrameErrors& errors = scene.frames;
  VectorXd along = VectorXd::Zero(columns.rows());
  Eigen::MatrixX3d on_positions = Eigen::MatrixX3d::Zero(columns.rows(), 3);
  for (size_t i = 0; i < prior_->anchors.size(); ++i) {
    const ColumnMap::Range from = prior_columns_.Frame(static_cast<int>(i));
    const Index width = std::min(from.size, kNavColumns);
    auto own = chained.middleCols(columns_.Frame(prior_->anchors[i].frame->index).first, width);
    own.noalias() = columns.middleCols(from.first, width) * errors.chain[i].topLeftCorner(width, width);
    on_positions += own.middleCols<3>(3);
    along.noalias() += columns.middleCols(from.first, width) * errors.along[i].head(width);
  }
  if (prior_->spread > 0) {
    const Index first = columns_.Frame(prior_->anchors.front().frame->index).first;
    chained.middleCols<kPoseColumns>(first).noalias() += on_positions * errors.on_first;
    chained.noalias() += along * SpreadRow(scene.spread);
  }
  chained.middleCols<kBiasColumns>(columns_.Frame(0).first + kNavColumns) =
      columns.middleCols<kBiasColumns>(prior_columns_.Frame(0).first + kNavColumns);
  if (prior_->clock_origin) {
    chained.middleCols<kClockColumns>(columns_.Clock(0).first) =
        columns.middleCols<kClockColumns>(prior_columns_.Clock(0).first);
  }
  const WindowCalibration& camera = prior_->calibration_origin;
  chained.rightCols(camera.size()).noalias() =
      columns.middleCols(prior_columns_.Calibration().first, camera.size()) *
      LocalJacobian(camera.layout, camera.mean, point.camera);
  return chained;
}

}  // namespace alidade
