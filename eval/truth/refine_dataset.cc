#include "eval/truth/refine_dataset.h"

#include <unistd.h>

#include <filesystem>
#include <utility>

#include "eval/dataset/dataset_imu.h"
#include "eval/dataset/dataset_truth.h"
#include "eval/files/input_file.h"
#include "eval/files/lies_in.h"
#include "eval/trajectory/trajectory_point.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

std::vector<TruthPose> PosesAtRate(const Trajectory& truth, double rate_hz) {
  std::vector<TruthPose> poses;
  // Poses a little less than a period apart are taken too: rates seldom divide each other.
  const double period_s = rate_hz > 0 ? 0.999 / rate_hz : 0;
  for (const TrajectoryPoint& point : truth.points) {
    if (poses.empty() || SecondsBetween(poses.back().stamp_ns, point.stamp_ns) >= period_s) {
      poses.push_back({point.stamp_ns, point.nav.T_WB()});
    }
  }
  return poses;
}

Status In(const fs::path& path, const std::error_code& error) {
  return Status::Output(path.string() + ": cannot be written: " + error.message());
}

Result<std::vector<fs::path>> EntriesOf(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> entries;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    entries.push_back(it->path());
  }
  return error ? Status::Input(folder.string() + ": cannot be read: " + error.message())
               : Result<std::vector<fs::path>>(std::move(entries));
}

/// `entry` under the name `target`, a folder (images) as a link. The copy is complete before it takes the
/// name, so that what stood there is lost to nothing but its replacement.
Status CopyEntry(const fs::path& entry, const fs::path& target) {
  // A name that RemoveTemporaryFiles recognises.
  const fs::path temporary = target.string() + ".tmp" + std::to_string(::getpid()) + "_0";
  std::error_code error;
  std::error_code ignored;
  fs::remove(temporary, ignored);
  const fs::path source = fs::canonical(entry, error);
  if (!error && fs::is_directory(source, ignored)) {
    fs::create_directory_symlink(source, temporary, error);
  } else if (!error) {
    fs::copy_file(source, temporary, error);
  }
  if (!error && fs::symlink_status(target, ignored).type() == fs::file_type::directory) {
    fs::remove_all(target, error);  // rename does not replace a folder
  }
  if (!error) {
    fs::rename(temporary, target, error);
  }
  if (error) {
    fs::remove(temporary, ignored);
    return In(target, error);
  }
  return Status::Ok();
}

/// A sensor's folder: its files, and its folders (images) as links.
Status CopySensor(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::create_directories(to, error);
  if (error) {
    return In(to, error);
  }
  const Result<std::vector<fs::path>> entries = EntriesOf(from);
  ALIDADE_RETURN_IF_ERROR(entries.status());
  for (const fs::path& entry : *entries) {
    ALIDADE_RETURN_IF_ERROR(CopyEntry(entry, to / entry.filename()));
  }
  return Status::Ok();
}

}  // namespace

Result<RefinedTruth> RefineDataset(const Dataset& dataset, const RefineOptions& options) {
  if (!dataset.truth || !dataset.truth->has_orientation) {
    return Status::Input("refine_truth: " + dataset.path +
                         (dataset.truth ? ": a truth without orientation" : ": no truth") +
                         ", expected poses in state_groundtruth_estimate0 or a file named by --truth");
  }
  if (options.imu.noise != ImuNoiseModel::kSheet) {
    return Status::Usage(
        "refine_truth: imu.noise: found adaptive, expected sheet (imu.noise_scale multiplies it)");
  }
  TruthRefinementOptions refinement;
  refinement.imu_noise = options.imu.Scaled(dataset.rig.imu_noise);
  refinement.gravity_mps2 = options.imu.gravity_mps2;
  refinement.imu_scale = options.imu_scale;
  refinement.noise = options.noise;
  refinement.stop = options.stop;
  return RefineTruth(dataset.imu, PosesAtRate(*dataset.truth, options.truth_rate_hz), refinement);
}

Trajectory TruthOf(const RefinedTruth& refined) {
  Trajectory truth;
  truth.has_velocity = truth.has_bias = truth.has_covariance = true;
  truth.points.reserve(refined.states.size());
  for (const NavEstimate& state : refined.states) {
    truth.points.push_back(PointOf(state));
  }
  return truth;
}

Status CheckRefinedOutput(const std::string& dataset, const std::string& output) {
  const fs::path from = fs::path(dataset) / "mav0";
  const fs::path to = fs::path(output) / "mav0";
  const Result<std::vector<fs::path>> entries = EntriesOf(from);
  ALIDADE_RETURN_IF_ERROR(entries.status());
  bool shared = LiesIn(to, from) || LiesIn(from, to);
  for (const fs::path& entry : *entries) {
    if (!MayBeFolder(entry.string())) {
      continue;
    }
    const fs::path target = to / entry.filename();
    shared = shared || LiesIn(target, entry) || LiesIn(entry, target);
  }
  return shared
             ? Status::Usage("refine_truth: --output: found " + output +
                             ", which shares files with the dataset " + dataset + ", expected another folder")
             : Status::Ok();
}

Status WriteRefined(const Dataset& dataset, const RefinedTruth& refined, const std::string& output) {
  ALIDADE_RETURN_IF_ERROR(CheckRefinedOutput(dataset.path, output));
  const fs::path to = fs::path(output) / "mav0";
  const Result<std::vector<fs::path>> entries = EntriesOf(fs::path(dataset.path) / "mav0");
  ALIDADE_RETURN_IF_ERROR(entries.status());
  for (const fs::path& entry : *entries) {
    const std::string name = entry.filename().string();
    if (MayBeFolder(entry.string()) && name != "state_groundtruth_estimate0" && name != "mocap0") {
      ALIDADE_RETURN_IF_ERROR(CopySensor(entry, to / name));
    }
  }
  Dataset with_truth;
  with_truth.truth = TruthOf(refined);
  ALIDADE_RETURN_IF_ERROR(WriteTruthFolder(with_truth, to.string()));
  if (refined.imu_scale_std.isZero(0)) {
    return Status::Ok();
  }
  with_truth.rig = dataset.rig;
  with_truth.imu_rate_hz = dataset.imu_rate_hz;
  for (const ImuSample& sample : dataset.imu) {
    with_truth.imu.push_back(refined.imu_scale.Applied(sample));
  }
  return WriteImuFolder(with_truth, to.string());
}

}  // namespace alidade
