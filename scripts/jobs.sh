#!/usr/bin/env bash
# Prints how many compilers may run at a time: one a core, as far as the available memory reaches. One takes up to 1.5 GiB.
set -euo pipefail

cores=$(nproc)
by_memory=$(awk '$1 == "MemAvailable:" { print int($2 / (1.5 * 1024 * 1024)) }' /proc/meminfo)
jobs=$((by_memory < cores ? by_memory : cores))
echo $((jobs > 1 ? jobs : 1))
