#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/status.h"

namespace alidade::cli {

/// What a configuration file describes; the shipped ones of a kind lie in one folder.
enum class ConfigKind { kEstimator, kSimulator, kPlan };

/// estimator | simulator | plan
[[nodiscard]] std::optional<ConfigKind> ParseConfigKind(std::string_view name);
[[nodiscard]] std::string_view ToString(ConfigKind kind);

/// The shipped configurations: `configs` below $ALIDADE_DATA_DIR when that is set, otherwise below the data
/// folder of the tree in which the program is installed, otherwise beside the build folder in which the
/// program lies. Error (kConfig): there is none; the message names where it was looked for.
Result<std::string> ShippedConfigsFolder();

/// Names of the shipped configurations of a kind, without ".yaml", sorted. Errors: ShippedConfigsFolder's.
Result<std::vector<std::string>> ShippedConfigs(ConfigKind kind);

/// The file that a word of the command line means: a file that exists; or else `configs/...`, or a name with
/// or without ".yaml", among the shipped ones. A word that looks like a path is returned as it is if nothing
/// is found: its reader reports what is wrong with it. Error (kConfig): a name that is neither, with a
/// suggestion; ShippedConfigsFolder's.
Result<std::string> LocateConfig(ConfigKind kind, const std::string& text);

}  // namespace alidade::cli
