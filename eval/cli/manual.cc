#include <cstdio>

#include "eval/cli/commands.h"
#include "eval/cli/exit_code.h"
#include "eval/cli/flag_description.h"

namespace alidade::cli {
namespace {

/// Text that man shows as it is written: no character of it is a request, a hyphen stays one that can be
/// copied.
std::string Escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    const bool starts_line = escaped.empty() || escaped.back() == '\n';
    if (c == '\\') {
      escaped += "\\e";
    } else if (c == '-') {
      escaped += "\\-";
    } else if (starts_line && (c == '.' || c == '\'')) {
      escaped += std::string("\\&") + c;
    } else {
      escaped += c;
    }
  }
  return escaped;
}

std::string Bold(const std::string& text) {
  return "\\fB" + Escaped(text) + "\\fR";
}

std::string Item(const std::string& head, const std::string& body) {
  return ".TP\n" + head + "\n" + body + "\n";
}

/// What stands behind "--flag=" in the page; empty for a switch.
std::string Placeholder(const FlagDescription& flag) {
  switch (flag.value) {
    case FlagValue::kSwitch:
      return "";
    case FlagValue::kNumber:
      return flag.type == "double" ? "X" : "N";
    case FlagValue::kWord:
      return "WORD";
    case FlagValue::kPath:
      return "PATH";
    case FlagValue::kConfig:
      return "CONFIG";
    case FlagValue::kText:
      break;
  }
  return "TEXT";
}

std::string FlagItem(const FlagDescription& flag) {
  const std::string placeholder = Placeholder(flag);
  std::string remark;
  if (flag.required) {
    remark = " Required.";
  } else if (flag.value != FlagValue::kSwitch && !flag.fallback.empty()) {
    remark = " Default: " + flag.fallback + ".";
  }
  return Item(Bold("--" + flag.name) + (placeholder.empty() ? "" : "=\\fI" + placeholder + "\\fR"),
              Escaped(flag.text + "." + remark));
}

std::string CommandSections() {
  std::string text;
  for (const Command& command : Commands()) {
    text += ".SS alidade " + Escaped(command.name) + "\n" + Escaped(command.summary) + ".\n";
    for (const std::string& flag : command.flags) {
      text += FlagItem(DescribeFlag(command, flag));
    }
  }
  return text;
}

std::string ExitStatus() {
  std::string text;
  for (const ExitCode& exit : ExitCodes()) {
    text += Item(Bold(std::to_string(exit.code)), Escaped(exit.meaning) + ".");
  }
  return text;
}

std::string Files() {
  return Item(Bold("configs/"),
              Escaped("The shipped configurations: base.yaml with every key, its unit, range and reason; "
                      "estimators/, datasets/ and plans/. They are in share/alidade of the installation. A "
                      "CONFIG is a file, or the name of a shipped configuration, such as alidade_filter or "
                      "demo; alidade config --list lists them."));
}

std::string Examples() {
  return Escaped("Ten estimators on the same simulated input, with tables and an HTML report:") +
         "\n.PP\n.nf\n.RS\n" + Escaped("alidade compare --plan=demo --output=out/demo --jobs=2") +
         "\n.RE\n.fi\n.PP\n" + Escaped("One estimator on a EuRoC folder, and its errors:") +
         "\n.PP\n.nf\n.RS\n" +
         Escaped(
             "alidade run --dataset=SEQ --config=alidade_filter --output=out/mine\n"
             "alidade evaluate --truth=SEQ/mav0/state_groundtruth_estimate0/data.csv "
             "--estimate=out/mine/states.csv") +
         "\n.RE\n.fi\n";
}

std::string Manual() {
  return ".TH ALIDADE 1 \"\" \"alidade " ALIDADE_VERSION "\" \"User Commands\"\n.SH NAME\nalidade \\- " +
         Escaped("bench for GNSS-visual-inertial odometry estimators") + "\n.SH SYNOPSIS\n" +
         Bold("alidade") + " \\fIcommand\\fR [" + Bold("--") + "\\fIflag\\fR=\\fIvalue\\fR ...]\n.br\n" +
         Bold("alidade help") + " [\\fIcommand\\fR]\n.br\n" + Bold("alidade --version") +
         "\n.SH DESCRIPTION\n" +
         Escaped(
             "Runs and compares visual-inertial odometry estimators, with or without raw GNSS, on identical "
             "input, and simulates such input. The value of a flag follows '=' or a blank; --noNAME turns a "
             "boolean flag off.") +
         "\n.SH COMMANDS\n" + CommandSections() + ".SH EXIT STATUS\n" + ExitStatus() + ".SH ENVIRONMENT\n" +
         Item(Bold("ALIDADE_DATA_DIR"), Escaped("Folder that holds configs/ instead of the installed one.")) +
         ".SH FILES\n" + Files() + ".SH EXAMPLES\n" + Examples();
}

}  // namespace

int RunManual(const std::vector<std::string>&) {
  std::fputs(Manual().c_str(), stdout);
  return kExitDone;
}

}  // namespace alidade::cli
