#include "eval/compare/external_cell.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "eval/bag/bag_export.h"
#include "eval/bag/bag_import.h"
#include "eval/dataset/dataset_reader.h"
#include "eval/dataset/dataset_writer.h"
#include "eval/files/input_file.h"
#include "eval/files/output_file.h"
#include "eval/trajectory/external_trajectory.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

using Values = std::map<std::string, std::string>;

constexpr char kTimes[] = "timing.csv";
constexpr char kRecord[] = "external.json";  // of a command that succeeded

ExternalContext ContextOf(const ExternalCell& cell) {
  ExternalContext context;
  const GnssReceiver& receiver = cell.log.rig.gnss;
  context.anchor_E = receiver.anchor_E;
  context.gnss_time_offset_s = receiver.time_offset_s;
  const TimeNs offset_ns = SecondsToNs(cell.log.rig.camera_time_offset_s);
  for (const TrackFrame& frame : cell.log.frames) {
    context.camera_stamps.push_back(frame.stamp_ns + offset_ns);
  }
  if (cell.estimator.camera_frame) {
    context.T_BC = cell.log.rig.T_BC;
  }
  return context;
}

Dataset InputOf(const ExternalCell& cell) {
  Dataset dataset = DatasetOf(cell.log);
  if (cell.truth != nullptr) {
    dataset.truth = *cell.truth;
  }
  return dataset;
}

/// The input as a folder, and as a bag when the command asks for one.
Status PrepareInput(const ExternalCell& cell, const fs::path& output, Values* values) {
  const bool simulated = cell.sequence.dataset.path.empty();
  const std::string dataset =
      simulated ? (output / "dataset").string() : fs::absolute(cell.sequence.dataset.path).string();
  if (simulated) {
    ALIDADE_RETURN_IF_ERROR(WriteDataset(InputOf(cell), dataset));
  }
  (*values)["dataset"] = dataset;
  (*values)["bag"] = (output / "dataset.bag").string();
  if (IsBag(dataset)) {
    (*values)["bag"] = dataset;
  } else if (cell.estimator.command.text.find("{bag}") != std::string::npos) {
    DatasetSource source = cell.sequence.dataset;
    source.path = dataset;
    const Result<Dataset> read = ReadDataset(source);
    ALIDADE_RETURN_IF_ERROR(read.status());
    ALIDADE_RETURN_IF_ERROR(WriteBag(*read, {}, (*values)["bag"]));
  }
  return Status::Ok();
}

/// Of the placeholders, but for those of the input.
Values ValuesOf(const ExternalCell& cell, const fs::path& output) {
  Values values = {{"output", output.string()},
                   {"sequence", cell.sequence.name},
                   {"seed", std::to_string(cell.seed)},
                   {"dataset", ""},
                   {"bag", ""}};
  if (!cell.estimator.command.program.empty()) {
    values["program"] = fs::absolute(cell.estimator.command.program).string();
  }
  return values;
}

/// The texts of an object, nothing of what is none.
Values TextsOf(const nlohmann::json& object) {
  Values texts;
  for (const auto& [key, value] : object.items()) {
    if (value.is_string()) {
      texts[key] = value.get<std::string>();
    }
  }
  return texts;
}

/// Whether a program stands where it stood, or where it stood beside the output: all may have been moved.
bool IsSameProgram(const Values& now, const Values& before) {
  if (!now.contains("program") || !before.contains("program") || !before.contains("output")) {
    return false;
  }
  const fs::path program = fs::path(now.at("program")).lexically_normal();
  const fs::path program_before = fs::path(before.at("program")).lexically_normal();
  return program == program_before ||
         program.lexically_relative(fs::path(now.at("output")).lexically_normal()) ==
             program_before.lexically_relative(fs::path(before.at("output")).lexically_normal());
}

/// Whether external.json is that of this cell's command. Folders may stand elsewhere now; the input is known
/// by its digest.
bool IsOfCommand(const ExternalCell& cell, const fs::path& output, const nlohmann::json& json) {
  const Values recorded = TextsOf(json);
  const Values before = json.contains("values") ? TextsOf(json["values"]) : Values();
  Values now = ValuesOf(cell, output);
  const bool same_program = IsSameProgram(now, before);
  for (const auto& [key, value] : before) {
    if (key == "output" || key == "dataset" || key == "bag" || (key == "program" && same_program)) {
      now[key] = value;
    }
  }
  const Result<std::string> filled = FillCommand(cell.estimator.command.text, now);
  const Values expected = {{"command", cell.estimator.command.text},
                           {"filled", filled.ok() ? *filled : ""},
                           {"result", cell.estimator.command.result},
                           {"dataset_digest", cell.dataset_digest}};
  return filled.ok() && std::includes(recorded.begin(), recorded.end(), expected.begin(), expected.end());
}

/// The times of an earlier run of this command on this input that left its result.
std::optional<ExternalRun> EarlierRun(const ExternalCell& cell, const fs::path& output) {
  const Result<std::string> text = ReadWholeFile((output / kRecord).string());
  const nlohmann::json json = text.ok() ? nlohmann::json::parse(*text, nullptr, false)
                                        : nlohmann::json(nlohmann::json::value_t::discarded);
  if (!json.is_object() || !IsOfCommand(cell, output, json) ||
      !MayExist((output / cell.estimator.command.result).string())) {
    return std::nullopt;
  }
  return ExternalRun{json.value("wall_s", 0.0), json.value("cpu_s", 0.0)};
}

Result<ExternalRun> RunCommand(const ExternalCell& cell, const fs::path& output,
                               const std::atomic<bool>* stop) {
  std::error_code ignored;
  fs::create_directories(output, ignored);
  fs::remove(output / kRecord, ignored);  // first: it vouches for the others
  fs::remove(output / cell.estimator.command.result, ignored);
  fs::remove(output / kTimes, ignored);
  Values values = ValuesOf(cell, output);
  // Words are checked before anything is written.
  ALIDADE_RETURN_IF_ERROR(FillCommand(cell.estimator.command.text, values).status());
  ALIDADE_RETURN_IF_ERROR(PrepareInput(cell, output, &values));
  const Result<std::string> command = FillCommand(cell.estimator.command.text, values);
  ALIDADE_RETURN_IF_ERROR(command.status());
  Result<ExternalRun> run =
      RunExternal(*command, (output / "command.log").string(), cell.estimator.command.timeout_s, stop);
  ALIDADE_RETURN_IF_ERROR(run.status());
  const nlohmann::ordered_json json = {{"command", cell.estimator.command.text},
                                       {"filled", *command},
                                       {"values", values},
                                       {"result", cell.estimator.command.result},
                                       {"dataset_digest", cell.dataset_digest},
                                       {"wall_s", run->wall_s},
                                       {"cpu_s", run->cpu_s}};
  ALIDADE_RETURN_IF_ERROR(WriteFileAtomically((output / kRecord).string(), json.dump(2) + "\n"));
  return run;
}

}  // namespace

Result<ExternalOutcome> TrajectoryOfExternal(const ExternalCell& cell, bool resume,
                                             const std::atomic<bool>* stop) {
  ExternalOutcome outcome;
  std::string path;
  if (cell.estimator.command.text.empty()) {
    path = cell.estimator.trajectories.at(cell.sequence.name);
  } else {
    const fs::path output = fs::absolute(cell.folder);
    path = (output / cell.estimator.command.result).string();
    outcome.run = resume ? EarlierRun(cell, output) : std::nullopt;
    outcome.reused = outcome.run.has_value();
    if (!outcome.reused) {
      const Result<ExternalRun> run = RunCommand(cell, output, stop);
      ALIDADE_RETURN_IF_ERROR(run.status());
      outcome.run = *run;
    }
    if (const std::string times = (output / kTimes).string(); MayExist(times)) {
      Result<ExternalTimes> read = ReadExternalTimes(times);
      ALIDADE_RETURN_IF_ERROR(read.status());
      outcome.times = std::move(*read);
    }
  }
  ExternalContext context = ContextOf(cell);
  Result<Trajectory> trajectory = ReadExternalTrajectory(path, &context);
  ALIDADE_RETURN_IF_ERROR(trajectory.status());
  outcome.trajectory = std::move(*trajectory);
  return outcome;
}

}  // namespace alidade
