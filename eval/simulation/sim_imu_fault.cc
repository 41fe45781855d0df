#include "eval/simulation/sim_imu_fault.h"

#include <algorithm>

#include "core/numbers.h"
#include "core/random.h"

namespace alidade {
namespace {

using Eigen::Vector3d;
using Signal = Vector3d ImuSample::*;

constexpr double kGarbageRate_radps = 3;
constexpr double kGarbageForce_mps2 = 30;
constexpr double kSpikeRate_radps = 30;
constexpr double kSpikeForce_mps2 = 490;

void Garble(const FaultSpan& span, std::uint64_t seed, std::vector<ImuSample>* imu) {
  RandomStream random(seed, "fault/imu");
  for (ImuSample& sample : *imu) {
    if (span.Contains(sample.stamp_ns)) {
      for (int axis = 0; axis < 3; ++axis) {
        sample.gyro[axis] = random.Uniform(-kGarbageRate_radps, kGarbageRate_radps);
        sample.accel[axis] = random.Uniform(-kGarbageForce_mps2, kGarbageForce_mps2);
      }
    }
  }
}

void Silence(const FaultSpan& span, std::vector<ImuSample>* imu) {
  std::erase_if(*imu, [&](const ImuSample& sample) { return span.Contains(sample.stamp_ns); });
}

void AddSpike(const FaultSpan& span, std::uint64_t seed, bool of_gyro, std::vector<ImuSample>* imu) {
  std::vector<ImuSample*> candidates;
  for (ImuSample& sample : *imu) {
    if (span.Contains(sample.stamp_ns)) {
      candidates.push_back(&sample);
    }
  }
  if (candidates.empty()) {
    return;
  }
  RandomStream random(seed, "fault/spike");
  ImuSample& sample = *candidates[static_cast<std::size_t>(random.Below(candidates.size()))];
  const Eigen::Vector3d direction = random.Normal3().normalized();
  if (of_gyro) {
    sample.gyro += kSpikeRate_radps * direction;
  } else {
    sample.accel += kSpikeForce_mps2 * direction;
  }
}

void Saturate(const FaultSpan& span, Signal signal, double share, std::vector<ImuSample>* imu) {
  const Vector3d limits = SaturationLimits(*imu, signal, share);
  for (ImuSample& sample : *imu) {
    if (span.Contains(sample.stamp_ns)) {
      sample.*signal = (sample.*signal).cwiseMin(limits).cwiseMax(-limits);
    }
  }
}

void Repeat(const FaultSpan& span, Signal signal, const std::vector<Eigen::Index>& axes,
            std::vector<ImuSample>* imu) {
  const ImuSample* last = nullptr;
  for (ImuSample& sample : *imu) {
    for (const Eigen::Index axis : axes) {
      if (last != nullptr && span.Contains(sample.stamp_ns)) {
        (sample.*signal)[axis] = (last->*signal)[axis];
      }
    }
    last = &sample;
  }
}

/// One axis, which the seed draws.
std::vector<Eigen::Index> OneAxis(std::uint64_t seed) {
  return {static_cast<Eigen::Index>(RandomStream(seed, "fault/stuck").Below(3))};
}

void ChangeUnit(const FaultSpan& span, std::vector<ImuSample>* imu) {
  for (ImuSample& sample : *imu) {
    sample.gyro *= sample.stamp_ns >= span.begin_ns ? kDegreesPerRadian : 1;
  }
}

void JumpClock(const FaultSpan& span, TimeNs jump_ns, std::vector<ImuSample>* imu) {
  for (ImuSample& sample : *imu) {
    sample.stamp_ns += sample.stamp_ns >= span.begin_ns ? jump_ns : 0;
  }
}

}  // namespace

Vector3d SaturationLimits(const std::vector<ImuSample>& samples, Vector3d ImuSample::*signal, double share) {
  Vector3d sum = Vector3d::Zero();
  Vector3d largest = Vector3d::Zero();
  for (const ImuSample& sample : samples) {
    sum += sample.*signal;
    largest = largest.cwiseMax((sample.*signal).cwiseAbs());
  }
  const Vector3d mean = sum.cwiseAbs() / std::max(1.0, static_cast<double>(samples.size()));
  return mean + share * (largest - mean);
}

void ApplyImuFault(const SimulatorConfig& config, std::uint64_t seed, const FaultSpan& span,
                   std::vector<ImuSample>* imu) {
  switch (config.fault) {
    case SimFaultKind::kImu:
    case SimFaultKind::kBlackoutAndImu:
      Garble(span, seed, imu);
      break;
    case SimFaultKind::kImuGap:
      Silence(span, imu);
      break;
    case SimFaultKind::kGyroSpike:
    case SimFaultKind::kAccelSpike:
      AddSpike(span, seed, config.fault == SimFaultKind::kGyroSpike, imu);
      break;
    case SimFaultKind::kGyroSaturation:
      Saturate(span, &ImuSample::gyro, config.fault_limit_share, imu);
      break;
    case SimFaultKind::kAccelSaturation:
      Saturate(span, &ImuSample::accel, config.fault_limit_share, imu);
      break;
    case SimFaultKind::kGyroStuck:
      Repeat(span, &ImuSample::gyro, OneAxis(seed), imu);
      break;
    case SimFaultKind::kAccelStuck:
      Repeat(span, &ImuSample::accel, OneAxis(seed), imu);
      break;
    case SimFaultKind::kImuFrozen:
      Repeat(span, &ImuSample::accel, {0, 1, 2}, imu);
      [[fallthrough]];
    case SimFaultKind::kGyroFrozen:
      Repeat(span, &ImuSample::gyro, {0, 1, 2}, imu);
      break;
    case SimFaultKind::kImuUnit:
      ChangeUnit(span, imu);
      break;
    case SimFaultKind::kImuClock:
      JumpClock(span, SecondsToNs(config.fault_clock_jump_s), imu);
      break;
    default:
      break;
  }
}

}  // namespace alidade
