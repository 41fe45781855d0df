#!/usr/bin/env bash
# GIVEN stored figures of runs WHEN others are compared with them THEN a change of digits is printed and passes, and a larger one, another
# status, a missing and a new run are printed and fail.
# Usage: replay_test.sh SCRIPT
set -euo pipefail
script=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cat >"$work/stored.csv" <<EOF
estimator,sequence,seed,status,input,states,rmse_pos_m,nees_pose
a,s,1,ok,i1,x1,0.5,6
a,s,2,ok,i2,x2,0.25,5
b,s,1,ok,i1,y1,1,7
EOF
# shellcheck source=tests/scripts/expect_change.sh
source "$(dirname "$0")/../scripts/expect_change.sh"
expect() { expect_change "$script" "$work/stored.csv" "$@"; }
expect 0 "a on s: 2 of 2 runs equal to the byte" ""
expect 0 "  rmse_pos_m: +5e-05 % +- 5e-05, at most 0.0001 % (seed 1)" "s/x1,0.5/z,0.5000005/"
expect 0 "a on s: 1 of 2 runs equal to the byte; inputs of 1 changed" "s/i1,x1/j,z/"
expect 1 "  nees_pose: +0.5 % +- 0.5, at most 1 % (seed 1): beyond 0.1 %" "s/x1,0.5,6/z,0.5,6.06/"
expect 1 "a,s,2: was ok, is failed" "s/a,s,2,ok/a,s,2,failed/"
expect 1 "missing run: b,s,1" "/^b/d"
expect 1 "new run: c,s,1" "s/^b/c/"
