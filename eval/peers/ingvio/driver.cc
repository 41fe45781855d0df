// Runs InGVIO on a sequence: alidade_ingvio --dataset=SEQ --output=DIR [--flag=value ...]; docs/arena.md.

#include <cstdio>

#include "eval/peers/ingvio/system.h"
#include "eval/peers/peer_flags.h"
#include "eval/peers/peer_summary.h"

namespace alidade::ingvio {
namespace {

const std::map<std::string, std::string>& Defaults() {
  // "own": what InGVIO publishes for its own sensor.
  static const std::map<std::string, std::string> kDefaults = {
      {"dataset", "required"},    // a folder or a bag
      {"output", "required"},     // a folder
      {"input", "auto"},          // tracks | images | auto: tracks where there are some
      {"gnss", "yes"},            // no: without
      {"lens", "right"},          // own: also one that it undistorts wrongly
      {"noise_scale", "1"},       // of the sheet's white noise; own: its published noise
      {"pixel_noise_px", "own"},  // standard deviation; own: 0.18 on the normalised plane
      {"gravity", "9.81"},        // [m/s^2]
      {"clones", "own"},          // poses in the window
      {"features", "own"},        // of its front end
      {"start_samples", "own"},   // of the IMU, at rest
      {"elevation", "own"},       // of satellites, at least [deg]
      {"tracked_epochs", "own"},  // of a satellite, before it is used
      {"align_epochs", "own"},    // that its alignment takes
      {"gnss_gate", "no"},        // yes: its chi-square test of each row
      {"estimate_yaw", "no"},     // yes: of its world, once aligned
  };
  return kDefaults;
}

Status ReadSettings(const PeerFlags& flags, const RigCalibration& rig, IngvioSettings* settings) {
  double scale = 0;
  ALIDADE_RETURN_IF_ERROR(flags.Real("noise_scale", 0.1, 1000, &scale));
  if (scale > 0) {
    settings->gyro_noise = scale * rig.imu_noise.gyro_noise_density_radps_sqrthz;
    settings->accel_noise = scale * rig.imu_noise.accel_noise_density_mps2_sqrthz;
    settings->gyro_walk = rig.imu_noise.gyro_random_walk_radps2_sqrthz;
    settings->accel_walk = rig.imu_noise.accel_random_walk_mps3_sqrthz;
  }
  double pixel_noise_px = 0;
  ALIDADE_RETURN_IF_ERROR(flags.Real("pixel_noise_px", 0.01, 1000, &pixel_noise_px));
  if (pixel_noise_px > 0) {
    settings->visual_noise = pixel_noise_px / rig.camera.intrinsics()[0];
  }
  ALIDADE_RETURN_IF_ERROR(flags.Real("gravity", 9, 10, &settings->gravity_mps2));
  ALIDADE_RETURN_IF_ERROR(flags.Whole("clones", 3, 200, &settings->clones));
  ALIDADE_RETURN_IF_ERROR(flags.Whole("features", 1, 1000, &settings->max_features));
  ALIDADE_RETURN_IF_ERROR(flags.Whole("start_samples", 1, 2900, &settings->start_samples));
  ALIDADE_RETURN_IF_ERROR(flags.Real("elevation", 0, 90, &settings->elevation_deg));
  ALIDADE_RETURN_IF_ERROR(flags.Whole("tracked_epochs", 0, 1000, &settings->min_tracked_epochs));
  ALIDADE_RETURN_IF_ERROR(flags.Whole("align_epochs", 2, 1000, &settings->align_epochs));
  ALIDADE_RETURN_IF_ERROR(flags.OneOf("gnss", "yes", "no", &settings->gnss));
  ALIDADE_RETURN_IF_ERROR(flags.OneOf("gnss_gate", "yes", "no", &settings->gnss_gate));
  return flags.OneOf("estimate_yaw", "yes", "no", &settings->estimate_yaw);
}

Status Execute(const std::vector<std::string>& arguments) {
  const Result<PeerFlags> flags = PeerFlags::Parse(Defaults(), arguments);
  ALIDADE_RETURN_IF_ERROR(flags.status());
  const Result<PeerSequence> sequence = ReadPeerSequence(flags->Text("dataset"), flags->Text("input"));
  ALIDADE_RETURN_IF_ERROR(sequence.status());
  IngvioSettings settings;
  ALIDADE_RETURN_IF_ERROR(ReadSettings(*flags, sequence->dataset.rig, &settings));
  const Result<PeerGnss> gnss = settings.gnss ? ReadPeerGnss(sequence->dataset) : PeerGnss{};
  ALIDADE_RETURN_IF_ERROR(gnss.status());
  bool checks_lens = true;
  ALIDADE_RETURN_IF_ERROR(flags->OneOf("lens", "right", "own", &checks_lens));
  const Result<std::unique_ptr<System>> system =
      System::Create(*sequence, *gnss, settings, flags->Text("output"), checks_lens);
  ALIDADE_RETURN_IF_ERROR(system.status());
  const Result<PeerRun> run = (*system)->Run();
  ALIDADE_RETURN_IF_ERROR(run.status());
  std::printf("%d messages and satellites of GNSS cannot be weighed\n", gnss->unweighable);
  std::printf("%s", SummaryText(*sequence, *run, (*system)->aligned_ns()).c_str());
  return WritePeerRun(*run, flags->Text("output"));
}

}  // namespace
}  // namespace alidade::ingvio

int main(int argc, char** argv) {
  return alidade::RunDriver("alidade_ingvio", argc, argv, alidade::ingvio::Execute);
}
