#include "eval/dataset/dataset_truth.h"

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <utility>

#include "core/format.h"
#include "eval/dataset/dataset_findings.h"
#include "eval/dataset/log_tables.h"
#include "eval/dataset/sensor_table.h"
#include "eval/dataset/stale_parts.h"
#include "eval/files/input_file.h"
#include "eval/files/output_file.h"
#include "eval/trajectory/trajectory_reader.h"
#include "eval/trajectory/truth_covariance.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

/// Of a truth that is passed over: its extent, its first and last point and those that a start may ask for.
class TruthPart {
 public:
  TruthPart(const DatasetStorage& storage, const Dataset& dataset) {
    constexpr TimeNs kMarginNs = 10 * kSecondNs;  // beyond any time offset and any gap
    const LogTables tables = TablesOf(dataset);
    const TimeNs first_ns = !tables.frames.empty()    ? tables.frames.front().stamp_ns
                            : !dataset.images.empty() ? dataset.images.front().stamp_ns
                                                      : tables.imu.front().stamp_ns;
    from_ns_ = first_ns - kMarginNs;
    to_ns_ = first_ns + SecondsToNs(storage.truth_s) + kMarginNs;
  }

  void Add(const TrajectoryPoint& point) {
    extent_.path_m += extent_.stamps.empty() ? 0 : (point.nav.p_WB - last_.nav.p_WB).norm();
    if (extent_.stamps.empty() || (from_ns_ <= point.stamp_ns && point.stamp_ns <= to_ns_)) {
      points_.push_back(point);
    }
    extent_.stamps.push_back(point.stamp_ns);
    last_ = point;
  }

  Status MoveTo(const std::string& path, Trajectory truth, Dataset* dataset) {
    if (points_.back().stamp_ns != last_.stamp_ns) {
      points_.push_back(last_);
    }
    if (!truth.has_covariance && truth.has_orientation) {
      const Result<bool> has = ReadCovarianceBeside(path, extent_.stamps, [](size_t, const Matrix6d&) {});
      ALIDADE_RETURN_IF_ERROR(has.status());
      truth.has_covariance = *has;
    }
    truth.points = std::move(points_);
    dataset->truth = std::move(truth);
    dataset->truth_extent = std::move(extent_);
    return Status::Ok();
  }

 private:
  TimeNs from_ns_ = 0, to_ns_ = 0;
  TruthExtent extent_;
  TrajectoryPoint last_;
  std::vector<TrajectoryPoint> points_;
};

Status ReadTruthPart(const std::string& path, const DatasetStorage& storage, Dataset* dataset) {
  TruthPart part(storage, *dataset);
  Result<Trajectory> truth = ReadTrajectory(path, [&part](const TrajectoryPoint& point) { part.Add(point); });
  ALIDADE_RETURN_IF_ERROR(truth.status());
  return part.MoveTo(path, std::move(truth).value(), dataset);
}

Status ReadOneTruth(const fs::path& folder, const DatasetStorage& storage, Dataset* dataset) {
  for (const char* name : {"data.csv", "data_pose.csv", "data_position.csv"}) {
    const fs::path path = folder / name;
    if (!MayExist(path.string())) {
      continue;
    }
    dataset->truth_path = path.string();
    if (dataset->tables != nullptr) {
      return ReadTruthPart(path.string(), storage, dataset);
    }
    Result<Trajectory> truth = ReadTrajectory(path.string());
    ALIDADE_RETURN_IF_ERROR(truth.status());
    dataset->truth = std::move(truth).value();
    return Status::Ok();
  }
  if (MayBeFolder(folder.string())) {
    return Status::Input(folder.string() +
                         ": expected data.csv, data_pose.csv or data_position.csv; found none");
  }
  return Status::Ok();
}

TruthExtent ExtentOf(const Trajectory& truth) {
  TruthExtent extent;
  for (size_t i = 0; i < truth.points.size(); ++i) {
    extent.path_m += i == 0 ? 0 : (truth.points[i].nav.p_WB - truth.points[i - 1].nav.p_WB).norm();
    extent.stamps.push_back(truth.points[i].stamp_ns);
  }
  return extent;
}

}  // namespace

std::string TruthCsv(const Trajectory& truth) {
  std::string text =
      truth.has_velocity
          ? "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],"
            "q_RS_z [],v_RS_R_x [m s^-1],v_RS_R_y [m s^-1],v_RS_R_z [m s^-1],b_w_RS_S_x [rad s^-1],"
            "b_w_RS_S_y [rad s^-1],b_w_RS_S_z [rad s^-1],b_a_RS_S_x [m s^-2],b_a_RS_S_y [m s^-2],"
            "b_a_RS_S_z [m s^-2]\n"
      : truth.has_orientation ? "#timestamp [ns],p_x,p_y,p_z,q_w,q_x,q_y,q_z\n"
                              : "#timestamp [ns],p_x,p_y,p_z\n";
  text.reserve(truth.points.size() * 340);
  for (const TrajectoryPoint& point : truth.points) {
    const Eigen::Quaterniond q(point.nav.R_WB);
    text += std::to_string(point.stamp_ns);
    AppendFields(point.nav.p_WB, &text);
    if (truth.has_orientation) {
      AppendField(q.w(), &text);
      AppendFields(q.vec(), &text);
    }
    if (truth.has_velocity) {
      AppendFields(point.nav.v_WB, &text);
      AppendFields(point.bias.gyro, &text);
      AppendFields(point.bias.accel, &text);
    }
    text.push_back('\n');
  }
  return text;
}

Status ReadTruthFolder(const std::string& mav, const DatasetStorage& storage, Dataset* dataset) {
  ALIDADE_RETURN_IF_ERROR(ReadOneTruth(fs::path(mav) / "state_groundtruth_estimate0", storage, dataset));
  const fs::path tum_vi = fs::path(mav) / "mocap0";
  return dataset->truth ? Status::Ok() : ReadOneTruth(tum_vi, storage, dataset);
}

Status WriteTruthFolder(const Dataset& dataset, const std::string& mav) {
  const fs::path folder = fs::path(mav) / "state_groundtruth_estimate0";
  const bool own = IsItsOwnFolder(dataset, mav);
  if (!dataset.truth.has_value()) {
    return own ? Status::Ok() : RemoveStaleFolder(folder.string());
  }
  const char* name = dataset.truth->has_velocity      ? "data.csv"
                     : dataset.truth->has_orientation ? "data_pose.csv"
                                                      : "data_position.csv";
  for (const char* other : {"data.csv", "data_pose.csv", "data_position.csv"}) {
    if (!own && std::string_view(other) != name) {
      const std::string covariance = fs::path(CovariancePath((folder / other).string())).filename().string();
      ALIDADE_RETURN_IF_ERROR(RemoveStaleFiles(folder.string(), {other, covariance.c_str()}));
    }
  }
  const std::string path = (folder / name).string();
  ALIDADE_RETURN_IF_ERROR(WriteFileAtomically(path, TruthCsv(*dataset.truth)));
  if (dataset.truth->has_covariance) {
    return WriteFileAtomically(CovariancePath(path), CovarianceCsv(*dataset.truth));
  }
  std::error_code ignored;
  fs::remove(CovariancePath(path), ignored);  // of another truth
  return Status::Ok();
}

void CheckTruth(const Dataset& dataset, Findings* findings) {
  if (!dataset.truth.has_value()) {
    findings->Warning("truth: none; estimates cannot be evaluated");
    return;
  }
  const TruthExtent extent = dataset.truth_extent.value_or(ExtentOf(*dataset.truth));
  const std::vector<TimeNs>& stamps = extent.stamps;
  CheckStamps("truth", stamps, 0, kAnyRates, findings);
  if (!CheckSpan("truth", stamps.front(), stamps.back(), dataset, findings)) {
    return;
  }
  const Table<ImuSample> imu = TablesOf(dataset).imu;
  const double imu_span = SecondsBetween(imu.front().stamp_ns, imu.back().stamp_ns);
  const TimeNs shared_first = std::max(stamps.front(), imu.front().stamp_ns);
  const TimeNs shared_last = std::min(stamps.back(), imu.back().stamp_ns);
  const double covered = std::max(0.0, SecondsBetween(shared_first, shared_last)) / imu_span;
  findings->Fact(Format("truth: covers %.1f %% of the IMU's time, path %.2f m%s%s", 100 * covered,
                        extent.path_m,
                        dataset.truth->has_velocity ? ", with velocity and biases" : ", poses only",
                        dataset.truth->has_covariance ? ", with covariances" : ""));
  if (covered < 0.5) {
    findings->Warning(Format("truth: covers only %.1f %% of the IMU's time", 100 * covered));
  }
}

}  // namespace alidade
