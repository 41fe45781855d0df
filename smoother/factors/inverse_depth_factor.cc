#include "smoother/factors/inverse_depth_factor.h"

#include <algorithm>

#include "core/predicted_observation.h"
#include "smoother/tracks/anchored_landmark.h"

namespace alidade {
namespace {

using Eigen::Vector2d;
using RowMatrix2x9 = Eigen::Matrix<double, 2, 9, Eigen::RowMajor>;
using RowMatrix2x3 = Eigen::Matrix<double, 2, 3, Eigen::RowMajor>;
using CalibrationRow = Eigen::Matrix<double, 2, CalibrationLayout::kMaxSize, Eigen::RowMajor>;

// Whitened residual of a landmark behind the camera: far beyond any gate, yet not so large that it hides the
// rest of the cost, to which the solver's tolerance is relative.
constexpr double kBehindSigma = 100;

void StoreNav(const Eigen::Matrix<double, 2, 6>& body, double* tangent) {
  if (tangent != nullptr) {
    Eigen::Map<RowMatrix2x9> out(tangent);
    out.leftCols<6>() = body;
    out.rightCols<3>().setZero();
  }
}

/// Rows over the layout's calibration to those over its block.
void StoreCalibration(const Eigen::Matrix2Xd& rows, const WindowCalibration& calibration, const double* block,
                      double* tangent) {
  Eigen::Map<CalibrationRow> out(tangent);
  out.setZero();
  out.leftCols(rows.cols()).noalias() = rows * calibration.BlockJacobian(block);
}

}  // namespace

InverseDepthFactor::InverseDepthFactor(const WindowFrame* base, const WindowView* view,
                                       const WindowCalibration* calibration, const BearingPlane& plane,
                                       double base_row_px, GeometryCache* cache)
    : base_(base),
      view_(view),
      calibration_(calibration),
      plane_(plane),
      base_row_px_(base_row_px),
      cache_(cache) {
  if (cache == nullptr) {
    const int frames = 1 + std::max(base->index, view->frame->index);
    own_ = std::make_shared<GeometryCache>(*calibration, static_cast<size_t>(frames));
    cache_ = own_.get();
  }
}

bool InverseDepthFactor::Evaluate(const double* const* parameters, double* residual,
                                  double* const* tangent_jacobians) const {
  const WindowCalibration* const camera = cache_->Camera(parameters[3]);
  if (camera == nullptr) {
    return false;
  }
  const NormalizedObservation observation = Renormalized(*camera, *view_).observation;
  const FrameGeometry& base_frame = cache_->Frame(*base_, parameters[0]);
  const FrameGeometry& view_frame = cache_->Frame(*view_->frame, parameters[1]);
  FrameGeometry base_row;
  FrameGeometry view_row;
  const FrameGeometry& base = AtRow(base_frame, base_row_px_, &base_row);
  const FrameGeometry& view = AtRow(view_frame, observation.row_px, &view_row);
  const Eigen::Map<const Eigen::Vector3d> landmark(parameters[2]);
  AnchoredRows rows;
  const bool in_front = LinearizeAnchoredView(base, view, observation, {}, landmark, &rows,
                                              tangent_jacobians != nullptr, *camera, plane_);
  if (!in_front) {
    rows.residual.setConstant(kBehindSigma);
    rows.anchor.setZero();
    rows.view.setZero();
    rows.landmark.setZero();
    rows.calibration.setZero(2, camera->size());
  }
  Eigen::Map<Vector2d>{residual} = rows.residual;
  if (tangent_jacobians == nullptr) {
    return true;
  }
  StoreNav(rows.anchor, tangent_jacobians[0]);
  StoreNav(rows.view, tangent_jacobians[1]);
  if (tangent_jacobians[2] != nullptr) {
    Eigen::Map<RowMatrix2x3>{tangent_jacobians[2]} = rows.landmark;
  }
  if (tangent_jacobians[3] != nullptr) {
    StoreCalibration(rows.calibration, *calibration_, parameters[3], tangent_jacobians[3]);
  }
  return true;
}

BaseBearingFactor::BaseBearingFactor(const WindowView* view, const WindowCalibration* calibration)
    : view_(view), calibration_(calibration) {}

bool BaseBearingFactor::Evaluate(const double* const* parameters, double* residual,
                                 double* const* tangent_jacobians) const {
  const Eigen::Map<const Eigen::Vector3d> landmark(parameters[0]);
  WindowCalibration camera = *calibration_;
  if (!calibration_->At(parameters[1], &camera.mean)) {
    return false;
  }
  const NormalizedObservation observation = Renormalized(camera, *view_).observation;
  Eigen::Map<Vector2d> r(residual);
  r = observation.sqrt_information * (landmark.head<2>() - observation.z);
  if (tangent_jacobians != nullptr && tangent_jacobians[0] != nullptr) {
    Eigen::Map<RowMatrix2x3> out(tangent_jacobians[0]);
    out.leftCols<2>() = observation.sqrt_information;
    out.col(2).setZero();
  }
  if (tangent_jacobians != nullptr && tangent_jacobians[1] != nullptr) {
    Eigen::Matrix2Xd rows(2, camera.size());
    CalibrationRows(camera.layout, camera.mean.camera, Eigen::Matrix3d::Identity(), {},
                    Eigen::Matrix<double, 2, 6>::Zero(), Predicted(observation, r), rows);
    StoreCalibration(rows, *calibration_, parameters[1], tangent_jacobians[1]);
  }
  return true;
}

bool DepthPriorFactor::Evaluate(const double* const* parameters, double* residual,
                                double* const* tangent_jacobians) const {
  residual[0] = prior_.sqrt_information * (parameters[0][2] - prior_.mean);
  if (tangent_jacobians != nullptr && tangent_jacobians[0] != nullptr) {
    Eigen::Map<Eigen::RowVector3d>{tangent_jacobians[0]} << 0, 0, prior_.sqrt_information;
  }
  return true;
}

}  // namespace alidade
