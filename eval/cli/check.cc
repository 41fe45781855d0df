#include <cstdio>

#include "eval/cli/commands.h"
#include "eval/cli/exit_code.h"
#include "eval/cli/flags.h"
#include "eval/cli/support.h"
#include "eval/dataset/dataset.h"
#include "eval/dataset/dataset_check.h"

namespace alidade::cli {
namespace {

const char* Word(DatasetFinding::Severity severity) {
  switch (severity) {
    case DatasetFinding::Severity::kError:
      return "error";
    case DatasetFinding::Severity::kWarning:
      return "warning";
    case DatasetFinding::Severity::kFact:
      break;
  }
  return "fact";
}

}  // namespace

int RunCheck(const std::vector<std::string>&) {
  const Result<Dataset> dataset = ReadDatasetFromFlags();
  if (!dataset.ok()) {
    return Report(dataset.status());
  }
  bool faulty = false;
  for (const DatasetFinding& finding : CheckDataset(*dataset)) {
    std::printf("%-8s %s\n", Word(finding.severity), finding.text.c_str());
    faulty = faulty || finding.severity == DatasetFinding::Severity::kError;
  }
  return faulty ? kExitInput : kExitDone;
}

}  // namespace alidade::cli
