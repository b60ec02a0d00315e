#!/bin/sh
# The examples of docs/library.md, configured, built and run against an installed dpdref; the closed form without the
# libraries of the engine.
# usage: library_test.sh BUILD, the folder of the built program
set -eu
build=$1
examples=$(cd "$(dirname "$0")/../library" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
fail() {
    echo "library_test: $1" >&2
    exit 1
}

cmake --install "$build" --prefix "$scratch/prefix" >"$scratch/log" || fail "cmake --install: $(tail -5 "$scratch/log")"
# the installed program finds its data, from any directory and moved
cp -R "$scratch/prefix" "$scratch/moved"
for place in prefix moved; do
    (cd / && "$scratch/$place/bin/dpdref" answer gw-0.04 && "$scratch/$place/bin/dpdref" exact) >"$scratch/log" 2>&1 ||
        fail "installed in $place: $(tail -5 "$scratch/log")"
done
sanitized=$(grep -q '^DPDREF_SANITIZE:BOOL=ON' "$build/CMakeCache.txt" && echo -fsanitize=address,undefined || :)
example() {
    folder=$scratch/$1
    shift
    cmake -G Ninja -S "$examples" -B "$folder" -DCMAKE_PREFIX_PATH="$scratch/prefix" -DCMAKE_CXX_FLAGS="$sanitized" "$@" \
        >"$scratch/log" 2>&1 && cmake --build "$folder" >>"$scratch/log" 2>&1 || fail "$*: $(tail -20 "$scratch/log")"
}

hidden=""
for name in HDF5 fmt hwy Eigen3 tomlplusplus nlohmann_json; do hidden="$hidden -DCMAKE_DISABLE_FIND_PACKAGE_$name=ON"; done
# shellcheck disable=SC2086 # a list of words
example theory -DWITH_ENGINE=OFF $hidden
ninja -C "$scratch/theory" -t deps | grep -E '/(hdf5|fmt|hwy|eigen3|toml\+\+|nlohmann)/' && fail "headers of the engine's libraries"
ldd "$scratch/theory/viscosity" | grep -E 'hdf5|fmt|hwy|tomlplusplus' && fail "linked with the engine's libraries"
wanted=$("$build/dpdref" theory ng8 n=3 gamma=9 dt=0.1 | tail -1)
[ "$("$scratch/theory/viscosity")" = "$(printf 'viscosity = %s\nviscosity = %s' "$wanted" "$wanted")" ] ||
    fail "viscosity says $("$scratch/theory/viscosity"), dpdref $wanted"

example engine
# 9000 degrees of freedom, the mean of 100 steps: 5 standard errors of a single step
"$scratch/engine/s1_gas" | awk '{ print; exit !($1 == "kT" && ($3 - 1) ^ 2 < (5 * sqrt(2 / 9000)) ^ 2) }' ||
    fail "s1_gas does not keep kT = 1"
echo "both examples ran"
