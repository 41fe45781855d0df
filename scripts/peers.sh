#!/usr/bin/env bash
# Builds the driver of another system, against a checkout of it. Usage: scripts/peers.sh NAME [--source=DIR] [--build=DIR]
#   open_vins    https://github.com/rpng/open_vins                    GPL-3
#   vins_mono    https://github.com/HKUST-Aerial-Robotics/VINS-Mono   GPL-3
# Without --source the system is cloned into BUILD/peers/NAME.source. Its code is no part of Alidade and its licence is its own: a driver
# that is linked with it may be passed on under that licence alone. The driver becomes BUILD/peers/alidade_NAME (--build: default build).
# Exit codes: 2 usage; 3 the checkout is not the commit that the driver was written for; 1 anything else.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)

usage() {
  sed -n '2,7s/^# //p' "$0" >&2
  exit 2
}

[[ $# -ge 1 ]] || usage
name=$1
shift
# The commit that the driver was written and measured with.
case "$name" in
  open_vins)
    url=https://github.com/rpng/open_vins commit=69488123ed9362dd44b6f28e7f4680abbff1442b
    packages=(libboost-filesystem-dev libboost-thread-dev libboost-date-time-dev libopencv-highgui-dev)
    ;;
  vins_mono)
    url=https://github.com/HKUST-Aerial-Robotics/VINS-Mono commit=90dabb5ec79946ae42fd2e1e91d4e69aabe1e25d
    packages=(libopencv-highgui-dev)
    ;;
  *) usage ;;
esac

source_folder="" build=$root/build
for argument in "$@"; do
  case "$argument" in
    --source=*) source_folder=${argument#*=} ;;
    --build=*) build=${argument#*=} ;;
    *) usage ;;
  esac
done

if [[ -z $source_folder ]]; then
  source_folder=$build/peers/$name.source
  if [[ ! -e $source_folder/.git ]]; then
    echo "cloning $url"
    git clone --quiet "$url" "$source_folder"
    git -C "$source_folder" checkout --quiet "$commit"
  fi
fi
source_folder=$(cd "$source_folder" && pwd)

# A folder inside another repository would answer with that one's commit.
top=$(git -C "$source_folder" rev-parse --show-toplevel 2>/dev/null || true)
if [[ $top != "$source_folder" ]]; then
  echo "$source_folder: is no git checkout; expected $url at $commit" >&2
  exit 3
fi
found=$(git -C "$source_folder" rev-parse HEAD)
if [[ $found != "$commit" ]]; then
  echo "$source_folder: is at commit $found; the driver of $name was written for $commit:" \
    "git -C $source_folder checkout $commit" >&2
  exit 3
fi
if ! git -C "$source_folder" diff --quiet HEAD -- '*.cpp' '*.cc' '*.h' '*.hpp'; then
  echo "note: $source_folder has changed sources; results are not those of $commit" >&2
fi

for package in "${packages[@]}"; do
  if command -v dpkg-query >/dev/null &&
    [[ $(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true) != installed ]]; then
    echo "missing package: apt install ${packages[*]}" >&2
    exit 1
  fi
done

cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release "-DALIDADE_${name^^}=$source_folder"
cmake --build "$build" --target "alidade_$name"
echo "built $build/peers/alidade_$name"
