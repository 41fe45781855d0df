#!/usr/bin/env bash
# No source uses a name of Ceres 2.1 that Ceres 2.2 removed: the parameterizations and what Problem had for them, CXSparse, and the
# old classification functions of Jet. Usage: ceres_names_test.sh ROOT
set -euo pipefail
root=$1
removed='\<((Auto[Dd]iff)?Local|Identity|Subset|Quaternion|EigenQuaternion|HomogeneousVector|Line|Product)Parameterization\>'
removed+='|\<(Set|Get|Has)Parameterization\>|\<ParameterBlockLocalSize\>|\<local_parameterization(_ownership)?\>'
removed+='|\<CX_SPARSE\>|\<ceres::Is(Finite|Infinite|NaN|Normal)\>|<ceres/(autodiff_)?local_parameterization[.]h>'

# Prints the lines below folder $1 that use such a name.
find_removed() {
  grep -rnE --include='*.h' --include='*.cc' "$removed" "$1" || true
}

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cat >"$work/removed.cc" <<EOF
#include <ceres/local_parameterization.h>
problem.SetParameterization(x, new ceres::QuaternionParameterization());
options.sparse_linear_algebra_library_type = ceres::CX_SPARSE;
auto* sphere = new ceres::AutoDiffLocalParameterization<Plus, 3, 2>();
return problem.ParameterBlockLocalSize(x);
return ceres::IsFinite(jet);
EOF
cat >"$work/kept.cc" <<EOF
problem.SetManifold(x, new ceres::QuaternionManifold());
options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
EOF
found=$(find_removed "$work" | wc -l)
if [[ $found -ne 6 ]]; then
  echo "of 6 lines with removed names in $work/removed.cc, $found were found:"
  find_removed "$work"
  exit 1
fi

code=0
for folder in core gnss frontend filter smoother eval tests; do
  find_removed "$root/$folder" | grep . && code=1
done
exit $code
