#include "eval/cli/command_line.h"

#include <algorithm>
#include <set>

#include "eval/cli/exit_code.h"
#include "eval/cli/flag_description.h"
#include "eval/cli/flags.h"
#include "eval/config/config_yaml.h"
#include "eval/files/suggest.h"

namespace alidade::cli {
namespace {

constexpr size_t kHelpColumns = 85;  ///< after which a line of the help ends

std::string WithUnderscores(std::string name) {
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

bool Contains(const std::vector<std::string>& list, const std::string& word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

bool IsSwitch(const std::string& flag) {
  gflags::CommandLineFlagInfo info;
  return gflags::GetCommandLineFlagInfo(flag.c_str(), &info) && info.type == "bool";
}

Result<const Command*> FindCommand(const std::string& name) {
  std::vector<std::string> names = {"help"};
  for (const Command& command : Commands()) {
    if (command.name == name) {
      return &command;
    }
    names.push_back(command.name);
  }
  return Status::Usage("unknown command '" + name + "'" + Suggestion(name, names) +
                       " (alidade help lists them)");
}

/// Sets the flags of one command from its words.
class FlagParser {
 public:
  FlagParser(const Command& command, const std::vector<std::string>& words)
      : command_(command), words_(words) {}

  Result<Parsed> Parse() {
    parsed_.command = &command_;
    for (next_ = 0; next_ < words_.size();) {
      const std::string& word = words_[next_++];
      if (word == "--help" || word == "-h" || word == "-help") {
        parsed_.help = true;
        return parsed_;
      }
      if (word.size() > 1 && word[0] == '-') {
        ALIDADE_RETURN_IF_ERROR(ParseFlag(word));
      } else {
        parsed_.arguments.push_back(word);
      }
    }
    if (parsed_.arguments.size() > command_.max_arguments) {
      return Usage("found '" + parsed_.arguments[command_.max_arguments] + "', expected " +
                   (command_.max_arguments == 0 ? "flags only" : "no further word"));
    }
    for (const std::string& required : command_.required) {
      if (given_.count(required) == 0) {
        return Usage("--" + required + " is missing");
      }
    }
    ALIDADE_RETURN_IF_ERROR(CheckSettingsAgree(SplitSettings(FLAGS_set)));
    return parsed_;
  }

 private:
  [[nodiscard]] Status Usage(const std::string& message) const {
    return Status::Usage(command_.name + ": " + message);
  }

  Status ParseFlag(const std::string& word) {
    const std::string body = word.substr(word[1] == '-' ? 2 : 1);
    const size_t equals = body.find('=');
    std::string name = WithUnderscores(body.substr(0, equals));
    const bool has_value = equals != std::string::npos;
    if (!has_value && name.starts_with("no") && Contains(command_.flags, name.substr(2)) &&
        IsSwitch(name.substr(2))) {
      return Set(name.substr(2), "false");
    }
    if (!Contains(command_.flags, name)) {
      std::vector<std::string> known;
      for (const std::string& flag : command_.flags) {
        known.push_back("--" + flag);
      }
      return Usage("unknown flag '--" + body.substr(0, equals) + "'" + Suggestion("--" + name, known) +
                   " (alidade " + command_.name + " --help lists them)");
    }
    if (has_value) {
      return Set(name, body.substr(equals + 1));
    }
    if (IsSwitch(name)) {
      return Set(name, "true");
    }
    if (next_ >= words_.size()) {
      return Usage("--" + name + ": found no value, expected --" + name + "=VALUE");
    }
    return Set(name, words_[next_++]);
  }

  Status Set(const std::string& name, std::string value) {
    gflags::CommandLineFlagInfo info;
    gflags::GetCommandLineFlagInfo(name.c_str(), &info);
    if (!given_.insert(name).second) {
      if (name != "set") {
        return Usage("--" + name + ": given twice, expected once");
      }
      value = info.current_value + "," + value;
    }
    // gflags reads "-1" as an unsigned number and blanks as part of one.
    const bool negative = info.type == "uint32" && value.starts_with('-');
    if (negative || gflags::SetCommandLineOption(name.c_str(), value.c_str()).empty()) {
      return Usage("--" + name + ": found '" + value + "', expected a value of type " + info.type);
    }
    return Status::Ok();
  }

  const Command& command_;
  const std::vector<std::string>& words_;
  size_t next_ = 0;
  std::set<std::string> given_;
  Parsed parsed_;
};

std::string Padded(const std::string& text, size_t width) {
  return text + std::string(width - std::min(width, text.size()), ' ');
}

}  // namespace

Result<Parsed> ParseCommandLine(const std::vector<std::string>& words) {
  if (words.empty()) {
    return Status::Usage("no command\n\n" + GeneralHelp());
  }
  if (words[0] == "help" || words[0] == "--help" || words[0] == "-h" || words[0] == "-help") {
    Parsed parsed;
    parsed.help = true;
    if (words.size() > 1 && words[1] != "help") {
      const Result<const Command*> command = FindCommand(words[1]);
      if (!command.ok()) {
        return command.status();
      }
      parsed.command = *command;
    }
    return parsed;
  }
  const Result<const Command*> command = FindCommand(words[0]);
  if (!command.ok()) {
    return command.status();
  }
  return FlagParser(**command, {words.begin() + 1, words.end()}).Parse();
}

std::string GeneralHelp() {
  std::string text = "Usage: alidade <command> [--flag=value ...]\n\nCommands:\n";
  size_t widest = 0;
  for (const Command& command : Commands()) {
    widest = std::max(widest, command.name.size());
  }
  for (const Command& command : Commands()) {
    text += "  " + Padded(command.name, widest + 2) + command.summary + "\n";
  }
  text +=
      "  " + Padded("help", widest + 2) + "print this text; `alidade <command> --help`: flags of a command\n";
  text += "\nExit codes:";
  size_t line_start = text.size();
  for (const ExitCode& exit : ExitCodes()) {
    const bool is_full = text.size() - line_start > kHelpColumns;
    line_start = is_full ? text.size() : line_start;
    text += (is_full ? "\n" : " ") + std::to_string(exit.code) + " " + exit.meaning +
            (&exit == &ExitCodes().back() ? ".\n" : ";");
  }
  return text;
}

std::string CommandHelp(const Command& command) {
  std::string text = "alidade " + command.name + ": " + command.summary + "\n\nExample:\n  alidade " +
                     command.example + "\n\nFlags:\n";
  size_t widest = 0;
  for (const std::string& name : command.flags) {
    widest = std::max(widest, name.size());
  }
  for (const std::string& name : command.flags) {
    const FlagDescription flag = DescribeFlag(command, name);
    const std::string fallback = flag.type == "string" ? "\"" + flag.fallback + "\"" : flag.fallback;
    text += "  --" + Padded(flag.name, widest + 2) + flag.text + " (" + flag.type + ", " +
            (flag.required ? std::string("required") : "default " + fallback) + ")\n";
  }
  return text;
}

}  // namespace alidade::cli
