#include "eval/cli/stored_run.h"

#include "eval/cli/flags.h"
#include "eval/files/input_file.h"
#include "eval/record/recorder_reader.h"

namespace alidade::cli {

Result<std::optional<RunResult>> StoredRun(const std::string& estimator, const std::string& sequence,
                                           unsigned seed) {
  const std::string folder =
      FLAGS_input + "/cells/" + estimator + "/" + sequence + "/" + std::to_string(seed);
  if (!MayExist(folder + "/run.json")) {
    return std::optional<RunResult>();
  }
  Result<RunResult> run = ReadRun(folder);
  ALIDADE_RETURN_IF_ERROR(run.status());
  return std::optional<RunResult>(std::move(*run));
}

}  // namespace alidade::cli
