#include "smoother/truth/truth_start.h"

#include <algorithm>
#include <cmath>

#include "core/gyro_rotation.h"
#include "core/imu_buffer.h"
#include "core/median.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kTurnSeconds = 0.1;
constexpr double kMaxTurnSeconds = 0.2;
constexpr size_t kMaxTurns = 1500;
constexpr double kMaxOffsetSeconds = 0.3;
constexpr double kOffsetStepSeconds = 0.01;
// Turns whose angles differ by more than this many medians come from wrong poses.
constexpr double kOutlierMedians = 4;
// A rotation of the marker counts when it takes off this share of the median disagreement.
constexpr double kClearGain = 0.3;

/// The gyroscope as a rotation from the first sample on, with no bias taken off.
class GyroTurns {
 public:
  explicit GyroTurns(std::span<const ImuSample> imu) : imu_(imu), turns_(imu.size(), Matrix3d::Identity()) {
    for (size_t i = 1; i < imu.size(); ++i) {
      turns_[i] = turns_[i - 1] * TurnSince(i - 1, imu[i].stamp_ns);
    }
    for (Matrix3d& turn : turns_) {
      turn = so3::Normalize(turn);
    }
  }

  [[nodiscard]] bool Covers(TimeNs stamp_ns) const {
    return stamp_ns >= imu_.front().stamp_ns && stamp_ns <= imu_.back().stamp_ns;
  }
  [[nodiscard]] Matrix3d At(TimeNs stamp_ns) const {
    const size_t i = Before(stamp_ns);
    return turns_[i] * TurnSince(i, stamp_ns);
  }
  /// Index of the sample at or before the stamp, never the last one.
  [[nodiscard]] size_t Before(TimeNs stamp_ns) const {
    const auto later = [](TimeNs stamp, const ImuSample& sample) { return stamp < sample.stamp_ns; };
    const auto found = std::upper_bound(imu_.begin() + 1, imu_.end() - 1, stamp_ns, later);
    return static_cast<size_t>(found - imu_.begin()) - 1;
  }

 private:
  /// Since sample i, at the mean rate of the step that follows it.
  [[nodiscard]] Matrix3d TurnSince(size_t i, TimeNs stamp_ns) const {
    return so3::Exp(TurnOverStep(imu_[i].gyro, imu_[i + 1].gyro, SecondsBetween(imu_[i].stamp_ns, stamp_ns)));
  }

  std::span<const ImuSample> imu_;
  std::vector<Matrix3d> turns_;
};

/// The same turn by the truth, in the marker's frame, and the gyroscope, in that of the body.
struct Turn {
  Vector3d marker = Vector3d::Zero();
  Vector3d body = Vector3d::Zero();
  double duration_s = 0;
};

/// How turns agree under a rotation of the marker: body = R_BM marker + bias * duration.
struct Agreement {
  double median_rad = INFINITY;
  Matrix3d R_BM = Matrix3d::Identity();
  Vector3d gyro_bias = Vector3d::Zero();
};

Agreement Agree(const std::vector<Turn>& turns, const std::vector<bool>& used, const Matrix3d& R_BM) {
  Agreement agreement{0, R_BM, Vector3d::Zero()};
  double duration_s = 0;
  for (size_t i = 0; i < turns.size(); ++i) {
    if (used[i]) {
      agreement.gyro_bias += turns[i].body - R_BM * turns[i].marker;
      duration_s += turns[i].duration_s;
    }
  }
  agreement.gyro_bias /= duration_s;
  std::vector<double> errors;
  errors.reserve(turns.size());
  for (const Turn& turn : turns) {
    errors.push_back((turn.body - R_BM * turn.marker - agreement.gyro_bias * turn.duration_s).norm());
  }
  agreement.median_rad = Median(std::move(errors));
  return agreement;
}

Agreement BestAgreement(const std::vector<Turn>& turns) {
  std::vector<double> mismatch;
  mismatch.reserve(turns.size());
  for (const Turn& turn : turns) {
    mismatch.push_back(std::abs(turn.body.norm() - turn.marker.norm()));
  }
  const double limit = kOutlierMedians * Median(mismatch);
  std::vector<bool> used;
  double count = 0;
  Vector3d body_mean = Vector3d::Zero(), marker_mean = Vector3d::Zero();
  for (size_t i = 0; i < turns.size(); ++i) {
    used.push_back(mismatch[i] <= limit);
    if (used[i]) {
      body_mean += turns[i].body;
      marker_mean += turns[i].marker;
      ++count;
    }
  }
  Matrix3d moment = Matrix3d::Zero();
  for (size_t i = 0; i < turns.size(); ++i) {
    if (used[i]) {
      moment += (turns[i].body - body_mean / count) * (turns[i].marker - marker_mean / count).transpose();
    }
  }
  const Agreement parallel = Agree(turns, used, Matrix3d::Identity());
  const Agreement turned = Agree(turns, used, so3::Normalize(moment));
  return turned.median_rad < (1 - kClearGain) * parallel.median_rad ? turned : parallel;
}

std::vector<Turn> CollectTurns(const GyroTurns& gyro, std::span<const TruthPose> poses, TimeNs offset_ns) {
  std::vector<Turn> turns;
  const size_t stride = poses.size() / kMaxTurns + 1;
  size_t last = 0;
  for (size_t first = 0; first < poses.size(); first += stride) {
    const TimeNs from_ns = poses[first].stamp_ns + offset_ns;
    while (last < poses.size() &&
           SecondsBetween(poses[first].stamp_ns, poses[last].stamp_ns) < kTurnSeconds) {
      ++last;
    }
    if (last == poses.size()) {
      break;
    }
    const double duration_s = SecondsBetween(poses[first].stamp_ns, poses[last].stamp_ns);
    const TimeNs to_ns = poses[last].stamp_ns + offset_ns;
    if (duration_s > kMaxTurnSeconds || !gyro.Covers(from_ns) || !gyro.Covers(to_ns)) {
      continue;
    }
    turns.push_back({so3::Log(poses[first].T_TM.rotation.transpose() * poses[last].T_TM.rotation),
                     so3::Log(gyro.At(from_ns).transpose() * gyro.At(to_ns)), duration_s});
  }
  return turns;
}

class Start {
 public:
  Start(std::span<const ImuSample> imu, std::span<const TruthPose> poses)
      : imu_(imu), poses_(poses), gyro_(imu) {}

  TruthStart Execute() {
    FindOffset();
    FindVertical();
    AddStates();
    return std::move(start_);
  }

 private:
  void FindOffset() {
    const int steps = static_cast<int>(std::lround(kMaxOffsetSeconds / kOffsetStepSeconds));
    for (int step = 0; step <= 2 * steps; ++step) {
      // From zero outwards: of equals the smallest offset counts.
      const double offset_s = kOffsetStepSeconds * (step % 2 == 0 ? -step / 2 : (step + 1) / 2);
      const std::vector<Turn> turns = CollectTurns(gyro_, poses_, SecondsToNs(offset_s));
      if (turns.empty()) {
        continue;
      }
      const Agreement agreement = BestAgreement(turns);
      if (agreement.median_rad < best_.median_rad) {
        best_ = agreement;
        start_.constants.time_offset_s = offset_s;
      }
    }
    start_.constants.T_BM.rotation = best_.R_BM;
  }

  [[nodiscard]] TimeNs ImuStamp(const TruthPose& pose) const {
    return pose.stamp_ns + SecondsToNs(start_.constants.time_offset_s);
  }

  void FindVertical() {
    Vector3d up_T = Vector3d::Zero();
    for (const TruthPose& pose : poses_) {
      const TimeNs stamp_ns = ImuStamp(pose);
      if (gyro_.Covers(stamp_ns)) {
        const size_t i = gyro_.Before(stamp_ns);
        const Vector3d force_B = Interpolate(imu_[i], imu_[i + 1], stamp_ns).accel;
        up_T += pose.T_TM.rotation * start_.constants.T_BM.rotation.transpose() * force_B;
      }
    }
    start_.constants.R_TW =
        up_T.norm() > 0 ? so3::Between(Vector3d::UnitZ(), up_T) : Matrix3d(Matrix3d::Identity());
  }

  /// Of the marker in W, linear between the poses.
  [[nodiscard]] Vector3d PositionAt(TimeNs stamp_ns) const {
    const auto earlier = [this](const TruthPose& pose, TimeNs stamp) { return ImuStamp(pose) < stamp; };
    const auto after = std::lower_bound(poses_.begin(), poses_.end(), stamp_ns, earlier);
    Vector3d p_T = after == poses_.end() ? poses_.back().T_TM.translation : after->T_TM.translation;
    if (after != poses_.end() && after != poses_.begin()) {
      const TruthPose& before = *(after - 1);
      const double share =
          SecondsBetween(ImuStamp(before), stamp_ns) / SecondsBetween(before.stamp_ns, after->stamp_ns);
      p_T = before.T_TM.translation + share * (p_T - before.T_TM.translation);
    }
    return start_.constants.R_TW.transpose() * p_T;
  }

  void AddStates() {
    size_t next = 0;
    const TimeNs half_ns = SecondsToNs(0.5 * kTurnSeconds);
    for (const ImuSample& sample : imu_) {
      while (next + 1 < poses_.size() && ImuStamp(poses_[next + 1]) <= sample.stamp_ns) {
        ++next;
      }
      TruthState state;
      const TimeNs known_ns = std::clamp(ImuStamp(poses_[next]), imu_.front().stamp_ns, imu_.back().stamp_ns);
      const Matrix3d turn = gyro_.At(known_ns).transpose() * gyro_.At(sample.stamp_ns);
      const double duration_s = SecondsBetween(known_ns, sample.stamp_ns);
      state.nav.R_WB = start_.constants.R_TW.transpose() * poses_[next].T_TM.rotation *
                       best_.R_BM.transpose() * so3::Normalize(turn) *
                       so3::Exp(-best_.gyro_bias * duration_s);
      state.nav.p_WB = PositionAt(sample.stamp_ns);
      state.nav.v_WB =
          (PositionAt(sample.stamp_ns + half_ns) - PositionAt(sample.stamp_ns - half_ns)) / kTurnSeconds;
      state.bias.gyro = best_.gyro_bias;
      start_.states.push_back(state);
    }
  }

  std::span<const ImuSample> imu_;
  std::span<const TruthPose> poses_;
  GyroTurns gyro_;
  Agreement best_;
  TruthStart start_;
};

}  // namespace

TruthStart StartTruth(std::span<const ImuSample> imu, std::span<const TruthPose> poses) {
  return Start(imu, poses).Execute();
}

}  // namespace alidade
