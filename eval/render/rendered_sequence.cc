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
#include "eval/files/csv_text.h"
#include "eval/files/output_file.h"
#include "eval/files/parallel_for.h"
#include "eval/render/hall_file.h"
#include "eval/render/hall_variety.h"

namespace alidade {
namespace {

Status Stopped(const PipelineOptions& options) {
  return options.stop != nullptr && options.stop->load() ? Status::Diverged("interrupted") : Status::Ok();
}

std::string ExposureCsv(const RenderedSequence& sequence) {
  std::string text = "#timestamp [ns],exposure_s [s],gain [-]\n";
  for (std::size_t i = 0; i < sequence.stamps().size(); ++i) {
    const Exposure& exposure = sequence.exposures()[i];
    text +=
        JoinCsv({std::to_string(sequence.stamps()[i]), CsvNumber(exposure.time_s), CsvNumber(exposure.gain)});
  }
  return text;
}

}  // namespace

Result<RenderedSequence> RenderedSequence::Create(const SimulatorConfig& config, const Simulation& simulation,
                                                  unsigned seed) {
  Result<Hall> hall = MakeHall(config, *simulation.motion, seed);
  ALIDADE_RETURN_IF_ERROR(hall.status());
  ThrowMovingBoxes(config, *simulation.motion, seed, &*hall);
  VaryTextures(config.render, seed, &*hall);
  hall->epoch_ns = simulation.motion_start_ns - SecondsToNs(simulation.dataset.rig.camera_time_offset_s);
  return RenderedSequence(config, simulation, std::move(*hall), seed);
}

RenderedSequence::RenderedSequence(const SimulatorConfig& config, const Simulation& simulation, Hall hall,
                                   unsigned seed)
    : config_(config.render),
      motion_(simulation.motion),
      motion_start_ns_(simulation.motion_start_ns),
      rig_(simulation.dataset.rig),
      stamps_(simulation.dataset.camera_stamps),
      fault_(config, simulation.dataset.imu.front().stamp_ns, stamps_),
      renderer_(rig_.camera, config_, rig_.line_delay_s, std::move(hall), seed) {
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
  if (config_.auto_exposure) {
    std::vector<double> scene_grey;
    for (std::size_t i = 0; i < stamps_.size(); ++i) {
      scene_grey.push_back(renderer_.Meter(ShotOf(i)));
    }
    exposures_ = ControlExposure(config_, scene_grey);
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
  const double readout_s = std::abs(rig_.line_delay_s) * rig_.camera.height_px();
  const int half = readout_s > 0 ? kPosesOfRows / 2 : 0;
  for (std::size_t i = 0; i < stamps_.size(); ++i) {
    for (int k = -half; k <= half; ++k) {
      const TimeNs after_ns = half > 0 ? SecondsToNs(0.5 * readout_s * k / half) : 0;
      const Pose T_WC = CameraPose(MiddleOfExposure(i) + SecondsBetween(0, after_ns));
      TrajectoryPoint point;
      point.stamp_ns = stamps_[i] + after_ns;
      point.nav.R_WB = T_WC.rotation;
      point.nav.p_WB = T_WC.translation;
      poses.points.push_back(point);
    }
  }
  return poses;
}

double RenderedSequence::LightAt(double time_s) const {
  const double phase = 2 * std::numbers::pi * time_s / config_.brightness_period_s;
  return (1 + config_.brightness_swing * std::sin(phase)) * renderer_.light().StepAt(time_s);
}

Shot RenderedSequence::ShotOf(std::size_t index) const {
  Shot shot;
  shot.T_WC = [this](double time_s) { return CameraPose(time_s); };
  shot.middle_s = MiddleOfExposure(index);
  shot.exposure = {.time_s = config_.exposure_s, .gain = config_.gain};
  shot.light = LightAt(shot.middle_s);
  shot.frame = index;
  fault_.Apply(stamps_[index], &shot);
  return shot;
}

GreyImage RenderedSequence::Frame(std::size_t index) const {
  const std::size_t shown = fault_.Shown(index);
  Shot shot = ShotOf(shown);
  if (!exposures_.empty()) {
    shot.exposure = exposures_[shown];
    shot.light *= shot.exposure.time_s / config_.exposure_s;
  }
  return renderer_.Render(shot);
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
  if (!sequence.exposures().empty()) {
    ALIDADE_RETURN_IF_ERROR(WriteFileAtomically(camera + "/exposure.csv", ExposureCsv(sequence)));
  }
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
