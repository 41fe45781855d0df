#!/usr/bin/env bash
# Builds the driver of another system, against a checkout of it. Usage: scripts/peers.sh NAME [--source=DIR] [--gnss_comm=DIR | --lie_plusplus=DIR] [--build=DIR]
#   open_vins    https://github.com/rpng/open_vins                    GPL-3
#   sqrt_vins    https://github.com/rpng/sqrtVINS                     LGPL-3
#   vins_mono    https://github.com/HKUST-Aerial-Robotics/VINS-Mono   GPL-3
#   gvins        https://github.com/HKUST-Aerial-Robotics/GVINS       GPL-3, with https://github.com/HKUST-Aerial-Robotics/gnss_comm, GPL-3
#   ingvio       https://github.com/ChangwuLiu/InGVIO                 GPL-3
#   msceqf       https://github.com/aau-cns/MSCEqF                    Apache-2.0, with https://github.com/aau-cns/Lie-plusplus,
#                                                                     BSD-2 with conditions
# Without --source the system is cloned into BUILD/peers/NAME.source, without --gnss_comm or --lie_plusplus those likewise. Their code
# is no part of Alidade and their licences are their own: a driver that is linked with one may be passed on under that licence alone. The
# driver becomes BUILD/peers/alidade_NAME (--build: default build).
# Exit codes: 2 usage; 3 a checkout is not the commit that the driver was written for; 1 anything else.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)

usage() {
  sed -n '2,13s/^# //p' "$0" >&2
  exit 2
}

[[ $# -ge 1 ]] || usage
name=$1
shift
# The commit that the driver was written and measured with.
# A library that the system is built with.
library="" library_url="" library_commit=""
case "$name" in
  open_vins)
    url=https://github.com/rpng/open_vins commit=69488123ed9362dd44b6f28e7f4680abbff1442b
    packages=(libboost-filesystem-dev libboost-thread-dev libboost-date-time-dev libopencv-highgui-dev)
    ;;
  sqrt_vins)
    url=https://github.com/rpng/sqrtVINS commit=30fafc89d89cfb896d06fdaa68fbda8545e02e9f
    packages=(libboost-filesystem-dev libboost-thread-dev libboost-date-time-dev libopencv-highgui-dev)
    ;;
  vins_mono)
    url=https://github.com/HKUST-Aerial-Robotics/VINS-Mono commit=90dabb5ec79946ae42fd2e1e91d4e69aabe1e25d
    packages=(libopencv-highgui-dev)
    ;;
  gvins)
    url=https://github.com/HKUST-Aerial-Robotics/GVINS commit=d2cf40b49c6eb0e6ad3caa4f613713983be3fd74
    packages=(libopencv-highgui-dev)
    library=gnss_comm library_url=https://github.com/HKUST-Aerial-Robotics/gnss_comm
    library_commit=a2035fec1cc427bba184d25ff1fde8dcf23c9ce1
    ;;
  ingvio)
    url=https://github.com/ChangwuLiu/InGVIO commit=8e167132f376598a66cf610e59fc027a10ace674
    packages=(libopencv-highgui-dev libsuitesparse-dev)
    ;;
  msceqf)
    url=https://github.com/aau-cns/MSCEqF commit=2cb653a5094bbc5d8191b679764439306c82deec
    packages=(libopencv-highgui-dev libboost-dev libyaml-cpp-dev)
    library=lie_plusplus library_url=https://github.com/aau-cns/Lie-plusplus
    library_commit=bea48ea17b6de1397224cfc4d196a8e49eb9250c
    ;;
  *) usage ;;
esac

source_folder="" library_folder="" build=$root/build
for argument in "$@"; do
  case "$argument" in
    --source=*) source_folder=${argument#*=} ;;
    --"$library"=?*) library_folder=${argument#*=} ;;
    --build=*) build=${argument#*=} ;;
    *) usage ;;
  esac
done

# checkout NAME URL COMMIT FOLDER: prints the folder of a checkout at that commit, cloned where FOLDER is empty.
checkout() {
  local name=$1 url=$2 commit=$3 folder=$4 top found
  if [[ -z $folder ]]; then
    folder=$build/peers/$name.source
    if [[ ! -e $folder/.git ]]; then
      echo "cloning $url" >&2
      git clone --quiet "$url" "$folder"
      git -C "$folder" checkout --quiet "$commit"
    fi
  fi
  folder=$(cd "$folder" && pwd)
  # A folder inside another repository would answer with that one's commit.
  top=$(git -C "$folder" rev-parse --show-toplevel 2>/dev/null || true)
  if [[ $top != "$folder" ]]; then
    echo "$folder: is no git checkout; expected $url at $commit" >&2
    exit 3
  fi
  found=$(git -C "$folder" rev-parse HEAD)
  if [[ $found != "$commit" ]]; then
    echo "$folder: is at commit $found; the driver was written for $commit of $name:" \
      "git -C $folder checkout $commit" >&2
    exit 3
  fi
  if ! git -C "$folder" diff --quiet HEAD -- '*.cpp' '*.cc' '*.h' '*.hpp'; then
    echo "note: $folder has changed sources; results are not those of $commit" >&2
  fi
  echo "$folder"
}

source_folder=$(checkout "$name" "$url" "$commit" "$source_folder")
options=("-DALIDADE_${name^^}=$source_folder")
if [[ -n $library ]]; then
  library_folder=$(checkout "$library" "$library_url" "$library_commit" "$library_folder")
  options+=("-DALIDADE_${library^^}=$library_folder")
fi

for package in "${packages[@]}"; do
  if command -v dpkg-query >/dev/null &&
    [[ $(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true) != installed ]]; then
    echo "missing package: apt install ${packages[*]}" >&2
    exit 1
  fi
done

cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release "${options[@]}"
cmake --build "$build" --target "alidade_$name"
echo "built $build/peers/alidade_$name"
