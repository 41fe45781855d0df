#include "core/rest_detector.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/dense_solvers.h"
#include "core/gyro_rotation.h"
#include "core/imu_statistics.h"
#include "core/lever_arm.h"
#include "core/lie.h"
#include "core/turned_ray.h"
#include "core/visual_observation.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kMinCommonTracks = 12;
constexpr double kBiasDeviations = 3;
// Rest that contradicts the estimate must last for so many windows.
constexpr double kWindowsInDoubt = 4;
constexpr double kDoubtProbability = 0.999;
// Of the deviation of the velocity at rest: what no estimate can contradict.
constexpr double kLeastDeviation = 0.5;
constexpr int kVelocityDof = 3;

bool TurnMayBeBias(const Vector3d& mean_gyro_radps, const NavEstimate& estimate) {
  const Vector3d bias_std_radps = estimate.covariance.diagonal().segment<3>(9).cwiseSqrt();
  return ((mean_gyro_radps - estimate.bias.gyro).array().abs() <= kBiasDeviations * bias_std_radps.array())
      .all();
}

}  // namespace

RestDetector::RestDetector(const VisionConfig& vision, const InitConfig& init, const CameraModel& camera)
    : vision_(vision),
      init_(init),
      doubt_(kDoubtProbability, kVelocityDof),
      camera_(camera),
      image_center_(0.5 * camera.width_px(), 0.5 * camera.height_px()),
      image_radius_px_(0.5 * std::hypot(camera.width_px(), camera.height_px())) {}

void RestDetector::Clear() {
  frame_count_ = 0;
  imu_.clear();
  turned_ns_ = INT64_MIN;
  doubted_since_ns_ = INT64_MAX;
  anchored_ = false;
}

void RestDetector::AddImu(std::span<const ImuSample> samples) {
  for (const ImuSample& sample : samples) {
    if (imu_.empty() || imu_.back().stamp_ns < sample.stamp_ns) {
      imu_.push_back(sample);
    }
  }
  // Without frames for longer than any verdict looks back, those that are kept are of no use any more.
  const double held_s = imu_.empty() ? 0 : SecondsBetween(imu_.front().stamp_ns, imu_.back().stamp_ns);
  if (held_s > 2 * kWindowsInDoubt * vision_.rest_window_s) {
    const ImuSample newest = imu_.back();
    Clear();
    imu_.assign(1, newest);
  }
}

void RestDetector::Turn(const Vector3d& gyro_bias_radps) {
  for (size_t i = 1; i < imu_.size(); ++i) {
    if (imu_[i - 1].stamp_ns >= turned_ns_) {
      const double dt_s = SecondsBetween(imu_[i - 1].stamp_ns, imu_[i].stamp_ns);
      R_0B_ *= so3::Exp(TurnOverStep(imu_[i - 1].gyro, imu_[i].gyro, dt_s, gyro_bias_radps));
    }
  }
  turned_ns_ = imu_.empty() ? INT64_MIN : imu_.back().stamp_ns;
}

void RestDetector::Keep(const TrackFrame& frame) {
  if (frame_count_ == frames_.size()) {
    frames_.emplace_back();
  }
  frames_[frame_count_].frame = frame;
  frames_[frame_count_].R_0B = R_0B_;
  ++frame_count_;
  const TimeNs window_ns = SecondsToNs(vision_.rest_window_s);
  const TimeNs history_ns = SecondsToNs(kWindowsInDoubt * vision_.rest_window_s);
  while (frame_count_ > 2 && frames_[1].frame.stamp_ns <= frame.stamp_ns - history_ns) {
    std::rotate(frames_.begin(), frames_.begin() + 1, frames_.end());
    --frame_count_;
  }
  imu_.erase(imu_.begin(), std::find_if(imu_.begin(), imu_.end(), [&](const ImuSample& sample) {
               return sample.stamp_ns >= imu_.back().stamp_ns - window_ns;
             }));
}

const RestDetector::OrientedFrame* RestDetector::FrameBefore(double seconds) const {
  const OrientedFrame* found = nullptr;
  const TimeNs latest_ns = frames_[frame_count_ - 1].frame.stamp_ns - SecondsToNs(seconds);
  for (size_t i = 0; i < frame_count_ && frames_[i].frame.stamp_ns <= latest_ns; ++i) {
    found = &frames_[i];
  }
  return found;
}

double RestDetector::NormalizedSpeedSquared(const NavEstimate& estimate, const Vector3d& p_BC,
                                            double least_mps) const {
  const Vector3d v_WC = LeverArm{p_BC}.Velocity(estimate.nav, estimate.bias, imu_.back().gyro);
  Matrix3d variance = estimate.covariance.block<3, 3>(6, 6);
  variance.diagonal().array() += least_mps * least_mps;
  return v_WC.dot(SolveSymmetric(variance, v_WC));
}

bool RestDetector::TellsMotion(const NavEstimate& estimate, const Vector3d& p_BC) const {
  return !imu_.empty() && NormalizedSpeedSquared(estimate, p_BC, 0) > kVelocityDof;
}

bool RestDetector::ContradictsRest(const NavEstimate& estimate, const Vector3d& p_BC) const {
  const double least_mps = kLeastDeviation * vision_.rest_velocity_std_mps;
  return !doubt_.Accepts(NormalizedSpeedSquared(estimate, p_BC, least_mps), kVelocityDof);
}

bool RestDetector::DoubtHasLasted(TimeNs stamp_ns, const OrientedFrame* since) {
  doubted_since_ns_ = std::min(doubted_since_ns_, stamp_ns);
  return since != nullptr && since->frame.stamp_ns >= doubted_since_ns_;
}

RestVerdict RestDetector::AddFrame(const TrackFrame& frame, double pixel_noise_px,
                                   const NavEstimate& estimate, const Pose& T_BC) {
  Turn(estimate.bias.gyro);
  Keep(frame);
  const OrientedFrame* const before = FrameBefore(vision_.rest_window_s);
  const bool anchored = std::exchange(anchored_, false);
  const ImuStatistics imu = MeasureImu(imu_);
  if (before == nullptr || imu_.size() < 5 || imu.accel_std_mps2 > vision_.rest_max_accel_std_mps2) {
    return {};
  }
  const OrientedFrame* doubted = nullptr;
  if (ContradictsRest(estimate, T_BC.translation)) {
    doubted = FrameBefore(kWindowsInDoubt * vision_.rest_window_s);
    if (!DoubtHasLasted(frame.stamp_ns, doubted)) {
      return {};
    }
  } else {
    doubted_since_ns_ = INT64_MAX;
  }
  // Under a constant force, as at a turning point, the camera passes the same place twice, with a calm IMU:
  // the ends of the window alone would not show it.
  const OrientedFrame* const end = frames_.data() + frame_count_;
  const OrientedFrame* const middle = before + (end - before) / 2;
  const StillSince since{before, middle + 1 == end ? nullptr : middle, doubted,
                         anchored ? &anchor_ : nullptr};
  RestVerdict flow;
  flow.speed_per_depth = std::numeric_limits<double>::infinity();
  RestVerdict verdict;
  const bool calm_gyro = imu.gyro_std_radps < init_.static_max_gyro_std_radps;
  if (calm_gyro && TurnMayBeBias(imu.mean_gyro, estimate)) {
    flow.no_translation = flow.no_rotation = StoodStill(frame, since, nullptr, pixel_noise_px, &flow);
    verdict = flow;
  } else {
    flow.no_translation = StoodStill(frame, since, &T_BC.rotation, pixel_noise_px, &flow);
    verdict = flow;
    flow.no_rotation =
        flow.no_translation && calm_gyro && StoodStill(frame, since, nullptr, pixel_noise_px, &flow);
    verdict = flow.no_rotation ? flow : verdict;
  }
  if (verdict.no_translation && !anchored_) {
    anchor_ = *before;
    anchored_ = true;
  }
  return verdict;
}

bool RestDetector::StoodStill(const TrackFrame& frame, const StillSince& since, const Matrix3d* R_BC,
                              double pixel_noise_px, RestVerdict* flow) {
  const auto is_zero = [&](const OrientedFrame& old, RestVerdict* of_pair) {
    Matrix3d R_now_before = Matrix3d::Identity();
    if (R_BC != nullptr) {
      R_now_before = R_BC->transpose() * R_0B_.transpose() * old.R_0B * *R_BC;
    }
    return FlowIsZero(old.frame, frame, R_now_before, pixel_noise_px, of_pair);
  };
  for (const OrientedFrame* old : {since.before, since.middle, since.doubted}) {
    if (old != nullptr && !is_zero(*old, flow)) {
      return false;
    }
  }
  RestVerdict whole;
  whole.speed_per_depth = flow->speed_per_depth;
  if (since.anchor != nullptr && is_zero(*since.anchor, &whole)) {
    flow->speed_per_depth = whole.speed_per_depth;
    anchored_ = true;
  }
  return true;
}

RestRates RestDetector::Rates() const {
  return {MeasureImu(imu_).mean_gyro, imu_.empty() ? Vector3d::Zero() : imu_.back().gyro};
}

void RestDetector::FindCommon(const TrackFrame& before, const TrackFrame& now, const Matrix3d& R_now_before) {
  common_.clear();
  auto old = before.observations.begin();
  for (const TrackObservation& seen : now.observations) {
    while (old != before.observations.end() && old->track_id < seen.track_id) {
      ++old;
    }
    if (old != before.observations.end() && old->track_id == seen.track_id) {
      Vector3d ray;
      Vector2d turned;
      if (PixelRay(camera_, old->pixel, &ray) && camera_.Project(TurnedRay(R_now_before, ray), &turned)) {
        common_.push_back({turned, seen.pixel - turned});
      }
    }
  }
}

bool RestDetector::FlowIsZero(const TrackFrame& before, const TrackFrame& now, const Matrix3d& R_now_before,
                              double pixel_noise_px, RestVerdict* verdict) {
  FindCommon(before, now, R_now_before);
  std::vector<CommonTrack>& common = common_;
  if (static_cast<int>(common.size()) < kMinCommonTracks || 2 * common.size() < now.observations.size()) {
    return false;  // too few to decide, or half of them new: the image changes
  }
  // Mismatches among many still tracks must not look like motion: keep the half with the smallest flow.
  const auto middle = common.begin() + static_cast<std::ptrdiff_t>(common.size() / 2);
  std::nth_element(common.begin(), middle, common.end(), [](const CommonTrack& a, const CommonTrack& b) {
    return a.flow.squaredNorm() < b.flow.squaredNorm();
  });
  const double median = middle->flow.norm();
  // The half with the smallest flow would hide a zoom (it lives near the centre), so its median is bounded
  // first.
  if (median > vision_.rest_max_flow_px + 2 * pixel_noise_px) {
    return false;
  }
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  const double outlier = 3 * median + vision_.rest_max_flow_px;
  for (const CommonTrack& track : common) {
    if (track.flow.norm() > outlier) {
      continue;
    }
    const Vector2d x = (track.before - image_center_) / image_radius_px_;
    Eigen::Matrix<double, 2, 4> design;  // shift, zoom, roll; the last two in pixels at the image's corner
    design << 1, 0, x.x(), -x.y(), 0, 1, x.y(), x.x();
    normal += design.transpose() * design;
    right += design.transpose() * track.flow;
  }
  const Eigen::Vector4d flow = SymmetricSolver(normal).Solve(right);
  if (!flow.allFinite() || flow.cwiseAbs().maxCoeff() >= vision_.rest_max_flow_px) {
    return false;
  }
  // The difference of two observations has twice the variance of one.
  const Eigen::Array4d deviation =
      std::sqrt(2.0) * pixel_noise_px * normal.inverse().diagonal().array().sqrt();
  verdict->flow_deviations = std::max(verdict->flow_deviations, (flow.array().abs() / deviation).maxCoeff());
  // Shift and zoom come from a translation, roll does not. At the image's corner the ray is about as long as
  // the focal length is. A frame later most of the pair's time is measured again.
  const double translation_px = (flow.array().abs() + deviation).head<3>().maxCoeff();
  const double span_s = SecondsBetween(before.stamp_ns, now.stamp_ns);
  const double new_s = SecondsBetween(frames_[frame_count_ - 2].frame.stamp_ns, now.stamp_ns);
  verdict->speed_per_depth = std::min(verdict->speed_per_depth,
                                      translation_px / (camera_.mean_focal_px() * std::sqrt(span_s * new_s)));
  return true;
}

}  // namespace alidade
