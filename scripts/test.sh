#!/usr/bin/env bash
# Builds and runs every test. The last line is "N passed, N failed[, N skipped]"; exit code 0: all is well.
# Usage: scripts/test.sh [release|dev] [ctest options]
set -uo pipefail
cd "$(dirname "$0")/.."

preset=${1:-release}
shift || true
if ! scripts/install_dependencies.sh --with-tests-of-report; then
  echo "packages are missing"
  echo "0 passed, 1 failed"
  exit 1
fi
if ! scripts/build.sh "$preset"; then
  echo "the build failed"
  echo "0 passed, 1 failed"
  exit 1
fi

log=$(mktemp)
trap 'rm -f "$log"' EXIT
ctest --preset "$preset" --parallel "$(nproc)" "$@" 2>&1 | tee "$log"
code=${PIPESTATUS[0]}

# A line of ctest for one test: "12/345 Test  #12: Name ....   Passed    0.01 sec".
# A disabled test is none.
results=$(grep -E '^ *[0-9]+/[0-9]+ Test +#[0-9]+: ' "$log" | grep -vF '***Not Run (Disabled)')
total=$(grep -c . <<<"$results" || true)
passed=$(grep -cE ' Passed +[0-9.]+ sec$' <<<"$results" || true)
skipped=$(grep -cE '\*\*\*Skipped +[0-9.]+ sec$' <<<"$results" || true)
failed=$((total - passed - skipped))
if [[ $failed -eq 0 && ( $code -ne 0 || $total -eq 0 ) ]]; then
  failed=1  # ctest itself did not come to its tests
fi

# Once more what the failed tests printed: of a long log only the end may be kept.
if [[ $failed -gt 0 ]]; then
  grep -vE ' (Passed|Start) |\*\*\*(Skipped|Not Run)' <<<"$results" | sed -E 's/^ *[0-9]+\/[0-9]+ Test +#[0-9]+: ([^ ]+).*/\1/' | while read -r name; do
    echo "== $name"
    awk -v name="$name" '
      $0 ~ /^ *[0-9]+\/[0-9]+ Test +#[0-9]+: / { of_test = index($0, ": " name " ") > 0; next }
      /^ +Start +[0-9]+: / { next }
      of_test' "$log" | tail -n 40
  done
fi

line="$passed passed, $failed failed"
[[ $skipped -gt 0 ]] && line="$line, $skipped skipped"
echo "$line"
[[ $failed -eq 0 ]]
