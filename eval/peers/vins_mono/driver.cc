// Runs VINS-Mono on a sequence: alidade_vins_mono --dataset=SEQ --output=DIR [--flag=value ...];
// docs/arena.md.

#include <cstdio>

#include "eval/peers/lens_check.h"
#include "eval/peers/peer_flags.h"
#include "eval/peers/vins_mono/system.h"

namespace alidade::vins_mono {
namespace {

const std::map<std::string, std::string>& Defaults() {
  // "own": what VINS-Mono publishes for EuRoC.
  static const std::map<std::string, std::string> kDefaults = {
      {"dataset", "required"},  // a folder or a bag
      {"output", "required"},   // a folder
      {"input", "auto"},        // tracks | images | auto: tracks where there are some
      {"noise_scale", "1"},     // of the sheet's white noise; own: its published noise
      {"gravity", "9.81"},      // [m/s^2]
      {"rate", "own"},          // images a second that reach the solver, at most [Hz]
      {"features", "own"},      // of its front end
      {"iterations", "own"},    // of its solver
      {"real_time", "no"},      // yes: its limits of wall time end a solve too; results depend on the machine
      {"calibrate", "no"},      // yes: extrinsics and time offset, online
  };
  return kDefaults;
}

Status ReadSolverSettings(const PeerFlags& flags, const Dataset& dataset, VinsSettings* settings) {
  double scale = 0;
  ALIDADE_RETURN_IF_ERROR(flags.Real("noise_scale", 0.1, 1000, &scale));
  if (scale > 0) {
    SetVinsNoise(dataset.rig.imu_noise, scale, dataset.imu_rate_hz, settings);
  }
  ALIDADE_RETURN_IF_ERROR(flags.Real("gravity", 9, 10, &settings->gravity_mps2));
  ALIDADE_RETURN_IF_ERROR(flags.Whole("iterations", 1, 1000, &settings->max_iterations));
  ALIDADE_RETURN_IF_ERROR(flags.OneOf("real_time", "yes", "no", &settings->real_time));
  ALIDADE_RETURN_IF_ERROR(flags.OneOf("calibrate", "yes", "no", &settings->calibrate_extrinsics));
  settings->calibrate_time_offset = settings->calibrate_extrinsics;
  return Status::Ok();
}

Status Execute(const std::vector<std::string>& arguments) {
  const Result<PeerFlags> flags = PeerFlags::Parse(Defaults(), arguments);
  ALIDADE_RETURN_IF_ERROR(flags.status());
  const Result<PeerSequence> sequence = ReadPeerSequence(flags->Text("dataset"), flags->Text("input"));
  ALIDADE_RETURN_IF_ERROR(sequence.status());
  VinsSettings settings;
  ALIDADE_RETURN_IF_ERROR(ReadSolverSettings(*flags, sequence->dataset, &settings));
  double rate_hz = 10;
  ALIDADE_RETURN_IF_ERROR(flags->Real("rate", 1, 1000, &rate_hz));
  vins::TrackerSettings tracker_settings;
  ALIDADE_RETURN_IF_ERROR(flags->Whole("features", 1, 1000, &tracker_settings.max_features));
  std::unique_ptr<vins::Tracker> tracker;
  if (!sequence->from_tracks) {
    Result<std::unique_ptr<vins::Tracker>> made =
        vins::Tracker::Create(sequence->dataset.rig.camera, tracker_settings);
    ALIDADE_RETURN_IF_ERROR(made.status());
    tracker = std::move(*made);
    ALIDADE_RETURN_IF_ERROR(CheckLens(sequence->dataset.rig.camera,
                                      [&](const Eigen::Vector2d& pixel) { return tracker->Ray(pixel); }));
  }
  System system(*sequence, settings, rate_hz, std::move(tracker));
  const Result<PeerRun> run = system.Run();
  ALIDADE_RETURN_IF_ERROR(run.status());
  std::printf("%zu poses, %d starts\n", run->trajectory.points.size(), system.starts());
  return WritePeerRun(*run, flags->Text("output"));
}

}  // namespace
}  // namespace alidade::vins_mono

int main(int argc, char** argv) {
  return alidade::RunDriver("alidade_vins_mono", argc, argv, alidade::vins_mono::Execute);
}
