#!/usr/bin/env bash
# Installs missing packages and builds preset $1 (release by default); further words are build targets.
# The compiler of a new build folder is Clang, which takes 0.6 of GCC's time for this code, or $CXX. Packages are built with GCC.
set -euo pipefail
cd "$(dirname "$0")/.."

preset=${1:-release}
shift || true
compiler=()
if [[ $preset != package ]]; then
  export CXX=${CXX:-clang++}
  [[ $CXX == clang++ || $preset == dev ]] && compiler=(--with-clang)
fi
scripts/install_dependencies.sh "${compiler[@]}" >&2
cmake --preset "$preset" >&2
targets=()
[[ $# -gt 0 ]] && targets=(--target "$@")
cmake --build --preset "$preset" --parallel "$(scripts/jobs.sh)" "${targets[@]}" >&2
