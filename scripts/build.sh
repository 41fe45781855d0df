#!/usr/bin/env bash
# Installs missing packages and builds preset $1 (release by default) with all cores; further words are build targets.
set -euo pipefail
cd "$(dirname "$0")/.."

preset=${1:-release}
shift || true
compiler=()
[[ $preset == dev ]] && compiler=(--with-clang)
scripts/install_dependencies.sh "${compiler[@]}" >&2
cmake --preset "$preset" >&2
targets=()
[[ $# -gt 0 ]] && targets=(--target "$@")
cmake --build --preset "$preset" --parallel "$(nproc)" "${targets[@]}" >&2
