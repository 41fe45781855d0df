#include <cstdio>

#include "eval/cli/commands.h"
#include "eval/cli/exit_code.h"
#include "eval/cli/flag_description.h"

namespace alidade::cli {
namespace {

constexpr const char* kHead =
    R"bash(# Completion of `alidade` in bash; `alidade completion` prints it. To be sourced.

)bash";

constexpr const char* kTail = R"bash(
# One reply a line: the shipped configurations of kind $1 that start with $2, from program $3, and files.
_alidade_configs() {
  compgen -W "$("${3/#\~/$HOME}" config --list --kind="$1" 2>/dev/null)" -- "$2"
  compgen -f -- "$2"
}

# The data sets that start with $1, from program $2.
_alidade_sets() {
  "${2/#\~/$HOME}" data list 2>/dev/null | awk 'NR > 1 { print $1 }' | grep "^$1"
}

# The kind of configuration that the words of `alidade config` are about.
_alidade_kind() {
  local i kind=estimator
  for ((i = 2; i + 1 < ${#COMP_WORDS[@]}; ++i)); do
    if [[ ${COMP_WORDS[i]} == --kind ]]; then
      kind=${COMP_WORDS[i + 1]}
      [[ $kind == = ]] && kind=${COMP_WORDS[i + 2]-}
    fi
  done
  echo "$kind"
}

_alidade() {
  local current=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} command=${COMP_WORDS[1]}
  local flag="" values
  COMPREPLY=()
  if ((COMP_CWORD == 1)); then
    mapfile -t COMPREPLY < <(compgen -W "$_alidade_commands help --help --version" -- "$current")
    return
  fi
  # Bash makes a word of the sign between a flag and its value.
  if [[ $current == = ]]; then
    flag=$before current=""
  elif [[ $before == = ]]; then
    flag=${COMP_WORDS[COMP_CWORD - 2]}
  elif [[ " $(_alidade_flags "$command") " == *" $before= "* ]]; then
    flag=$before
  fi

  if [[ -n $flag ]]; then
    values=$(_alidade_values "$command" "$flag")
  elif [[ $current == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(_alidade_flags "$command") --help" -- "$current")
    [[ ${#COMPREPLY[@]} -eq 1 && ${COMPREPLY[0]} == *= ]] && compopt -o nospace
    return
  elif [[ $command == help ]]; then
    values=$_alidade_commands
  elif [[ $command == data ]]; then
    values="list fetch verify"
    ((COMP_CWORD > 2)) && values=$(_alidade_sets "$current" "${COMP_WORDS[0]}")
  elif [[ $command == config ]]; then
    values=@$(_alidade_kind)
  else
    values=$(_alidade_flags "$command")
    compopt -o nospace
  fi

  case $values in
    @path)
      compopt -o filenames
      mapfile -t COMPREPLY < <(compgen -f -- "$current")
      ;;
    @*)
      compopt -o filenames
      mapfile -t COMPREPLY < <(_alidade_configs "${values#@}" "$current" "${COMP_WORDS[0]}")
      ;;
    *)
      mapfile -t COMPREPLY < <(compgen -W "$values" -- "$current")
      ;;
  esac
}
complete -F _alidade alidade
)bash";

/// What the shell completes as a flag's value: words, or "@" and what kind of file it is.
std::string ValuesOf(const FlagDescription& flag) {
  switch (flag.value) {
    case FlagValue::kPath:
      return "@path";
    case FlagValue::kConfig:
      return "@" + std::string(ToString(flag.config));
    case FlagValue::kWord: {
      std::string words;
      for (const std::string& word : flag.words) {
        words += (words.empty() ? "" : " ") + word;
      }
      return words;
    }
    case FlagValue::kSwitch:
    case FlagValue::kText:
    case FlagValue::kNumber:
      break;
  }
  return "";
}

/// A function of the shell that looks its arguments up: `cases` are lines of a `case` over `subject`.
std::string LookUp(const std::string& comment, const std::string& name, const std::string& subject,
                   const std::string& cases) {
  return "# " + comment + "\n" + name + "() {\n  case " + subject + " in\n" + cases + "  esac\n}\n";
}

std::string Completion() {
  std::string commands, flags, values;
  for (const Command& command : Commands()) {
    commands += (commands.empty() ? "" : " ") + command.name;
    std::string names;
    for (const std::string& name : command.flags) {
      const FlagDescription flag = DescribeFlag(command, name);
      names += " --" + flag.name + (flag.value == FlagValue::kSwitch ? "" : "=");
      if (const std::string words = ValuesOf(flag); !words.empty()) {
        values += "    " + command.name + ":--" + flag.name + ") echo '" + words + "' ;;\n";
      }
    }
    if (!names.empty()) {
      flags += "    " + command.name + ") echo '" + names.substr(1) + "' ;;\n";
    }
  }
  return kHead + ("_alidade_commands='" + commands + "'\n\n") +
         LookUp("The flags of command $1; one that takes a value ends with \"=\".", "_alidade_flags", "$1",
                flags) +
         "\n" +
         LookUp(
             "What the flag $2 of command $1 takes: words, or @path, or @ and the kind of a configuration.",
             "_alidade_values", "$1:$2", values) +
         kTail;
}

}  // namespace

int RunCompletion(const std::vector<std::string>&) {
  std::fputs(Completion().c_str(), stdout);
  return kExitDone;
}

}  // namespace alidade::cli
