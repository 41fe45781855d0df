#include "filter/filter_state.h"

#include <utility>

#include "core/check.h"
#include "core/format.h"
#include "core/visual_observation.h"

namespace alidade {

using Eigen::Matrix3d;

namespace {

// Of a start from the origin of W. The right-invariant error has the attitude's deviation times that distance
// in its position; at 500 km double precision does not hold the rest.
constexpr double kFarthestStart_m = 2e5;

}  // namespace

FilterState::FilterState(ErrorConvention convention, bool first_estimates, const Pose& T_BC, Limits limits)
    : FilterState(convention, first_estimates, CalibrationEstimate{{}, {{}, T_BC, 0}, {}}, limits) {}

FilterState::FilterState(ErrorConvention convention, bool first_estimates, CalibrationEstimate calibration,
                         Limits limits)
    : convention_(convention),
      first_estimates_(first_estimates),
      given_(std::move(calibration)),
      calibration_(given_.mean),
      calibration_error_(given_.error),
      covariance_(SquareRootCovariance::kCore + 6 * limits.clones + 3 * limits.landmarks +
                      (limits.clock ? kClockSize : 0) + given_.layout.size(),
                  3 * limits.landmarks + (limits.clock ? kClockSize : 0), limits.precision),
      strain_(limits.imu_strain ? limits.clones : 0) {
  clones_.reserve(static_cast<size_t>(limits.clones));
  landmarks_.reserve(static_cast<size_t>(limits.landmarks));
  for (int slot = limits.clones; slot-- > 0;) {
    free_slots_.push_back(slot);
  }
}

Status FilterState::Reset(const NavEstimate& initial) {
  ALIDADE_RETURN_IF_ERROR(CheckInitialState(initial));
  const double distance_m = initial.nav.p_WB.norm();
  if (TurnsAboutOrigin(convention_) && distance_m > kFarthestStart_m) {
    return Status::Input(
        Format("initial position: found %.0f km from the origin of the world frame, expected "
               "at most %.0f km with filter.error: right_invariant; shift the truth",
               1e-3 * distance_m, 1e-3 * kFarthestStart_m));
  }
  const Matrix15d to_error = InverseImuChartJacobian(convention_, initial.nav);
  const Matrix15d transformed = to_error * initial.covariance * to_error.transpose();
  ALIDADE_RETURN_IF_ERROR(covariance_.Reset(0.5 * (transformed + transformed.transpose())));
  covariance_.AddTrailing(given_.deviations);
  calibration_ = given_.mean;
  calibration_error_ = given_.error;
  calibration_is_sound_ = true;
  nav_ = initial.nav;
  nav_first_ = nav_;
  bias_ = initial.bias;
  stamp_ns_ = initial.stamp_ns;
  while (!clones_.empty()) {
    free_slots_.push_back(clones_.back().slot);
    clones_.pop_back();
  }
  landmarks_.clear();
  strain_.Reset();
  if (observer_ != nullptr) {
    observer_->OnReset(*this);
  }
  return Status::Ok();
}

Status FilterState::Propagate(std::span<const ImuSample> samples, const ImuNoise& noise,
                              const Eigen::Vector3d& gravity_W) {
  CHECK_GE(samples.size(), 2u);
  if (observer_ != nullptr) {
    observer_->OnImu(*this, samples);
  }
  Matrix15d from_error = ImuChartJacobian(convention_, nav_);
  if (first_estimates_) {
    // The right-invariant transition does not depend on the state; only the charts at its ends do.
    constexpr ErrorConvention kInvariant = ErrorConvention::kRightInvariant;
    from_error = ImuChartJacobian(kInvariant, nav_) * InverseImuChartJacobian(kInvariant, nav_first_) *
                 ImuChartJacobian(convention_, nav_first_);
  }
  Preintegration preintegration(bias_, noise);
  preintegration.Add(samples);
  ImuTransition transition;
  ALIDADE_RETURN_IF_ERROR(PropagateState(preintegration, gravity_W, &nav_, &transition));
  const Matrix15d to_error = InverseImuChartJacobian(convention_, nav_);
  const Matrix15d phi = to_error * transition.phi * from_error;
  const Matrix15d noise_root = to_error * transition.noise_root;
  covariance_.Propagate(phi, noise_root);
  strain_.Propagate(preintegration);
  if (observer_ != nullptr) {
    observer_->OnPropagate(phi, noise_root * noise_root.transpose());
  }
  stamp_ns_ = samples.back().stamp_ns;
  nav_first_ = nav_;
  return Status::Ok();
}

void FilterState::AddClone(int serial, const MeasuredTurn& turn) {
  // In every convention the error of a pose is the first six components of the navigation error.
  covariance_.CloneCore(0, 6);
  if (observer_ != nullptr) {
    observer_->OnClone(0, 6);
  }
  Clone clone;
  clone.serial = serial;
  CHECK(!free_slots_.empty());
  clone.slot = free_slots_.back();
  free_slots_.pop_back();
  clone.stamp_ns = stamp_ns_;
  clone.T_WB = nav_.T_WB();
  clone.T_WB_first = nav_first_.T_WB();
  clone.motion = MotionOf(turn, bias_.gyro, nav_.R_WB, nav_.v_WB);
  RefreshClone(&clone);
  clones_.push_back(clone);
  strain_.AddClone();
  if (layout().time_offset() >= 0) {
    const Vector6d rates = BodyRates(clone.motion.omega_B, nav_.v_WB);
    const Vector6d gain = InverseChartJacobian(convention_, clone.T_WB) * rates;
    covariance_.AddToRows(CloneOffset(clones_.size() - 1), gain,
                          CalibrationOffset() + layout().time_offset());
  }
}

void FilterState::RemoveClone(size_t index) {
  CHECK_LT(index, clones_.size());
  if (landmark_error().anchored()) {
    Reanchor(clones_[index].serial);
  }
  RemoveRows(CloneOffset(index), 6);
  free_slots_.push_back(clones_[index].slot);
  clones_.erase(clones_.begin() + static_cast<std::ptrdiff_t>(index));
  strain_.RemoveClone(index);
}

void FilterState::RemoveRows(int first, int size) {
  covariance_.Remove(first, size);
  if (observer_ != nullptr) {
    observer_->OnRemove(first, size);
  }
}

void FilterState::AddToLandmark(int landmark, const Eigen::Matrix3d& m, int source) {
  covariance_.AddToLeading(landmark, m, source);
  if (observer_ != nullptr) {
    observer_->OnAddToLandmark(landmark, m, source);
  }
}

void FilterState::Reanchor(int leaving_serial) {
  const int leaving = FindClone(leaving_serial);
  const size_t newest = clones_.size() - 1;
  for (size_t i = 0; i < landmarks_.size(); ++i) {
    Landmark& landmark = landmarks_[i];
    if (landmark.anchor_serial != leaving_serial) {
      continue;
    }
    CHECK_NE(static_cast<size_t>(leaving), newest) << "the last clone holds anchors";
    const Eigen::Matrix3d lever = LandmarkError::Lever(JacobianPoint(landmark));
    AddToLandmark(LandmarkOffset(i), lever, CloneOffset(newest));
    AddToLandmark(LandmarkOffset(i), -lever, CloneOffset(static_cast<size_t>(leaving)));
    landmark.anchor_serial = clones_[newest].serial;
  }
}

void FilterState::AddLandmark(const LandmarkRows& rows) {
  CHECK_LT(landmarks_.size(), landmarks_.capacity());
  CHECK_EQ(rows.T.cols(), covariance_.dimension() - covariance_.leading());
  Eigen::Matrix3d root = Eigen::Matrix3d::Identity();
  rows.R_f.triangularView<Eigen::Upper>().solveInPlace(root);
  // f~ = R_f^-1 (t - T x~ - n); the sign of n means nothing.
  gain_.noalias() = -root * rows.T;
  covariance_.AddLeading(root, gain_);
  landmarks_.push_back(rows.landmark);
  landmarks_.back().p_W += root * rows.t;
  if (observer_ != nullptr) {
    Eigen::MatrixXd defining = Eigen::MatrixXd::Zero(3, covariance_.dimension());
    defining.leftCols<3>() = rows.R_f;
    defining.rightCols(rows.T.cols()) = rows.T;
    observer_->OnAddLandmark(0, defining);
  }
}

void FilterState::RemoveLandmark(size_t index) {
  CHECK_LT(index, landmarks_.size());
  RemoveRows(LandmarkOffset(index), 3);
  landmarks_.erase(landmarks_.begin() + static_cast<std::ptrdiff_t>(index));
}

void FilterState::Shear(const Eigen::Ref<const Eigen::VectorXd>& column,
                        const Eigen::Ref<const Eigen::VectorXd>& row) {
  covariance_.Shear(column, row);
  if (observer_ != nullptr) {
    observer_->OnShear(column, row);
  }
}

int FilterState::FindClone(int serial) const {
  for (size_t i = clones_.size(); i-- > 0;) {
    if (clones_[i].serial == serial) {
      return static_cast<int>(i);
    }
  }
  return -1;
}

int FilterState::FindLandmark(std::int64_t id) const {
  for (size_t i = 0; i < landmarks_.size(); ++i) {
    if (landmarks_[i].id == id) {
      return static_cast<int>(i);
    }
  }
  return -1;
}

NavEstimate FilterState::Estimate() const {
  const Matrix15d from_error = ImuChartJacobian(convention_, nav_);
  const Matrix15d covariance = from_error * covariance_.CoreCovariance() * from_error.transpose();
  return {stamp_ns_, nav_, bias_, 0.5 * (covariance + covariance.transpose())};
}

CalibrationEstimate FilterState::EstimatedCalibration() const {
  CalibrationEstimate estimate{layout(), calibration_, {}, given_.watched, calibration_error_};
  const int size = layout().size();
  // The triangle's last rows are zero before their last columns.
  const auto rows = covariance_.factor().bottomRightCorner(size, size);
  estimate.deviations = rows.rowwise().norm();
  if (given_.watched) {
    const auto core = covariance_.factor().block(CoreOffset(), CalibrationOffset(), 15, size);
    estimate.state_covariance = ImuChartJacobian(convention_, nav_) * (core * rows.transpose());
  }
  return estimate;
}

Pose FilterState::CameraPoseAt(const Clone& clone, const NormalizedObservation& observation) const {
  if (!has_rolling_shutter()) {
    return clone.T_WC;
  }
  return clone.T_WC *
         CameraAfter(clone.motion, calibration_.T_BC, *calibration_.line_delay_s * observation.row_px);
}

ExposedCamera FilterState::CameraAt(const Clone& clone, const NormalizedObservation& observation) const {
  const Matrix3d& R_WB = (first_estimates_ ? clone.T_WB_first : clone.T_WB).rotation;
  const ExposedRow row =
      ExposeRow(clone.motion, calibration_.T_BC, R_WB, *calibration_.line_delay_s, observation.row_px);
  ExposedCamera exposed;
  exposed.T_WC = clone.T_WC * row.T_CR;
  exposed.T_WC_jacobian = clone.T_WC_jacobian * row.T_CR;
  exposed.camera_from_error = row.row_from_camera * clone.camera_from_error;
  exposed.R_WB = row.R_WB;
  exposed.camera_from_line_delay = row.row_from_line_delay;
  return exposed;
}

void FilterState::FillCalibrationRows(const Clone& clone, const ExposedCamera* exposed,
                                      const Eigen::Matrix<double, 2, 6>& camera_rows,
                                      const NormalizedObservation& observation,
                                      Eigen::Ref<Eigen::MatrixXd> rows) const {
  const Pose& T_WB = first_estimates_ ? clone.T_WB_first : clone.T_WB;
  CalibrationRows(given_.layout, calibration_.camera, exposed != nullptr ? exposed->R_WB : T_WB.rotation,
                  {nullptr, exposed != nullptr ? &exposed->camera_from_line_delay : nullptr}, camera_rows,
                  observation, rows);
}

bool FilterState::AllFinite() const {
  return calibration_is_sound_ && nav_.R_WB.allFinite() && nav_.p_WB.allFinite() && nav_.v_WB.allFinite() &&
         bias_.gyro.allFinite() && bias_.accel.allFinite() && covariance_.AllFinite();
}

void FilterState::RefreshClone(Clone* clone) const {
  const Pose& T_BC = calibration_.T_BC;
  clone->T_WC = clone->T_WB * T_BC;
  const Pose& T_WB = first_estimates_ ? clone->T_WB_first : clone->T_WB;
  clone->T_WC_jacobian = T_WB * T_BC;
  clone->camera_from_error = BodyToCameraJacobian(T_WB.rotation, T_BC) * ChartJacobian(convention_, T_WB);
}

}  // namespace alidade
