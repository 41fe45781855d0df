#include "frontend/initialization/start_problem.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "core/imu_propagation.h"
#include "core/landmark_reduction.h"
#include "core/reprojection.h"
#include "core/robust.h"
#include "frontend/initialization/dynamic_window.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Cost of an observation whose landmark lies behind its view: far outside the kernel. LandmarkCost
// (core/landmark_solver.h) is infinite there, and one such view would refuse every step of the whole window.
constexpr double kBehindSquared = 400.0;
constexpr double kMinDepthM = 1e-3;

}  // namespace

StartProblem::StartProblem(const DynamicWindow& window, const std::vector<bool>& inlier,
                           const std::vector<Preintegration>& preintegrations,
                           const std::vector<NavState>& states, const ImuBias& bias,
                           const RefinementSettings& settings)
    : tracks_(window.tracks),
      preintegrations_(preintegrations),
      settings_(settings),
      gravity_W_(GravityInWorld(settings.gravity_mps2)),
      active_(inlier) {
  current_.states = states;
  current_.biases.assign(states.size(), bias);
  current_.landmarks.assign(window.tracks.size(), Vector3d::Zero());
  for (const Preintegration& step : preintegrations) {
    Matrix15d whitening;
    valid_ = step.Whitening(&whitening) && valid_;
    sqrt_information_.push_back(whitening);
  }
  InitializeLandmarks();
}

std::vector<Pose> StartProblem::Cameras(const Variables& variables, const SharedTrack& track) const {
  std::vector<Pose> cameras;
  cameras.reserve(track.frames.size());
  for (const int frame : track.frames) {
    cameras.push_back(variables.states[static_cast<size_t>(frame)].T_WB() * settings_.T_BC);
  }
  return cameras;
}

bool StartProblem::TrackResiduals(const Variables& variables, size_t t, std::vector<double>* squared) const {
  const SharedTrack& track = tracks_[t];
  const std::vector<Pose> cameras = Cameras(variables, track);
  squared->clear();
  bool in_front = true;
  for (size_t k = 0; k < cameras.size(); ++k) {
    const PointInCamera seen(cameras[k], variables.landmarks[t]);
    Eigen::Vector2d predicted;
    const NormalizedObservation& observation = track.observations[k];
    if (ProjectToPlane(observation.plane, seen.q, kMinDepthM, &predicted)) {
      squared->push_back((observation.sqrt_information * (predicted - observation.z)).squaredNorm());
    } else {
      squared->push_back(kBehindSquared);
      in_front = false;
    }
  }
  return in_front;
}

double StartProblem::TrackCost(const Variables& variables, size_t t) const {
  std::vector<double> squared;
  TrackResiduals(variables, t, &squared);
  double cost = 0;
  for (const double value : squared) {
    cost += RobustCost(RobustKernel::kCauchy, kCauchyScale, value);
  }
  return cost;
}

double StartProblem::InertialCost(const Variables& variables) const {
  double cost = 0;
  for (size_t k = 0; k < preintegrations_.size(); ++k) {
    Vector15d residual;
    PreintegrationModel{&preintegrations_[k], gravity_W_}.Evaluate(
        variables.states[k], variables.biases[k], variables.states[k + 1], variables.biases[k + 1], &residual,
        nullptr, nullptr);
    cost += (sqrt_information_[k] * residual).squaredNorm();
  }
  return cost;
}

double StartProblem::PriorCost(const Variables& variables) const {
  const double gyro = variables.biases.front().gyro.norm() / settings_.gyro_bias_std_radps;
  const double accel = variables.biases.front().accel.norm() / settings_.accel_bias_std_mps2;
  return gyro * gyro + accel * accel;
}

void StartProblem::AddTrack(size_t t) {
  const SharedTrack& track = tracks_[t];
  landmark_rows_[t] = LandmarkRows();
  std::vector<double> squared;
  if (!TrackResiduals(current_, t, &squared)) {
    return;
  }
  std::vector<NormalizedObservation> weighted = track.observations;
  for (size_t k = 0; k < weighted.size(); ++k) {
    weighted[k].sqrt_information *= std::sqrt(RobustWeight(RobustKernel::kCauchy, kCauchyScale, squared[k]));
  }
  TrackLinearization rows;
  if (!LinearizeTrack(Cameras(current_, track), weighted, current_.landmarks[t], &rows)) {
    return;
  }
  // J^T (I - Q Q^T) J with J block diagonal and Q a base of the landmark's columns: a landmark eliminated at
  // a cost quadratic in its views. EliminateLandmark leaves a dense J, whose J^T J costs the cube.
  const Eigen::Index views = static_cast<Eigen::Index>(track.frames.size());
  const Eigen::HouseholderQR<Eigen::Matrix<double, Eigen::Dynamic, 3>> factor(rows.point_jacobian);
  Eigen::Matrix<double, Eigen::Dynamic, 3> base =
      Eigen::Matrix<double, Eigen::Dynamic, 3>::Identity(2 * views, 3);
  base.applyOnTheLeft(factor.householderQ());
  Eigen::Matrix<double, 3, Eigen::Dynamic>& of_landmark = landmark_rows_[t].jacobian;
  of_landmark.resize(3, 6 * views);
  landmark_rows_[t].R = factor.matrixQR().topRows<3>().triangularView<Eigen::Upper>();
  landmark_rows_[t].rhs = base.transpose() * rows.residual;
  const Eigen::VectorXd residual = rows.residual - base * landmark_rows_[t].rhs;
  for (Eigen::Index k = 0; k < views; ++k) {
    const Eigen::Index at = 15 * track.frames[static_cast<size_t>(k)];
    const NavState& state = current_.states[static_cast<size_t>(track.frames[static_cast<size_t>(k)])];
    const Eigen::Matrix<double, 2, 6> jacobian =
        rows.pose_jacobians.middleRows<2>(2 * k) * BodyToCameraJacobian(state.R_WB, settings_.T_BC);
    gradient_.segment<6>(at) += jacobian.transpose() * residual.segment<2>(2 * k);
    information_.block<6, 6>(at, at) += jacobian.transpose() * jacobian;
    of_landmark.middleCols<6>(6 * k) = base.middleRows<2>(2 * k).transpose() * jacobian;
  }
  for (Eigen::Index i = 0; i < views; ++i) {
    const Eigen::Index row = 15 * track.frames[static_cast<size_t>(i)];
    for (Eigen::Index j = 0; j <= i; ++j) {
      information_.block<6, 6>(row, 15 * track.frames[static_cast<size_t>(j)]).noalias() -=
          of_landmark.middleCols<6>(6 * i).transpose().lazyProduct(of_landmark.middleCols<6>(6 * j));
    }
  }
}

Eigen::Matrix<double, 15, 30> StartProblem::InertialJacobian(size_t k, Vector15d* residual) const {
  Matrix15d jacobian_i;
  Matrix15d jacobian_j;
  PreintegrationModel{&preintegrations_[k], gravity_W_}.Evaluate(
      current_.states[k], current_.biases[k], current_.states[k + 1], current_.biases[k + 1], residual,
      &jacobian_i, &jacobian_j);
  *residual = (sqrt_information_[k] * *residual).eval();
  Eigen::Matrix<double, 15, 30> jacobian;
  jacobian << sqrt_information_[k] * jacobian_i, sqrt_information_[k] * jacobian_j;
  return jacobian;
}

void StartProblem::AddInertial() {
  for (size_t k = 0; k < preintegrations_.size(); ++k) {
    Vector15d residual;
    const Eigen::Matrix<double, 15, 30> jacobian = InertialJacobian(k, &residual);
    const Eigen::Index at = 15 * static_cast<Eigen::Index>(k);
    information_.block<30, 30>(at, at) += jacobian.transpose() * jacobian;
    gradient_.segment<30>(at) += jacobian.transpose() * residual;
  }
}

void StartProblem::AddPriors() {
  const double gyro = 1 / (settings_.gyro_bias_std_radps * settings_.gyro_bias_std_radps);
  const double accel = 1 / (settings_.accel_bias_std_mps2 * settings_.accel_bias_std_mps2);
  information_.diagonal().segment<3>(9).array() += gyro;
  information_.diagonal().segment<3>(12).array() += accel;
  gradient_.segment<3>(9) += gyro * current_.biases.front().gyro;
  gradient_.segment<3>(12) += accel * current_.biases.front().accel;
  // Yaw about the world's z in the newest body, and its position: a choice of frame, so they carry no
  // residual.
  gauge_.setZero(15, 15);
  const Vector3d up = current_.states.back().R_WB.transpose().col(2);
  gauge_.topLeftCorner<3, 3>() = up * up.transpose() / (settings_.yaw_std_rad * settings_.yaw_std_rad);
  gauge_.diagonal().segment<3>(3).setConstant(1 / (settings_.position_std_m * settings_.position_std_m));
}

double StartProblem::Linearize() {
  const Eigen::Index size = 15 * static_cast<Eigen::Index>(current_.states.size());
  information_.setZero(size, size);
  gradient_.setZero(size);
  landmark_rows_.resize(tracks_.size());
  double cost = InertialCost(current_) + PriorCost(current_);
  for (size_t t = 0; t < active_.size(); ++t) {
    if (active_[t]) {
      AddTrack(t);
      cost += TrackCost(current_, t);
    }
  }
  AddInertial();
  AddPriors();
  return cost;
}

int StartProblem::DropAbove(double squared_residual) {
  int dropped = 0;
  std::vector<double> squared;
  for (size_t t = 0; t < active_.size(); ++t) {
    if (!active_[t]) {
      continue;
    }
    const SharedTrack& track = tracks_[t];
    const bool in_front = TrackResiduals(current_, t, &squared);
    SharedTrack kept{track.track_id, {}, {}};
    for (size_t k = 0; k < squared.size(); ++k) {
      if (squared[k] <= squared_residual) {
        kept.frames.push_back(track.frames[k]);
        kept.observations.push_back(track.observations[k]);
      }
    }
    dropped += static_cast<int>(track.frames.size() - kept.frames.size());
    if (!in_front || kept.frames.size() < 2 || 2 * kept.frames.size() < track.frames.size()) {
      active_[t] = false;
    } else if (kept.frames.size() < track.frames.size()) {
      tracks_[t] = std::move(kept);
    }
  }
  return dropped;
}

int StartProblem::active_tracks() const {
  return static_cast<int>(std::count(active_.begin(), active_.end(), true));
}

}  // namespace alidade
