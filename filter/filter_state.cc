#include "filter/filter_state.h"

#include "core/check.h"
#include "core/visual_observation.h"

namespace alidade {

FilterState::FilterState(ErrorConvention convention, const Pose& T_BC, int max_clones)
    : convention_(convention), T_BC_(T_BC), covariance_(SquareRootCovariance::kCore + 6 * max_clones) {
  clones_.reserve(static_cast<size_t>(max_clones));
  for (int slot = max_clones; slot-- > 0;) {
    free_slots_.push_back(slot);
  }
}

Status FilterState::Reset(const NavEstimate& initial) {
  ALIDADE_RETURN_IF_ERROR(CheckInitialState(initial));
  const Matrix15d to_error = InverseImuChartJacobian(convention_, initial.nav);
  const Matrix15d transformed = to_error * initial.covariance * to_error.transpose();
  ALIDADE_RETURN_IF_ERROR(covariance_.Reset(0.5 * (transformed + transformed.transpose())));
  nav_ = initial.nav;
  bias_ = initial.bias;
  stamp_ns_ = initial.stamp_ns;
  while (!clones_.empty()) {
    free_slots_.push_back(clones_.back().slot);
    clones_.pop_back();
  }
  if (observer_ != nullptr) {
    observer_->OnReset(*this);
  }
  return Status::Ok();
}

void FilterState::Propagate(std::span<const ImuSample> samples, const ImuNoise& noise,
                            const Eigen::Vector3d& gravity_W) {
  const Matrix15d from_error = ImuChartJacobian(convention_, nav_);
  ImuTransition transition;
  PropagateImu(samples, bias_, noise, gravity_W, &nav_, &transition);
  const Matrix15d to_error = InverseImuChartJacobian(convention_, nav_);
  const Matrix15d phi = to_error * transition.phi * from_error;
  const Matrix15d q = to_error * transition.q * to_error.transpose();
  covariance_.Propagate(phi, q);
  if (observer_ != nullptr) {
    observer_->OnPropagate(phi, q);
  }
  stamp_ns_ = samples.back().stamp_ns;
}

void FilterState::AddClone(int serial) {
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
  RefreshClone(&clone);
  clones_.push_back(clone);
}

void FilterState::RemoveClone(size_t index) {
  CHECK_LT(index, clones_.size());
  const int first = CloneOffset(index);
  covariance_.Remove(first, 6);
  if (observer_ != nullptr) {
    observer_->OnRemove(first, 6);
  }
  free_slots_.push_back(clones_[index].slot);
  clones_.erase(clones_.begin() + static_cast<std::ptrdiff_t>(index));
}

void FilterState::Correct(const Eigen::VectorXd& correction) {
  CHECK_EQ(correction.size(), covariance_.dimension());
  nav_ = Retract(convention_, nav_, Vector9d(correction.head<9>()));
  nav_.R_WB = Eigen::Quaterniond(nav_.R_WB).normalized().toRotationMatrix();
  bias_.gyro += correction.segment<3>(9);
  bias_.accel += correction.segment<3>(12);
  for (size_t i = 0; i < clones_.size(); ++i) {
    Clone& clone = clones_[i];
    clone.T_WB = Retract(convention_, clone.T_WB, Vector6d(correction.segment<6>(CloneOffset(i))));
    clone.T_WB.rotation = Eigen::Quaterniond(clone.T_WB.rotation).normalized().toRotationMatrix();
    RefreshClone(&clone);
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

NavEstimate FilterState::Estimate() const {
  const Matrix15d from_error = ImuChartJacobian(convention_, nav_);
  const Matrix15d covariance = from_error * covariance_.CoreCovariance() * from_error.transpose();
  return {stamp_ns_, nav_, bias_, 0.5 * (covariance + covariance.transpose())};
}

bool FilterState::AllFinite() const {
  return nav_.R_WB.allFinite() && nav_.p_WB.allFinite() && nav_.v_WB.allFinite() && bias_.gyro.allFinite() &&
         bias_.accel.allFinite() && covariance_.AllFinite();
}

void FilterState::RefreshClone(Clone* clone) const {
  clone->T_WC = clone->T_WB * T_BC_;
  clone->camera_from_error =
      BodyToCameraJacobian(clone->T_WB.rotation, T_BC_) * ChartJacobian(convention_, clone->T_WB);
}

}  // namespace alidade
