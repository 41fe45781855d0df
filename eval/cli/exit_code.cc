#include "eval/cli/exit_code.h"

namespace alidade::cli {

const std::vector<ExitCode>& ExitCodes() {
  static const std::vector<ExitCode> codes = {
      {kExitDone, "done"},
      {kExitUsage, "usage"},
      {kExitConfig, "configuration"},
      {kExitInput, "input data"},
      {kExitDiverged, "an estimator diverged or never initialised"},
      {kExitOutput, "output could not be written"},
      {kExitCellsFailed, "some cells of a comparison failed"},
      {kExitImpaired,
       "the run is complete but impaired: lost in between, degraded for long, or without an enabled sensor"},
      {kExitInterrupted, "interrupted"}};
  return codes;
}

}  // namespace alidade::cli
