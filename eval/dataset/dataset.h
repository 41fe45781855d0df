#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/estimator/measurement_log.h"
#include "eval/rosbag/rosbag_record.h"
#include "eval/trajectory/trajectory.h"

namespace alidade {

struct LogTables;

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

/// The largest share of a sequence's images that may be unreadable.
inline constexpr double kMaxUnreadableShare = 0.05;

/// IMU samples that a reader could not use as they are.
struct ImuRejections {
  std::size_t duplicate = 0;   ///< dropped: the stamp of a sample before
  std::size_t late = 0;        ///< dropped: out of order by more than kMaxImuLatenessNs
  std::size_t not_finite = 0;  ///< dropped: a NaN or an infinity
  std::size_t reordered = 0;   ///< kept: out of order by less
  double set_back_s = 0;       ///< by which the clock was set back in all; later stamps are moved by that
  [[nodiscard]] std::size_t dropped() const { return duplicate + late + not_finite; }
};

/// Where a reader puts what grows with the length of a sequence, and which links it follows.
struct DatasetStorage {
  /// For one pass through a sequence of any length: IMU and tracks go into files without names in this folder
  /// (Dataset::tables). Empty: into memory.
  std::string spool_folder{};
  /// Of the truth, with spool_folder: what a start needs, up to so long after the first frame [s].
  double truth_s = 0;
  /// Images may be links to files outside of the sequence (ImageFolder).
  bool follow_links = false;
};

/// Of a truth that was not kept whole: stamps and length.
struct TruthExtent {
  std::vector<TimeNs> stamps;
  double path_m = 0;
};

/// A sequence in the extended ASL layout (contract: <seq>/mav0/{imu0,cam0,state_groundtruth_estimate0}).
struct Dataset {
  std::string path;
  std::string name;        ///< last folder of the path
  bool has_sheets = true;  ///< a sensor's calibration is in its sensor.yaml; else in any file
  RigCalibration rig;
  /// The true rig, of a simulation that writes a wrong calibration (calibration_*_error).
  std::optional<RigCalibration> true_rig;
  double imu_rate_hz = 0;
  double camera_rate_hz = 0;
  std::vector<ImuSample> imu;
  ImuRejections imu_rejections;
  std::vector<std::string> remarks;        ///< what the reader passed over or assumed, as text
  std::vector<TrackFrame> frames;          ///< cam0/tracks.csv, grouped by stamp; empty when there is none
  std::vector<ExtraCamera> extra_cameras;  ///< cam1, cam2, ... that have tracks
  std::vector<ImageEntry> images;          ///< cam0/data.csv, or of a bag; empty when there is none
  std::vector<TimeNs> camera_stamps;       ///< cam0/timestamps.csv; empty when there is none
  std::shared_ptr<const GnssLog> gnss;     ///< gnss0: observations and navigation data; null without it
  std::vector<PositionFix> fixes;          ///< fix0, fix1, ... of rig.fixes, as in MeasurementLog
  std::optional<Trajectory>
      truth;  ///< state_groundtruth_estimate0/{data.csv | data_pose.csv | data_position.csv}
  std::string truth_path;
  /// Of DatasetStorage::spool_folder, else null; `imu`, `frames` and those of `extra_cameras` are then
  /// empty, and `truth` is the part that a start needs, its extent beside it.
  std::shared_ptr<LogTables> tables;
  std::optional<TruthExtent> truth_extent;
};

/// What the estimators are given of a sequence; without tracks, if the front end has still to make them.
[[nodiscard]] MeasurementLog MeasurementsOf(Dataset dataset);
/// A sequence of these measurements; the rest of it is empty.
[[nodiscard]] Dataset DatasetOf(MeasurementLog log);

}  // namespace alidade
