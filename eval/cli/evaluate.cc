#include "eval/metrics/evaluate.h"

#include <charconv>
#include <cstdio>

#include "core/format.h"
#include "eval/cli/commands.h"
#include "eval/cli/exit_code.h"
#include "eval/cli/flag_description.h"
#include "eval/cli/flags.h"
#include "eval/cli/split_words.h"
#include "eval/cli/support.h"
#include "eval/metrics/evaluate_format.h"
#include "eval/metrics/evaluation_export.h"
#include "eval/trajectory/external_trajectory.h"

namespace alidade::cli {
namespace {

bool IsGiven(const char* flag) {
  return !gflags::GetCommandLineFlagInfoOrDie(flag).is_default;
}

Status FillAssociation(AssociationOptions* association) {
  const std::optional<EvaluationTool> method = ParseEvaluationTool(FLAGS_association);
  if (!method) {
    return Status::Usage("evaluate: --association: found '" + FLAGS_association +
                         "', expected alidade, evo or rpg");
  }
  association->method = *method;
  association->max_dt_s = IsGiven("max_dt") ? FLAGS_max_dt : DefaultMaxDt(*method);
  association->time_offset_s = FLAGS_time_offset;
  association->interpolate = FLAGS_interpolate;
  return Status::Ok();
}

Result<std::vector<double>> DeltasFromFlag() {
  std::vector<double> deltas;
  for (const std::string& word : SplitWords(FLAGS_rpe)) {
    double delta = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), delta);
    if (error != std::errc() || end != word.data() + word.size() || !(delta > 0 && delta < 1e9)) {
      return Status::Usage("evaluate: --rpe: found '" + word +
                           "', expected distances in metres, separated by commas");
    }
    deltas.push_back(delta);
  }
  return deltas;
}

Status FillRpe(EvaluationOptions* options) {
  Result<std::vector<double>> deltas = DeltasFromFlag();
  if (!deltas.ok()) {
    return deltas.status();
  }
  options->rpe_distances_m = std::move(deltas).value();
  const std::optional<EvaluationTool> method = ParseEvaluationTool(FLAGS_rpe_by);
  if (!method) {
    return Status::Usage("evaluate: --rpe_by: found '" + FLAGS_rpe_by + "', expected alidade, evo or rpg");
  }
  const std::optional<RpeUnit> unit = ParseRpeUnit(FLAGS_rpe_unit);
  if (!unit) {
    return Status::Usage("evaluate: --rpe_unit: found '" + FLAGS_rpe_unit +
                         "', expected frames, m, deg or rad");
  }
  for (const char* flag : {"rpe_unit", "rpe_all_pairs", "rpe_pairs_from_truth", "rpe_tolerance"}) {
    if (*method != EvaluationTool::kEvo && IsGiven(flag)) {
      return Status::Usage(std::string("evaluate: --") + flag + ": only with --rpe_by=evo");
    }
  }
  if (!(FLAGS_rpe_tolerance >= 0 && FLAGS_rpe_tolerance < 1)) {
    return Status::Usage(
        Format("evaluate: --rpe_tolerance: found %g, expected at least 0 and below 1", FLAGS_rpe_tolerance));
  }
  ToolRpeOptions& tool = options->tool_rpe;
  tool.method = *method;
  tool.unit = *unit;
  tool.all_pairs = FLAGS_rpe_all_pairs;
  tool.pairs_from_truth = FLAGS_rpe_pairs_from_truth;
  tool.tolerance = FLAGS_rpe_tolerance;
  if (IsGiven("rpe")) {
    tool.deltas = options->rpe_distances_m;
  }
  return Status::Ok();
}

Result<EvaluationOptions> OptionsFromFlags() {
  EvaluationOptions options;
  const std::optional<TrajectoryAlignment> alignment = ParseTrajectoryAlignment(FLAGS_align);
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
  ALIDADE_RETURN_IF_ERROR(FillAssociation(&options.association));
  ALIDADE_RETURN_IF_ERROR(FillRpe(&options));
  return options;
}

/// Names the flag where the fault is of one: its name precedes the colon.
Status OfFlag(const Status& status) {
  const std::string& message = status.message();
  const size_t colon = message.find(':');
  gflags::CommandLineFlagInfo info;
  if (status.code() != StatusCode::kUsage || colon == std::string::npos ||
      !gflags::GetCommandLineFlagInfo(message.substr(0, colon).c_str(), &info)) {
    return status;
  }
  return Status::Usage("evaluate: --" + message);
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
    return Report(OfFlag(evaluation.status()));
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
