#include "eval/cli/flag_description.h"

#include <algorithm>
#include <set>
#include <string>

#include "eval/cli/flags.h"
#include "eval/files/output_file.h"

namespace alidade::cli {
namespace {

/// "none | bz2 | lz4: how chunks are packed" -> none, bz2, lz4; none for a text without " | ".
std::vector<std::string> LeadingWords(const std::string& text) {
  const std::string list = text.substr(0, text.find(':'));
  const std::string separator = " | ";
  std::vector<std::string> words;
  if (list.size() == text.size() || list.find(separator) == std::string::npos) {
    return words;
  }
  for (size_t begin = 0, end = 0; end != std::string::npos; begin = end + separator.size()) {
    end = list.find(separator, begin);
    words.push_back(list.substr(begin, end == std::string::npos ? end : end - begin));
  }
  return words;
}

FlagValue ValueOf(const FlagDescription& flag) {
  static const std::set<std::string> paths = {"calibration", "catalogue", "clk",    "data",   "dataset",
                                              "estimate",    "export",    "input",  "nav",    "obs",
                                              "output",      "sp3",       "status", "tracks", "truth"};
  if (flag.type == "bool") {
    return FlagValue::kSwitch;
  }
  if (flag.type != "string") {
    return FlagValue::kNumber;
  }
  if (!flag.words.empty()) {
    return FlagValue::kWord;
  }
  if (flag.name == "config" || flag.name == "estimator" || flag.name == "plan") {
    return FlagValue::kConfig;
  }
  return paths.count(flag.name) > 0 ? FlagValue::kPath : FlagValue::kText;
}

}  // namespace

FlagDescription DescribeFlag(const Command& command, const std::string& flag) {
  gflags::CommandLineFlagInfo info;
  gflags::GetCommandLineFlagInfo(flag.c_str(), &info);
  FlagDescription description;
  description.name = flag;
  const auto text = command.texts.find(flag);
  description.text = text == command.texts.end() ? info.description : text->second;
  description.type = info.type;
  // gflags prints 17 digits.
  description.fallback =
      info.type == "double" ? ShortestDouble(std::stod(info.default_value)) : info.default_value;
  description.required =
      std::find(command.required.begin(), command.required.end(), flag) != command.required.end();
  description.words = LeadingWords(description.text);
  description.value = ValueOf(description);
  description.config = flag == "config" ? command.config
                       : flag == "plan" ? ConfigKind::kPlan
                                        : ConfigKind::kEstimator;
  return description;
}

}  // namespace alidade::cli
