#!/usr/bin/env bash
# Reads how a program was linked, and from its archives how they were compiled (a program shows the protection of all that it contains,
# Ceres for one, and not ours alone); prints a line for each. Exit code: 0 all is there, 1 something is missing, 77 readelf or nm is
# missing (Debian package binutils).
# Usage: hardening.sh PROGRAM [ARCHIVE ...]
set -euo pipefail
program=$1
shift
for tool in readelf nm; do
  command -v "$tool" >/dev/null || { echo "skipped: $tool is not installed (Debian package binutils)"; exit 77; }
done

code=0
# report NAME PATTERN TEXT
report() {
  if grep -qE "$2" <<<"$3"; then
    echo "$1: yes"
  else
    echo "$1: missing"
    code=1
  fi
}
segments=$(readelf -lW "$program")
report "position-independent" 'DYN \(Position-Independent Executable' "$(readelf -hW "$program")"
report "stack not executable" 'GNU_STACK.* RW ' "$segments"
report "relocations read-only" 'GNU_RELRO' "$segments"
report "bound at start" 'BIND_NOW' "$(readelf -dW "$program")"
if [[ $# -gt 0 ]]; then
  symbols=$(nm --undefined-only "$@")
  report "stack protector" '__stack_chk_fail' "$symbols"
  report "fortified functions" '__v?s?n?printf_chk|__mem[a-z]+_chk|__read_chk' "$symbols"
fi
exit "$code"
