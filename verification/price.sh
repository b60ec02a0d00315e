#!/bin/sh
# What all figures of the papers cost at the papers' budget with one run for each point of PK2006 (its further seeds are there
# for their scatter). The processor time goes into figures/performance/price.json; the figures are for looking only.
# usage: sh verification/price.sh DPDREF FOLDER     FOLDER, which must not exist: definitions, cache and figures of this run
set -eu
[ $# -eq 2 ] && [ ! -e "$2" ] || {
    sed -n 's/^# usage: //p' "$0" >&2
    exit 2
}
dpdref=$1 folder=$2 here=$(dirname "$0")
mkdir -p "$folder"
cp -r "$here" "$folder/definitions"
sed -i -E 's/^(seeds|paper_seeds) = .*/\1 = 1/' "$folder"/definitions/pk*/figure.toml
"$dpdref" figure all --budget paper --jobs 2 --verification "$folder/definitions" --cache "$folder/cache" \
    --out "$folder/figures" || [ $? -eq 1 ] # a comparison disagrees
cp "$folder/figures/run_time.json" "$here/../figures/performance/price.json"
