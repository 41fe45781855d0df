#include "eval/render/rendered_sequence.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numbers>
#include <utility>

#include "core/lie.h"
#include "eval/config/config_writer.h"
#include "eval/dataset/dataset_truth.h"
#include "eval/dataset/digest.h"
#include "eval/dataset/png_image.h"
#include "eval/files/output_file.h"
#include "eval/files/parallel_for.h"
#include "eval/render/hall_file.h"

namespace alidade {
namespace {

Status Stopped(const PipelineOptions& options) {
  return options.stop != nullptr && options.stop->load() ? Status::Diverged("interrupted") : Status::Ok();
}

}  // namespace

Result<RenderedSequence> RenderedSequence::Create(const SimulatorConfig& config, const Simulation& simulation,
                                                  unsigned seed) {
  Result<Hall> hall = MakeHall(config, *simulation.motion, seed);
  ALIDADE_RETURN_IF_ERROR(hall.status());
  return RenderedSequence(config, simulation, std::move(*hall), seed);
}

RenderedSequence::RenderedSequence(const SimulatorConfig& config, const Simulation& simulation, Hall hall,
                                   unsigned seed)
    : config_(config.render),
      motion_(simulation.motion),
      motion_start_ns_(simulation.motion_start_ns),
      rig_(simulation.dataset.rig),
      stamps_(simulation.dataset.camera_stamps),
      renderer_(rig_.camera, config_, std::move(hall), seed) {
  SimulatorConfig keys = config;
  fingerprint_ = ConfigToYaml([&keys](ConfigVisitor& visitor) { keys.Describe(visitor); }, false) +
                 "seed: " + std::to_string(seed) + "\n" + DigestOf({rig_, simulation.dataset.imu, {}}) + "\n";
  for (const TimeNs stamp : stamps_) {
    const NavState nav = motion_->At(SecondsBetween(motion_start_ns_, stamp)).nav;
    const Eigen::Vector3d turn = so3::Log(nav.R_WB);
    fingerprint_ += std::to_string(stamp);
    for (const double value : {nav.p_WB.x(), nav.p_WB.y(), nav.p_WB.z(), turn.x(), turn.y(), turn.z()}) {
      fingerprint_ += "," + ShortestDouble(value);
    }
    fingerprint_ += "\n";
  }
}

Pose RenderedSequence::CameraPose(double time_s) const {
  return motion_->At(time_s).nav.T_WB() * rig_.T_BC;
}

double RenderedSequence::MiddleOfExposure(std::size_t index) const {
  return SecondsBetween(motion_start_ns_, stamps_[index]) + rig_.camera_time_offset_s;
}

Trajectory RenderedSequence::CameraPoses() const {
  Trajectory poses;
  for (std::size_t i = 0; i < stamps_.size(); ++i) {
    const Pose T_WC = CameraPose(MiddleOfExposure(i));
    TrajectoryPoint point;
    point.stamp_ns = stamps_[i];
    point.nav.R_WB = T_WC.rotation;
    point.nav.p_WB = T_WC.translation;
    poses.points.push_back(point);
  }
  return poses;
}

GreyImage RenderedSequence::Frame(std::size_t index) const {
  const double time_s = MiddleOfExposure(index);
  std::vector<Pose> T_WC;
  for (int k = 0; k < config_.samples; ++k) {
    const double share = (k + 0.5) / config_.samples - 0.5;
    T_WC.push_back(CameraPose(time_s + share * config_.exposure_s));
  }
  const double phase = 2 * std::numbers::pi * time_s / config_.brightness_period_s;
  return renderer_.Render(T_WC, index, 1 + config_.brightness_swing * std::sin(phase));
}

Status WriteRenderedImages(const RenderedSequence& sequence, const std::string& path,
                           const PipelineOptions& options) {
  const std::string camera = path + "/mav0/cam0";
  const std::vector<TimeNs>& stamps = sequence.stamps();
  std::mutex mutex;
  std::size_t done = 0;
  const auto draw = [&](std::size_t i) {
    ALIDADE_RETURN_IF_ERROR(Stopped(options));
    ALIDADE_RETURN_IF_ERROR(
        WritePng(sequence.Frame(i), camera + "/data/" + std::to_string(stamps[i]) + ".png"));
    const std::lock_guard<std::mutex> lock(mutex);
    if (options.progress) {
      options.progress(++done, stamps.size());
    }
    return Status::Ok();
  };
  ALIDADE_RETURN_IF_ERROR(ParallelFor(stamps.size(), options.jobs, draw));
  ALIDADE_RETURN_IF_ERROR(WriteHall(sequence.hall(), HallPath(path)));
  ALIDADE_RETURN_IF_ERROR(WriteFileAtomically(CameraPosesPath(path), TruthCsv(sequence.CameraPoses())));
  std::string list = "#timestamp [ns],filename\n";
  for (const TimeNs stamp : stamps) {
    list += std::to_string(stamp) + "," + std::to_string(stamp) + ".png\n";
  }
  return WriteFileAtomically(camera + "/data.csv", list);
}

Result<std::vector<TrackFrame>> TrackRenderedImages(const RenderedSequence& sequence, const Dataset& dataset,
                                                    const FrontendConfig& config,
                                                    const PipelineOptions& options) {
  // Drawn in parallel a few at a time, tracked in order.
  const auto batch = static_cast<std::size_t>(std::max(1, 4 * options.jobs));
  const std::vector<TimeNs>& stamps = sequence.stamps();
  std::vector<GreyImage> images;
  std::size_t first = 0;
  const auto image_at = [&](std::size_t i) -> Result<GreyImage> {
    if (i >= first + images.size()) {
      first = i;
      images.assign(std::min(batch, stamps.size() - i), {});
      const auto draw = [&](std::size_t k) {
        images[k] = sequence.Frame(first + k);
        return Stopped(options);
      };
      ALIDADE_RETURN_IF_ERROR(ParallelFor(images.size(), options.jobs, draw));
    }
    return std::move(images[i - first]);
  };
  return TrackImages(dataset, stamps, image_at, config, options);
}

}  // namespace alidade
