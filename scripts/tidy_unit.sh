#!/usr/bin/env bash
# Runs clang-tidy on one translation unit, for scripts/lint.sh. Findings that lie in the headers of other libraries are not ours and are
# left out: the analyzer follows calls into Eigen's kernels and takes empty blocks there for uninitialised ones.
# Usage: tidy_unit.sh CLANG_TIDY BUILD_DIR CHECKS SOURCE. Exit code 1: a finding.
set -uo pipefail

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
