#include "eval/metrics/evaluate.h"

#include <charconv>
#include <cstdio>

#include "core/format.h"
#include "eval/cli/commands.h"
#include "eval/cli/exit_code.h"
#include "eval/cli/flags.h"
#include "eval/cli/split_words.h"
#include "eval/cli/support.h"
#include "eval/metrics/evaluate_format.h"
#include "eval/metrics/evaluation_export.h"
#include "eval/trajectory/external_trajectory.h"

namespace alidade::cli {
namespace {

Result<EvaluationOptions> OptionsFromFlags() {
  EvaluationOptions options;
  const std::optional<Alignment> alignment = ParseAlignment(FLAGS_align);
  if (!alignment) {
    return Status::Usage("evaluate: --align: found '" + FLAGS_align +
                         "', expected none, pos, posyaw, se3 or sim3");
  }
  options.alignment = *alignment;
  if (!(FLAGS_align_share > 0 && FLAGS_align_share <= 1)) {
    return Status::Usage(
        Format("evaluate: --align_share: found %g, expected above 0 and at most 1", FLAGS_align_share));
  }
  options.align_share = FLAGS_align_share;
  options.anchor_at_first = FLAGS_anchor_at_first;
  options.association.max_dt_s = FLAGS_max_dt;
  options.association.interpolate = FLAGS_interpolate;
  options.rpe_distances_m.clear();
  for (const std::string& word : SplitWords(FLAGS_rpe)) {
    double distance = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), distance);
    if (error != std::errc() || end != word.data() + word.size() || !(distance > 0 && distance < 1e9)) {
      return Status::Usage("evaluate: --rpe: found '" + word +
                           "', expected distances in metres, separated by commas");
    }
    options.rpe_distances_m.push_back(distance);
  }
  return options;
}

}  // namespace

int RunEvaluate(const std::vector<std::string>&) {
  const Result<EvaluationOptions> options = OptionsFromFlags();
  if (!options.ok()) {
    return Report(options.status());
  }
  ExternalContext context;  // positions of both files are then in ENU at the truth's first
  const Result<Trajectory> truth = ReadExternalTrajectory(FLAGS_truth, &context);
  if (!truth.ok()) {
    return Report(truth.status());
  }
  const Result<Trajectory> estimate = ReadExternalTrajectory(FLAGS_estimate, &context);
  if (!estimate.ok()) {
    return Report(estimate.status());
  }
  const Result<Evaluation> evaluation = Evaluate(*truth, *estimate, *options);
  if (!evaluation.ok()) {
    return Report(evaluation.status());
  }
  if (!FLAGS_export.empty()) {
    const Status written = WriteForOtherTools(*truth, *estimate, options->alignment, FLAGS_export);
    if (!written.ok()) {
      return Report(written);
    }
  }
  std::fputs((FLAGS_json ? FormatEvaluationJson(*evaluation) : FormatEvaluationText(*evaluation)).c_str(),
             stdout);
  return kExitDone;
}

}  // namespace alidade::cli
