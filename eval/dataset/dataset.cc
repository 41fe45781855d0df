#include "eval/dataset/dataset.h"

namespace alidade {

MeasurementLog MeasurementsOf(const Dataset& dataset) {
  MeasurementLog log;
  log.rig = dataset.rig;
  log.imu = dataset.imu;
  log.frames = dataset.tracks;
  log.extra_cameras = dataset.extra_cameras;
  log.gnss = dataset.gnss;
  CopyMeasurements(dataset, &log);
  return log;
}

Dataset DatasetOf(const MeasurementLog& log) {
  Dataset dataset;
  dataset.rig = log.rig;
  dataset.imu = log.imu;
  dataset.tracks = log.frames;
  dataset.extra_cameras = log.extra_cameras;
  dataset.gnss = log.gnss;
  CopyMeasurements(log, &dataset);
  return dataset;
}

}  // namespace alidade
