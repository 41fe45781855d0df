#include "eval/dataset/dataset_check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>

#include "core/format.h"
#include "eval/dataset/dataset_camera.h"
#include "eval/dataset/dataset_findings.h"
#include "gnss/model/gnss_epoch.h"
#include "gnss/positioning/time_check.h"

namespace alidade {
namespace {

constexpr double kStandardGravity = 9.80665;

/// Specific force averages to gravity on any path that returns to its starting speed; the gyroscope stays
/// below what motion a camera can follow.
void CheckImuUnits(const std::vector<ImuSample>& imu, Findings* findings) {
  double force = 0;
  double rate_square = 0;
  double fastest = 0;
  for (const ImuSample& sample : imu) {
    force += sample.accel.norm() / static_cast<double>(imu.size());
    rate_square += sample.gyro.squaredNorm() / static_cast<double>(imu.size());
    fastest = std::max(fastest, sample.gyro.norm());
  }
  const double rate_rms = std::sqrt(rate_square);
  findings->Fact(
      Format("imu0: mean specific force %.3f m/s^2, angular rate rms %.3f rad/s, largest %.3f rad/s", force,
             rate_rms, fastest));
  if (std::abs(force - 1) < 0.3) {
    findings->Error(
        Format("imu0: mean specific force %.3f: the accelerometer seems to be in g, expected m/s^2", force));
  } else if (std::abs(force - kStandardGravity) > 2.5) {
    findings->Error(
        Format("imu0: mean specific force %.3f m/s^2, expected about %.2f: unit or gravity removed?", force,
               kStandardGravity));
  } else if (std::abs(force - kStandardGravity) > 0.5) {
    findings->Warning(
        Format("imu0: mean specific force %.3f m/s^2 differs from %.2f: bias, scale error or strong motion",
               force, kStandardGravity));
  }
  if (rate_rms > 8 || fastest > 40) {
    findings->Error(Format(
        "imu0: angular rate rms %.2f, largest %.2f: the gyroscope seems to be in deg/s, expected rad/s",
        rate_rms, fastest));
  }
}

void CheckImuValues(const std::vector<ImuSample>& imu, const ImuNoise& noise, Findings* findings) {
  size_t repeated = 0;
  for (size_t i = 1; i < imu.size(); ++i) {
    repeated += imu[i].gyro == imu[i - 1].gyro && imu[i].accel == imu[i - 1].accel ? 1 : 0;
  }
  const double share = static_cast<double>(repeated) / static_cast<double>(imu.size() - 1);
  if (repeated > 0 && share > 0.01) {
    findings->Warning(
        Format("imu0: %zu rows (%.1f %%) repeat the values of the row before; the real rate is lower",
               repeated, 100 * share));
  }
  if (noise.gyro_noise_density_radps_sqrthz <= 0 || noise.accel_noise_density_mps2_sqrthz <= 0) {
    findings->Warning(
        "imu0: a noise density of zero in sensor.yaml: every covariance built on it will be too small");
  }
  if (noise.gyro_noise_density_radps_sqrthz > 0.05 || noise.accel_noise_density_mps2_sqrthz > 0.5) {
    findings->Warning(
        "imu0: noise densities in sensor.yaml are large: are they discrete standard deviations or in deg?");
  }
}

void CheckTracks(const Dataset& dataset, Findings* findings) {
  struct Life {
    size_t last_frame = 0;
    int observations = 0;
  };
  std::map<std::int64_t, Life> lives;
  size_t total = 0;
  size_t outside = 0;
  size_t returned = 0;
  for (size_t i = 0; i < dataset.tracks.size(); ++i) {
    for (const TrackObservation& observation : dataset.tracks[i].observations) {
      Life& life = lives[observation.track_id];
      returned += life.observations > 0 && life.last_frame + 1 < i ? 1 : 0;
      life = {i, life.observations + 1};
      outside += dataset.rig.camera.InImage(observation.pixel) ? 0 : 1;
      ++total;
    }
  }
  size_t useful = 0;
  for (const auto& [id, life] : lives) {
    useful += life.observations >= 3 ? 1 : 0;
  }
  findings->Fact(
      Format("cam0: %zu observations of %zu tracks, %.1f a frame, mean length %.2f; %zu tracks of 3 or more",
             total, lives.size(), static_cast<double>(total) / static_cast<double>(dataset.tracks.size()),
             static_cast<double>(total) / static_cast<double>(std::max<size_t>(1, lives.size())), useful));
  if (outside > 0) {
    const std::string text = Format("cam0: %zu observations are outside %d x %d px", outside,
                                    dataset.rig.camera.width_px(), dataset.rig.camera.height_px());
    // A few per mille sit on the border; more means the resolution is not that of the tracks.
    if (outside * 20 > total) {
      findings->Error(text + ": wrong resolution?");
    } else {
      findings->Warning(text);
    }
  }
  if (returned > 0) {
    findings->Warning(
        Format("cam0: %zu times a track is missing in some frames and reappears with the same id", returned));
  }
}

void CheckTruth(const Dataset& dataset, Findings* findings) {
  if (!dataset.truth.has_value()) {
    findings->Warning("truth: none; estimates cannot be evaluated");
    return;
  }
  std::vector<TimeNs> stamps;
  double path = 0;
  for (const TrajectoryPoint& point : dataset.truth->points) {
    if (!stamps.empty()) {
      path += (point.nav.p_WB - dataset.truth->points[stamps.size() - 1].nav.p_WB).norm();
    }
    stamps.push_back(point.stamp_ns);
  }
  CheckStamps("truth", stamps, 0, findings);
  CheckSpan("truth", stamps.front(), stamps.back(), dataset, findings);
  const double imu_span = SecondsBetween(dataset.imu.front().stamp_ns, dataset.imu.back().stamp_ns);
  const TimeNs shared_first = std::max(stamps.front(), dataset.imu.front().stamp_ns);
  const TimeNs shared_last = std::min(stamps.back(), dataset.imu.back().stamp_ns);
  const double covered = std::max(0.0, SecondsBetween(shared_first, shared_last)) / imu_span;
  findings->Fact(Format("truth: covers %.1f %% of the IMU's time, path %.2f m%s", 100 * covered, path,
                        dataset.truth->has_velocity ? ", with velocity and biases" : ", poses only"));
  if (covered < 0.5) {
    findings->Warning(Format("truth: covers only %.1f %% of the IMU's time", 100 * covered));
  }
}

std::vector<TimeNs> CameraStamps(const Dataset& dataset) {
  if (!dataset.camera_stamps.empty()) {
    return dataset.camera_stamps;
  }
  std::vector<TimeNs> stamps;
  for (const TrackFrame& frame : dataset.tracks) {
    stamps.push_back(frame.stamp_ns);
  }
  if (stamps.empty()) {
    for (const ImageEntry& image : dataset.images) {
      stamps.push_back(image.stamp_ns);
    }
  }
  return stamps;
}

/// Whether the ephemerides serve at the epochs' times.
void CheckEphemerides(const GnssLog& log, Findings* findings) {
  const GnssCoverage coverage = CheckCoverage(log);
  if (coverage.usable_epochs < coverage.epochs) {
    findings->Warning(Format("gnss0: %d of %d sampled epochs have no satellite that can be used (",
                             coverage.epochs - coverage.usable_epochs, coverage.epochs) +
                      Describe(coverage.faults) +
                      Format("); the nearest ephemeris is %.1f h away", coverage.nearest_s / 3600));
  }
}

}  // namespace

std::vector<DatasetFinding> CheckDataset(const Dataset& dataset) {
  Findings findings;
  std::vector<TimeNs> imu_stamps;
  for (const ImuSample& sample : dataset.imu) {
    imu_stamps.push_back(sample.stamp_ns);
  }
  CheckStamps("imu0", imu_stamps, dataset.imu_rate_hz, &findings);
  if (imu_stamps.size() < 2) {
    return findings.Take();
  }
  CheckImuUnits(dataset.imu, &findings);
  CheckImuValues(dataset.imu, dataset.rig.imu_noise, &findings);

  const std::vector<TimeNs> camera_stamps = CameraStamps(dataset);
  if (camera_stamps.empty()) {
    findings.Warning(dataset.gnss == nullptr ? "cam0: none; estimators need a camera or GNSS"
                                             : "cam0: none; only GNSS and IMU");
  } else {
    CheckStamps("cam0", camera_stamps, dataset.camera_rate_hz, &findings);
    CheckSpan("cam0", camera_stamps.front(), camera_stamps.back(), dataset, &findings);
  }
  if (!dataset.tracks.empty()) {
    CheckTracks(dataset, &findings);
  } else if (!dataset.images.empty()) {
    findings.Fact(Format("cam0: %zu images, no tracks: the front end runs on them", dataset.images.size()));
  } else if (!camera_stamps.empty()) {
    findings.Warning("cam0: only stamps, neither images nor tracks");
  }
  if (dataset.gnss != nullptr) {
    size_t satellites = 0;
    for (const ObservationEpoch& epoch : dataset.gnss->epochs) {
      satellites += epoch.satellites.size();
    }
    const size_t epochs = dataset.gnss->epochs.size();
    findings.Fact(Format(
        "gnss0: %zu epochs, %.1f Hz, %.1f satellites each, %zu ephemerides", epochs,
        MeasuredRate(dataset.gnss->epochs.front().stamp_ns, dataset.gnss->epochs.back().stamp_ns, epochs),
        static_cast<double>(satellites) / static_cast<double>(epochs),
        dataset.gnss->catalog->navigation().ephemerides()));
    const TimeNs offset_ns = SecondsToNs(dataset.rig.gnss.time_offset_s);
    CheckSpan("gnss0", dataset.gnss->epochs.front().stamp_ns + offset_ns,
              dataset.gnss->epochs.back().stamp_ns + offset_ns, dataset, &findings);
    CheckEphemerides(*dataset.gnss, &findings);
  }
  CheckFixes(dataset, &findings);
  if (!dataset.extra_cameras.empty()) {
    findings.Fact(Format("%zu more cameras with tracks: recorded, but estimators read only cam0",
                         dataset.extra_cameras.size()));
  }
  CheckTruth(dataset, &findings);
  return findings.Take();
}

}  // namespace alidade
