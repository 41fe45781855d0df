#!/usr/bin/env bash
# Installs what Alidade needs on Debian 12 and is missing. `--with-tests-of-report` adds what some tests use and are skipped
# without: a headless browser for the report page, RTKLIB as oracle of single-point positions, rosbag as
# oracle of bags, man for the manual page, a Slurm cluster. `--with-clang` adds the compiler of the presets release and dev.
set -euo pipefail

packages=(
  ca-certificates g++ cmake ninja-build pkg-config ccache
  libeigen3-dev libceres-dev libsuitesparse-dev libopenblas-pthread-dev liblapacke-dev
  libopencv-core-dev libopencv-imgproc-dev libopencv-imgcodecs-dev libopencv-video-dev libopencv-calib3d-dev
  libopencv-features2d-dev
  libgflags-dev libgoogle-glog-dev libyaml-cpp-dev nlohmann-json3-dev libboost-dev libboost-math-dev libssl-dev
  libcurl4-openssl-dev libgeographiclib-dev zlib1g-dev libbz2-dev liblz4-dev
  libgtest-dev libgmock-dev libbenchmark-dev librapidcheck-dev libjs-d3 librsvg2-bin
  dpkg-dev file perl
)
optional=()
for option in "$@"; do
  case $option in
    --with-tests-of-report)
      packages+=(chromium rtklib python3-rosbag python3-sensor-msgs man-db procps)
      optional=(munge slurmctld slurmd slurm-client)
      ;;
    --with-clang) packages+=(clang) ;;
    *)
      echo "usage: $0 [--with-tests-of-report] [--with-clang]" >&2
      exit 2
      ;;
  esac
done

# Those of the given packages that are not installed.
missing_of() {
  local package status
  for package in "$@"; do
    status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
    [[ "$status" == installed ]] || echo "$package"
  done
}
mapfile -t missing < <(missing_of "${packages[@]}")
mapfile -t missing_optional < <(missing_of "${optional[@]}")
if [[ ${#missing[@]} -eq 0 && ${#missing_optional[@]} -eq 0 ]]; then
  echo "all packages are installed"
  exit 0
fi

as_root=()
if [[ $(id -u) -ne 0 ]]; then
  if ! command -v sudo >/dev/null; then
    echo "missing packages: ${missing[*]} ${missing_optional[*]}; install them as root, or install sudo" >&2
    exit 1
  fi
  as_root=(sudo)
fi
install() {
  echo "installing $*"
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$@"
}
"${as_root[@]}" apt-get update -qq
[[ ${#missing[@]} -eq 0 ]] || install "${missing[@]}"
# Where a daemon cannot be installed, the tests that need it are skipped.
[[ ${#missing_optional[@]} -eq 0 ]] || install "${missing_optional[@]}" || echo "not installed: ${missing_optional[*]}"
