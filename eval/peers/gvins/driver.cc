// Runs GVINS on a sequence: alidade_gvins --dataset=SEQ --output=DIR [--flag=value ...]; docs/arena.md.

#include <cstdio>

#include "eval/peers/gvins/system.h"
#include "eval/peers/lens_check.h"
#include "eval/peers/peer_flags.h"
#include "eval/peers/peer_summary.h"

namespace alidade::gvins {
namespace {

const std::map<std::string, std::string>& Defaults() {
  // "own": what GVINS publishes for its own sensor.
  static const std::map<std::string, std::string> kDefaults = {
      {"dataset", "required"},  // a folder or a bag
      {"output", "required"},   // a folder
      {"input", "auto"},        // tracks | images | auto: tracks where there are some
      {"gnss", "yes"},          // no: without
      {"noise_scale", "1"},     // of the sheet's white noise; own: its published noise
      {"gravity", "9.81"},      // [m/s^2]
      {"rate", "own"},          // images a second that its tracker hands over, at most [Hz]
      {"features", "own"},      // of its front end
      {"iterations", "own"},    // of its solver
      {"real_time", "no"},      // yes: its limits of wall time end a solve too; results depend on the machine
      {"elevation", "own"},     // of satellites, once aligned, at least [deg]
      {"tracked_epochs", "own"},  // of a satellite, before it is used
      {"calibrate", "no"},        // yes: extrinsics and time offset, online
  };
  return kDefaults;
}

Status ReadSettings(const PeerFlags& flags, const Dataset& dataset, SystemSettings* settings) {
  double scale = 0;
  ALIDADE_RETURN_IF_ERROR(flags.Real("noise_scale", 0.1, 1000, &scale));
  if (scale > 0) {
    SetVinsNoise(dataset.rig.imu_noise, scale, dataset.imu_rate_hz, &settings->solver);
  }
  ALIDADE_RETURN_IF_ERROR(flags.Real("gravity", 9, 10, &settings->solver.gravity_mps2));
  ALIDADE_RETURN_IF_ERROR(flags.Whole("iterations", 1, 1000, &settings->solver.max_iterations));
  ALIDADE_RETURN_IF_ERROR(flags.OneOf("real_time", "yes", "no", &settings->solver.real_time));
  ALIDADE_RETURN_IF_ERROR(flags.OneOf("calibrate", "yes", "no", &settings->solver.calibrate_extrinsics));
  settings->solver.calibrate_time_offset = settings->solver.calibrate_extrinsics;
  ALIDADE_RETURN_IF_ERROR(flags.Real("rate", 1, 1000, &settings->rate_hz));
  ALIDADE_RETURN_IF_ERROR(flags.OneOf("gnss", "yes", "no", &settings->gnss.enabled));
  ALIDADE_RETURN_IF_ERROR(flags.Real("elevation", 0, 90, &settings->gnss.elevation_deg));
  return flags.Whole("tracked_epochs", 0, 1000, &settings->gnss.min_tracked_epochs);
}

Result<std::unique_ptr<vins::Tracker>> MakeTracker(const PeerFlags& flags, const CameraModel& camera) {
  vins::TrackerSettings settings;
  ALIDADE_RETURN_IF_ERROR(flags.Whole("features", 1, 1000, &settings.max_features));
  Result<std::unique_ptr<vins::Tracker>> made = vins::Tracker::Create(camera, settings);
  ALIDADE_RETURN_IF_ERROR(made.status());
  ALIDADE_RETURN_IF_ERROR(
      CheckLens(camera, [&](const Eigen::Vector2d& pixel) { return (*made)->Ray(pixel); }));
  return made;
}

Status Execute(const std::vector<std::string>& arguments) {
  const Result<PeerFlags> flags = PeerFlags::Parse(Defaults(), arguments);
  ALIDADE_RETURN_IF_ERROR(flags.status());
  const Result<PeerSequence> sequence = ReadPeerSequence(flags->Text("dataset"), flags->Text("input"));
  ALIDADE_RETURN_IF_ERROR(sequence.status());
  SystemSettings settings;
  ALIDADE_RETURN_IF_ERROR(ReadSettings(*flags, sequence->dataset, &settings));
  const Result<PeerGnss> gnss = settings.gnss.enabled ? ReadPeerGnss(sequence->dataset) : PeerGnss{};
  ALIDADE_RETURN_IF_ERROR(gnss.status());
  if (settings.gnss.enabled && gnss->epochs.empty()) {
    return Status::Input(flags->Text("dataset") + ": has no GNSS; GVINS waits for it, unless --gnss=no");
  }
  std::unique_ptr<vins::Tracker> tracker;
  if (!sequence->from_tracks) {
    Result<std::unique_ptr<vins::Tracker>> made = MakeTracker(*flags, sequence->dataset.rig.camera);
    ALIDADE_RETURN_IF_ERROR(made.status());
    tracker = std::move(*made);
  }
  System system(*sequence, *gnss, settings, std::move(tracker));
  const Result<PeerRun> run = system.Run();
  ALIDADE_RETURN_IF_ERROR(run.status());
  std::printf("%d messages and satellites of GNSS cannot be weighed\n", gnss->unweighable);
  std::printf("%d starts\n", system.starts());
  std::printf("%s", SummaryText(*sequence, *run, system.aligned_ns()).c_str());
  return WritePeerRun(*run, flags->Text("output"));
}

}  // namespace
}  // namespace alidade::gvins

int main(int argc, char** argv) {
  return alidade::RunDriver("alidade_gvins", argc, argv, alidade::gvins::Execute);
}
