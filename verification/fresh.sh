#!/bin/sh
# From a fresh Debian or Ubuntu to the figures or the tests: packages, build, main job.
# usage: sh verification/fresh.sh figures|tests
set -eu
job=${1:-}
case "$job" in figures | tests) ;; *)
    echo "usage: sh verification/fresh.sh figures|tests" >&2
    exit 2
    ;;
esac
cd "$(dirname "$0")/.."

packages="g++ cmake ninja-build libeigen3-dev libboost-dev libboost-test-dev libfmt-dev libhdf5-dev
    nlohmann-json3-dev libcli11-dev libtomlplusplus-dev librandom123-dev libhwy-dev gnuplot-nox fonts-dejavu-core
    python3-h5py"
[ "${CI:-}" != true ] || packages="$packages doxygen doxygen-awesome-css libjs-mathjax" # the book
missing=""
for package in $packages; do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q "install ok installed" || missing="$missing $package"
done
if [ -n "$missing" ]; then
    root=""
    [ "$(id -u)" -eq 0 ] || root=sudo
    export DEBIAN_FRONTEND=noninteractive
    $root apt-get update -q
    # shellcheck disable=SC2086 # a list of words
    $root apt-get install -y -q --no-install-recommends $missing
fi

if [ "$job" = figures ]; then
    cmake --preset release
    cmake --build --preset release --target dpdref
    echo "regenerating all figures at the quick budget; they appear in figures/quick"
    build/release/dpdref figure all --budget quick
else
    preset=release
    [ "${CI:-}" != true ] || preset=ci # warnings are errors
    cmake --preset $preset
    cmake --build --preset $preset
    ctest --preset $preset --parallel "$(nproc)"
    [ "${CI:-}" != true ] || cmake --build --preset $preset --target docs # its warnings and broken links are errors
fi
