// Runs OpenVINS or sqrtVINS on a sequence: alidade_open_vins --dataset=SEQ --output=DIR [--flag=value ...];
// docs/arena.md.

#include <utils/print.h>

#include "eval/peers/open_vins/settings.h"
#include "eval/peers/open_vins/system.h"
#include "eval/peers/open_vins/vio_names.h"

namespace alidade::open_vins {
namespace {

const std::map<std::string, std::string>& Defaults() {
  // "own": that of the system's file.
  static const std::map<std::string, std::string> kDefaults = {
      {"dataset", "required"},     // a folder or a bag
      {"output", "required"},      // a folder
      {"input", "auto"},           // tracks | images | auto: tracks where there are some
      {"init", "own"},             // truth: start at the truth
      {"config", "euroc_mav"},     // folder of its config/
      {"noise_scale", "1"},        // of the sheet's white noise; own: its file's noise
      {"pixel_noise_px", "1"},     // standard deviation
      {"gate", "own"},             // factor on the chi-square limit of its updates
      {"gravity", "own"},          // [m/s^2]
      {"clones", "own"},           // poses in the window
      {"slam", "own"},             // landmarks in the state, at most
      {"msckf_in_update", "own"},  // other landmarks in an update, at most
      {"features", "own"},         // of its front end
      {"calibrate", "no"},         // own: what its file calibrates online
      {"dynamic_init", "own"},     // yes | no: start while moving
  };
  return kDefaults;
}

Status Execute(const std::vector<std::string>& arguments) {
  const Result<PeerFlags> flags = PeerFlags::Parse(Defaults(), arguments);
  ALIDADE_RETURN_IF_ERROR(flags.status());
  const Result<PeerSequence> sequence = ReadPeerSequence(flags->Text("dataset"), flags->Text("input"));
  ALIDADE_RETURN_IF_ERROR(sequence.status());
  ov_core::Printer::setPrintLevel("WARNING");
  const Result<vio::VioManagerOptions> options = MakeSettings(*flags, sequence->dataset.rig);
  ALIDADE_RETURN_IF_ERROR(options.status());
  System system(*options, *sequence);
  bool from_truth = false;
  ALIDADE_RETURN_IF_ERROR(flags->OneOf("init", "truth", "own", &from_truth));
  if (from_truth) {
    ALIDADE_RETURN_IF_ERROR(system.StartFromTruth());
  }
  const Result<PeerRun> run = system.Run();
  ALIDADE_RETURN_IF_ERROR(run.status());
  return WritePeerRun(*run, flags->Text("output"));
}

}  // namespace
}  // namespace alidade::open_vins

int main(int argc, char** argv) {
  return alidade::RunDriver(alidade::open_vins::kProgram, argc, argv, alidade::open_vins::Execute);
}
