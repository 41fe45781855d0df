#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "estimator/measurement_log.h"
#include "eval/rosbag/rosbag_record.h"
#include "eval/trajectory/trajectory.h"

namespace alidade {

struct ImageEntry {
  /// In a bag, `path` names the bag.
  struct InBag {
    BagPlace place;
    bool compressed = false;  ///< a sensor_msgs/CompressedImage
  };
  TimeNs stamp_ns = 0;
  std::string path;
  std::optional<InBag> in_bag = std::nullopt;
};

/// A sequence in the extended ASL layout (contract: <seq>/mav0/{imu0,cam0,state_groundtruth_estimate0}).
struct Dataset {
  std::string path;
  std::string name;  ///< last folder of the path
  RigCalibration rig;
  /// The true rig, of a simulation that writes a wrong calibration (calibration_*_error).
  std::optional<RigCalibration> true_rig;
  double imu_rate_hz = 0;
  double camera_rate_hz = 0;
  std::vector<ImuSample> imu;
  std::vector<TrackFrame> tracks;          ///< cam0/tracks.csv, grouped by stamp; empty when there is none
  std::vector<ExtraCamera> extra_cameras;  ///< cam1, cam2, ... that have tracks
  std::vector<ImageEntry> images;          ///< cam0/data.csv, or of a bag; empty when there is none
  std::vector<TimeNs> camera_stamps;       ///< cam0/timestamps.csv; empty when there is none
  std::shared_ptr<const GnssLog> gnss;     ///< gnss0: observations and navigation data; null without it
  std::vector<PositionFix> fixes;          ///< fix0, fix1, ... of rig.fixes, as in MeasurementLog
  std::optional<Trajectory>
      truth;  ///< state_groundtruth_estimate0/{data.csv | data_pose.csv | data_position.csv}
  std::string truth_path;
};

/// Reads everything but pixels of a folder; a ROS bag: ReadDataset of eval/bag/dataset_source.h. Every fault
/// is kInput naming file, line, value and expectation: missing file, wrong header, torn row, non-finite
/// number, stamps not increasing, non-rigid T_BS, unknown distortion model, wrong resolution.
Result<Dataset> ReadDataset(const std::string& path);

/// Writes imu0, cam0 (tracks, stamps) and truth under `path`. Numbers are the shortest text that reads back
/// equal.
Status WriteDataset(const Dataset& dataset, const std::string& path);
/// sensor.yaml of extra_cameras[k].
[[nodiscard]] std::string ExtraCameraYaml(const Dataset& dataset, size_t k);
/// Writes cam0/tracks.csv (and its sensor.yaml) alone: the output of the `track` command.
Status WriteTracks(const std::vector<TrackFrame>& tracks, const std::string& csv_path);

/// SHA-256 (hex) over the log's calibration, IMU and tracks and, where it has GNSS, receiver, observations
/// (pseudorange, Doppler, C/N0) and broadcast ephemerides: equal digests mean identical input to every
/// estimator. Of GNSS it leaves out reported deviations, ionosphere parameters and precise products.
[[nodiscard]] std::string DigestOf(const MeasurementLog& log);

/// A finding of `check`: an error, a warning or a fact about a sequence.
struct DatasetFinding {
  enum class Severity { kFact, kWarning, kError } severity = Severity::kFact;
  std::string text;
};
/// Rates, gaps, units (gravity magnitude, gyro in rad/s), time spans, offsets between sensors, duplicates.
[[nodiscard]] std::vector<DatasetFinding> CheckDataset(const Dataset& dataset);

}  // namespace alidade
