// Runs MSCEqF on the images of a sequence: alidade_msceqf --dataset=SEQ --output=DIR [--flag=value ...];
// docs/arena.md.

#include <cstdio>
#include <exception>

#include "eval/files/output_file.h"
#include "eval/peers/msceqf/system.h"
#include "eval/peers/msceqf_file.h"
#include "eval/peers/peer_flags.h"
#include "eval/peers/peer_summary.h"

namespace alidade::msceqf_driver {
namespace {

const std::map<std::string, std::string>& Defaults() {
  // "own": what MSCEqF publishes for EuRoC.
  static const std::map<std::string, std::string> kDefaults = {
      {"dataset", "required"},      // a folder or a bag
      {"output", "required"},       // a folder
      {"noise_scale", "1"},         // of the sheet's white noise; own: its published noise
      {"pixel_noise_px", "1"},      // standard deviation
      {"gravity", "9.81"},          // [m/s^2]
      {"clones", "own"},            // poses in the window
      {"features", "own"},          // of its front end
      {"extrinsics_std", "0.001"},  // of the camera's pose, which it always estimates [rad, m]; own: 0.03
  };
  return kDefaults;
}

Status ReadSettings(const PeerFlags& flags, const ImuNoise& sheet, MsceqfSettings* settings) {
  double scale = 0;
  ALIDADE_RETURN_IF_ERROR(flags.Real("noise_scale", 0.1, 1000, &scale));
  if (scale > 0) {
    settings->gyro_noise = scale * sheet.gyro_noise_density_radps_sqrthz;
    settings->accel_noise = scale * sheet.accel_noise_density_mps2_sqrthz;
    settings->gyro_walk = sheet.gyro_random_walk_radps2_sqrthz;
    settings->accel_walk = sheet.accel_random_walk_mps3_sqrthz;
  }
  ALIDADE_RETURN_IF_ERROR(flags.Real("pixel_noise_px", 0.01, 1000, &settings->pixel_noise_px));
  ALIDADE_RETURN_IF_ERROR(flags.Real("gravity", 9, 10, &settings->gravity_mps2));
  ALIDADE_RETURN_IF_ERROR(flags.Whole("clones", 3, 200, &settings->clones));
  ALIDADE_RETURN_IF_ERROR(flags.Whole("features", 1, 1000, &settings->max_features));
  return flags.Real("extrinsics_std", 1e-9, 1, &settings->extrinsics_std);
}

Status Execute(const std::vector<std::string>& arguments) {
  const Result<PeerFlags> flags = PeerFlags::Parse(Defaults(), arguments);
  ALIDADE_RETURN_IF_ERROR(flags.status());
  const Result<PeerSequence> sequence = ReadPeerSequence(flags->Text("dataset"), "images");
  ALIDADE_RETURN_IF_ERROR(sequence.status());
  MsceqfSettings settings;
  ALIDADE_RETURN_IF_ERROR(ReadSettings(*flags, sequence->dataset.rig.imu_noise, &settings));
  const Result<std::string> text = MsceqfFile(sequence->dataset.rig, settings);
  ALIDADE_RETURN_IF_ERROR(text.status());
  const std::string file = flags->Text("output") + "/msceqf.yaml";
  ALIDADE_RETURN_IF_ERROR(WriteFileAtomically(file, *text));
  try {
    System system(file, *sequence);
    const Result<PeerRun> run = system.Run();
    ALIDADE_RETURN_IF_ERROR(run.status());
    std::printf("%s", SummaryText(*sequence, *run, std::nullopt).c_str());
    return WritePeerRun(*run, flags->Text("output"));
  } catch (const std::exception& error) {
    return Status::Input(std::string("MSCEqF: ") + error.what());
  }
}

}  // namespace
}  // namespace alidade::msceqf_driver

int main(int argc, char** argv) {
  return alidade::RunDriver("alidade_msceqf", argc, argv, alidade::msceqf_driver::Execute);
}
