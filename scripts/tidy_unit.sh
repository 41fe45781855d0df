#!/usr/bin/env bash
# Runs clang-tidy on one translation unit, for scripts/lint.sh. Findings that lie in the headers of other libraries are not ours and are
# left out: the analyzer follows calls into Eigen's kernels and takes empty blocks there for uninitialised ones.
# A unit that was clean is remembered in BUILD_DIR/tidy-clean, and skipped until its source, a header of ours or the checks change.
# Usage: tidy_unit.sh CLANG_TIDY BUILD_DIR CHECKS SOURCE. Exit code 1: a finding.
set -uo pipefail

# What the verdict depends on. The compiler lists the files, with the unit's own command of compile_commands.json.
key() {
  local command files
  command=$(grep -F -B1 "\"file\": \"$4\"" "$2/compile_commands.json" | sed -n 's/^ *"command": "\(.*\)",$/\1/p' | head -n 1)
  command=${command//\\\"/\"}
  files=$(cd "$2" && eval "${command% -o *} -MM -MT unit $4" 2>/dev/null | tr -d '\\' | tr ' ' '\n' | grep '^/' | grep -v '\.pch$') ||
    return 1
  # shellcheck disable=SC2086 # one word a file
  { "$1" --version; echo "$3"; cat .clang-tidy scripts/tidy_unit.sh $files; } | sha256sum | cut -d ' ' -f 1
}
known=$(key "$@") && known="$2/tidy-clean/$known"
[[ -n "$known" && -e "$known" ]] && exit 0

output=$("$1" -p "$2" --quiet --checks="$3" --extra-arg=-Wno-unknown-warning-option \
  --extra-arg=-Wno-unused-command-line-argument "$4" 2>&1)
code=$?
ours=$(awk '/^[^ ]*:[0-9]+:[0-9]+: (error|warning): / || /^error: / { keep = !/^\/usr\// }
            /^[0-9]+ (warning|error)s? (and [0-9]+ errors? )?generated/ || /^Error while processing/ { keep = 0 }
            keep' <<<"$output")
if [[ -n "$ours" ]]; then
  echo "$ours"
  exit 1
fi
if [[ $code -ne 0 ]] && ! grep -q ': error: ' <<<"$output"; then
  echo "$4: clang-tidy ended with code $code: $(tail --lines=3 <<<"$output")"
  exit 1
fi
if [[ -n "$known" ]]; then
  mkdir -p "$2/tidy-clean"
  : >"$known"
fi
