#pragma once

#include <memory>
#include <string>

#include "eval/dataset/dataset.h"
#include "eval/dataset/dataset_check.h"
#include "gnss/model/gnss_epoch.h"
#include "tests/gnss/model/synthetic_sky.h"

namespace alidade::test {

/// Ten seconds at rest, a camera that sees two tracks, truth throughout: nothing to complain about.
inline Dataset Healthy() {
  Dataset dataset;
  dataset.rig.camera =
      CameraModel::Create(DistortionModel::kNone, Eigen::Vector4d(400, 400, 320, 240), {}, 640, 480).value();
  dataset.imu_rate_hz = 100;
  dataset.camera_rate_hz = 10;
  Trajectory truth;
  for (int i = 0; i <= 1000; ++i) {
    const TimeNs stamp = 1'500'000'000'000'000'000 + i * TimeNs{10'000'000};
    const double noise = 1e-4 * (i % 7);
    dataset.imu.push_back(
        {stamp, Eigen::Vector3d(1e-4 * i, 0.1 + noise, noise), Eigen::Vector3d(noise, noise, 9.8 + noise)});
    TrajectoryPoint point;
    point.stamp_ns = stamp;
    truth.points.push_back(point);
    if (i % 10 == 0) {
      dataset.frames.push_back({stamp, {{1, Eigen::Vector2d(5, 5)}, {2, Eigen::Vector2d(600, 400)}}, 0});
    }
  }
  dataset.truth = truth;
  return dataset;
}

/// The findings of one severity, one text a line.
inline std::string Complaints(const Dataset& dataset, DatasetFinding::Severity severity) {
  std::string text;
  for (const DatasetFinding& finding : CheckDataset(dataset)) {
    if (finding.severity == severity) {
      text += finding.text + "\n";
    }
  }
  return text;
}

/// With GNSS once a second, tags and ephemerides shifted.
inline Dataset WithGnss(double tags_s, double ephemerides_s) {
  Dataset dataset = Healthy();
  const TimeNs begin = dataset.imu.front().stamp_ns;
  auto log = std::make_shared<GnssLog>();
  for (int i = 0; i < 10; ++i) {
    SyntheticReceiver receiver;
    receiver.stamp_ns = begin + i * kSecondNs;
    ObservationEpoch epoch = Observe(SyntheticSky(begin), receiver);
    epoch.stamp_ns += SecondsToNs(tags_s);
    log->epochs.push_back(epoch);
  }
  log->catalog = std::make_shared<SatelliteCatalog>(SyntheticSky(begin + SecondsToNs(ephemerides_s)));
  dataset.gnss = log;
  return dataset;
}

}  // namespace alidade::test
