#include "eval/compare/compare.h"

#include <cstdio>

#include "eval/cli/commands.h"
#include "eval/cli/exit_code.h"
#include "eval/cli/flags.h"
#include "eval/cli/support.h"
#include "eval/compare/compare_options.h"
#include "eval/compare/plan_parser.h"
#include "eval/report/tables_terminal.h"

namespace alidade::cli {

int RunCompare(const std::vector<std::string>&) {
  if (FLAGS_jobs < 1 || FLAGS_jobs > 1024) {
    return Report(
        Status::Usage("compare: --jobs: found " + std::to_string(FLAGS_jobs) + ", expected 1 to 1024"));
  }
  const Result<FigureFormats> figures = ParseFigureFormats(FLAGS_figures);
  if (!figures.ok()) {
    return Report(Status(figures.code(), "compare: " + figures.message()));
  }
  const Result<Plan> plan = ReadPlan(FLAGS_plan, FLAGS_data);
  if (!plan.ok()) {
    return Report(plan.status());
  }
  if (const Status status = PrepareOutputFolder(FLAGS_output, FLAGS_overwrite || FLAGS_resume);
      !status.ok()) {
    return Report(status);
  }
  CompareOptions options;
  options.output = FLAGS_output;
  options.jobs = FLAGS_jobs;
  options.resume = FLAGS_resume;
  options.figures = *figures;
  options.command = "alidade compare --plan=" + FLAGS_plan +
                    (FLAGS_data.empty() ? "" : " --data=" + FLAGS_data) + " --output=" + FLAGS_output +
                    (FLAGS_figures.empty() ? "" : " --figures=" + FLAGS_figures);
  options.stop = InstallInterruptHandler();
  options.progress = Say;
  const Result<CompareOutcome> outcome = Compare(*plan, options);
  if (!outcome.ok()) {
    return Report(outcome.status());
  }
  if (outcome->interrupted) {
    Say("interrupted: complete cells are kept, --resume continues");
    return kExitInterrupted;
  }
  std::fputs(FormatTable(outcome->comparison).c_str(), stdout);
  Say(FLAGS_output + "/report.html");
  if (outcome->cells_failed > 0) {
    std::fprintf(stderr, "alidade: %d of %zu cells failed\n", outcome->cells_failed,
                 outcome->comparison.cells.size());
    return kExitCellsFailed;
  }
  return kExitDone;
}

}  // namespace alidade::cli
