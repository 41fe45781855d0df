#include "eval/dataset/dataset_truth.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "core/format.h"
#include "eval/dataset/dataset_findings.h"
#include "eval/dataset/sensor_table.h"
#include "eval/files/input_file.h"
#include "eval/files/output_file.h"
#include "eval/trajectory/trajectory_reader.h"
#include "eval/trajectory/truth_covariance.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

Status ReadOneTruth(const fs::path& folder, Dataset* dataset) {
  for (const char* name : {"data.csv", "data_pose.csv", "data_position.csv"}) {
    const fs::path path = folder / name;
    if (!MayExist(path.string())) {
      continue;
    }
    Result<Trajectory> truth = ReadTrajectory(path.string());
    ALIDADE_RETURN_IF_ERROR(truth.status());
    dataset->truth = std::move(truth).value();
    dataset->truth_path = path.string();
    return Status::Ok();
  }
  if (MayBeFolder(folder.string())) {
    return Status::Input(folder.string() +
                         ": expected data.csv, data_pose.csv or data_position.csv; found none");
  }
  return Status::Ok();
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

Status ReadTruthFolder(const std::string& mav, Dataset* dataset) {
  ALIDADE_RETURN_IF_ERROR(ReadOneTruth(fs::path(mav) / "state_groundtruth_estimate0", dataset));
  const fs::path tum_vi = fs::path(mav) / "mocap0";
  return dataset->truth ? Status::Ok() : ReadOneTruth(tum_vi, dataset);
}

Status WriteTruthFolder(const Dataset& dataset, const std::string& mav) {
  if (!dataset.truth.has_value()) {
    return Status::Ok();
  }
  const char* name = dataset.truth->has_velocity      ? "data.csv"
                     : dataset.truth->has_orientation ? "data_pose.csv"
                                                      : "data_position.csv";
  const std::string path = (fs::path(mav) / "state_groundtruth_estimate0" / name).string();
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
  findings->Fact(Format("truth: covers %.1f %% of the IMU's time, path %.2f m%s%s", 100 * covered, path,
                        dataset.truth->has_velocity ? ", with velocity and biases" : ", poses only",
                        dataset.truth->has_covariance ? ", with covariances" : ""));
  if (covered < 0.5) {
    findings->Warning(Format("truth: covers only %.1f %% of the IMU's time", 100 * covered));
  }
}

}  // namespace alidade
