#!/bin/sh
# What all figures of the papers cost at the papers' budget with one run for each point of PK2006 (its further seeds are there
# for their scatter), on two cores. The time goes into figures/performance/price.json; its figures are for looking only.
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
begin=$(date +%s)
code=0
"$dpdref" figure all --budget paper --jobs 2 --verification "$folder/definitions" --cache "$folder/cache" \
    --out "$folder/figures" || code=$?
[ $code -le 1 ] || exit $code # 1: a comparison disagrees
python3 - "$folder/figures/run_time.json" $(($(date +%s) - begin)) "$here/../figures/performance/price.json" <<'END'
import json
import sys

_, measured, elapsed, file = sys.argv
with open(measured) as opened:
    price = json.load(opened)
price |= {"jobs": 2, "elapsed": int(elapsed)}
with open(file, "w") as opened:
    json.dump(price, opened, indent=1)
    opened.write("\n")
END
