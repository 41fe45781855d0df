#include "eval/dataset/dataset.h"

#include <utility>

namespace alidade {

MeasurementLog MeasurementsOf(Dataset dataset) {
  MeasurementLog log{std::move(dataset.rig), std::move(dataset.imu), std::move(dataset.frames),
                     std::move(dataset.extra_cameras), std::move(dataset.gnss)};
  CopyMeasurements(dataset, &log);
  log.imu_rejected = static_cast<int>(dataset.imu_rejections.dropped());
  return log;
}

Dataset DatasetOf(MeasurementLog log) {
  Dataset dataset;
  dataset.rig = std::move(log.rig);
  dataset.imu = std::move(log.imu);
  dataset.frames = std::move(log.frames);
  dataset.extra_cameras = std::move(log.extra_cameras);
  dataset.gnss = std::move(log.gnss);
  CopyMeasurements(log, &dataset);
  return dataset;
}

}  // namespace alidade
