#include <bit>
#include <cstdint>
#include <string>

#include "eval/dataset.h"
#include "eval/sha256.h"

namespace alidade {
namespace {

/// Collects numbers as little-endian 64-bit words, whatever the machine, and hashes them in blocks.
class Hasher {
 public:
  Hasher() { block_.reserve(kBlock); }

  void Add(std::uint64_t word) {
    for (int shift = 0; shift < 64; shift += 8) {
      block_.push_back(static_cast<char>(static_cast<unsigned char>(word >> shift)));
    }
    if (block_.size() >= kBlock) {
      Flush();
    }
  }
  void Add(std::int64_t number) { Add(static_cast<std::uint64_t>(number)); }
  void Add(double number) { Add(std::bit_cast<std::uint64_t>(number + 0.0)); }  // -0 counts as 0
  template <typename Derived>
  void Add(const Eigen::MatrixBase<Derived>& matrix) {
    for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
      for (Eigen::Index col = 0; col < matrix.cols(); ++col) {
        Add(static_cast<double>(matrix(row, col)));
      }
    }
  }

  std::string Hex() {
    Flush();
    return hash_.Hex();
  }

 private:
  static constexpr size_t kBlock = 1 << 16;

  void Flush() {
    hash_.Add(block_);
    block_.clear();
  }

  Sha256 hash_;
  std::string block_;
};

void AddCamera(const CameraModel& camera, const Pose& T_BC, Hasher* hasher) {
  hasher->Add(static_cast<std::int64_t>(camera.model()));
  hasher->Add(std::int64_t{camera.width_px()});
  hasher->Add(std::int64_t{camera.height_px()});
  hasher->Add(camera.intrinsics());
  hasher->Add(camera.coefficients());
  hasher->Add(T_BC.rotation);
  hasher->Add(T_BC.translation);
}

void AddRig(const RigCalibration& rig, Hasher* hasher) {
  AddCamera(rig.camera, rig.T_BC, hasher);
  hasher->Add(rig.imu_noise.gyro_noise_density_radps_sqrthz);
  hasher->Add(rig.imu_noise.accel_noise_density_mps2_sqrthz);
  hasher->Add(rig.imu_noise.gyro_random_walk_radps2_sqrthz);
  hasher->Add(rig.imu_noise.accel_random_walk_mps3_sqrthz);
  hasher->Add(rig.camera_time_offset_s);
}

/// Counts before lists: without them a sample could move between lists and leave the bytes unchanged.
void AddFrames(const std::vector<TrackFrame>& frames, Hasher* hasher) {
  hasher->Add(static_cast<std::uint64_t>(frames.size()));
  for (const TrackFrame& frame : frames) {
    hasher->Add(std::int64_t{frame.stamp_ns});
    hasher->Add(static_cast<std::uint64_t>(frame.observations.size()));
    for (const TrackObservation& observation : frame.observations) {
      hasher->Add(observation.track_id);
      hasher->Add(observation.pixel);
    }
  }
}

}  // namespace

std::string DigestOf(const MeasurementLog& log) {
  Hasher hasher;
  AddRig(log.rig, &hasher);
  hasher.Add(static_cast<std::uint64_t>(log.imu.size()));
  for (const ImuSample& sample : log.imu) {
    hasher.Add(std::int64_t{sample.stamp_ns});
    hasher.Add(sample.gyro);
    hasher.Add(sample.accel);
  }
  AddFrames(log.frames, &hasher);
  for (const ExtraCamera& extra : log.extra_cameras) {
    AddCamera(extra.camera, extra.T_BC, &hasher);
    hasher.Add(extra.camera_time_offset_s);
    AddFrames(extra.frames, &hasher);
  }
  return hasher.Hex();
}

}  // namespace alidade
