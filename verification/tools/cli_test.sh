#!/bin/bash
# The command line as scripts see it: exit codes, one-line messages, pipes, signals, resuming.
# Usage: cli_test.sh PATH_OF_DPDREF
set -u

dpdref=$(realpath "${1:?usage: cli_test.sh PATH_OF_DPDREF}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
data=$(realpath "$(dirname "$0")/../data/damaged")
trials=$(realpath "$(dirname "$0")/../trials")
figures=$(realpath "$(dirname "$0")/../../figures")
answers=$figures/answers/answers.json
cd "$work" || exit 99
failures=0

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

# check WHAT COMMAND...: the command must succeed
check() {
    local what=$1
    shift
    "$@" || fail "$what"
}

# Runs dpdref; leaves exit code, standard output and standard error in $code, out, err.
call() {
    "$dpdref" "$@" >out 2>err </dev/null
    code=$?
}

# expect CODE [PATTERN...] -- ARGUMENTS: exit code; on failure exactly one line, "dpdref: ...", with every pattern
expect() {
    local wanted=$1
    shift
    local patterns=()
    while [ "$1" != "--" ]; do
        patterns+=("$1")
        shift
    done
    shift
    call "$@"
    [ "$code" -eq "$wanted" ] || fail "dpdref $*: exit code $code, expected $wanted: $(head -c 300 err)"
    if [ "$wanted" -ne 0 ]; then
        [ "$(wc -l <err)" -eq 1 ] || fail "dpdref $*: $(wc -l <err) lines of complaint, expected 1: $(cat err)"
        grep -q '^dpdref: ' err || fail "dpdref $*: the complaint does not begin with dpdref: $(cat err)"
        [ ! -s out ] || fail "dpdref $*: printed results in spite of the error"
        local pattern
        for pattern in ${patterns[@]+"${patterns[@]}"}; do
            grep -qF -- "$pattern" err || fail "dpdref $*: the complaint lacks '$pattern': $(cat err)"
        done
    fi
}

no_remains() {
    local found
    found=$(find . -name '*.part')
    [ -z "$found" ] || fail "$1: left $found"
}

is_json() {
    command -v python3 >/dev/null || return 0
    python3 -m json.tool <"$1" >/dev/null
}

# What of a run's JSON must not depend on interruptions.
numbers() { grep -vE '"(seconds|bytes|nanoseconds_per_particle_and_step)"' "$1"; }

cat >scene.toml <<'TOML'
title = "a scene"
dimension = 2
stages = ["shardlow", "sample", "drift"]
[box]
length = [6.0, 6.0]
[particles]
density = 2.0
[shardlow]
friction = 3.0
[time]
step = 0.1
duration = 10.0
[sample]
observables = ["kinetic_temperature", "momentum", "stress"]
[sample.velocity_autocorrelation]
longest = 1.0
TOML

# --- the program itself ---------------------------------------------------------------------------------
call --version
[ "$code" -eq 0 ] && grep -qE '^dpdref [0-9]+\.[0-9]+\.[0-9]+' out || fail "--version"
call --help
[ "$code" -eq 0 ] && grep -q theory out || fail "--help"
expect 2 subcommand --
expect 2 -- fly
expect 2 -- run
expect 2 -- run scene.toml --no-such-option
expect 2 -- run scene.toml --seed x

# --- theory ---------------------------------------------------------------------------------------------
expect 0 -- theory
for id in my22 my25 my26 ng8 ng9 ng12 ng17 ng8-lowe ng9-lowe ng12-lowe; do
    grep -q "^$id " out || fail "theory: the list lacks $id"
done
expect 0 -- theory --json
check "theory --json is no JSON" is_json out
expect 0 -- theory ng8 d=3 n=3 gamma=9 dt=0.1
[[ $(tail -n 1 out) =~ ^0\.26624435137[0-9]*$ ]] || fail "theory ng8: the last line is $(tail -n 1 out)"
expect 0 -- theory ng8 d=3 n=3 gamma=9 dt=0.1 --json
check "theory ng8 --json is no JSON" is_json out
grep -q '"value":0.26624435137' out || fail "theory ng8 --json: $(cat out)"
expect 2 ng99 my22 -- theory ng99
echo quantity,value >empty.csv
expect 2 nowhere read -- theory memory-collision-soft n=1 gamma=4.5 a=25 g=nowhere
expect 2 empty.csv radial_distribution -- theory memory-collision-soft n=1 gamma=4.5 a=25 g=empty.csv
expect 2 ng8 colour -- theory ng8 d=3 n=3 gamma=9 dt=0.1 colour=2
expect 2 ng8 "'n'" -- theory ng8 d=3 gamma=9 dt=0.1
expect 2 "'n'" x -- theory ng8 d=3 n=x gamma=9 dt=0.1
expect 2 "'n'" -1 -- theory ng8 d=3 n=-1 gamma=9 dt=0.1
expect 2 dt key=value -- theory ng8 d=3 n=3 gamma=9 dt
expect 0 -- theory ng8 n=3 gamma=9 dt=0.1 weight=power exponent=1.5
expect 2 "needs parameter 'exponent'" -- theory ng8 n=3 gamma=9 dt=0.1 weight=power

# --- run: bad input -------------------------------------------------------------------------------------
expect 2 missing.toml -- run missing.toml
expect 2 "cannot be read" -- run "$work"
expect 2 allowed "a number > 0" time.step -- run scene.toml --set time.step=-1
expect 2 shardlow.weight allowed quadratic -- run scene.toml --set shardlow.weight=cubic
expect 0 -- run scene.toml --set shardlow.weight=power --set shardlow.exponent=1.5
expect 2 shardlow.exponent "is missing" -- run scene.toml --set shardlow.weight=power
expect 2 shardlow.exponent "0 to 100" -- run scene.toml --set shardlow.weight=power --set shardlow.exponent=-1
expect 2 shardlow.exponent "unknown key" -- run scene.toml --set shardlow.exponent=1
expect 2 time.speed "unknown key" -- run scene.toml --set time.speed=1
expect 2 table.key=value -- run scene.toml --set time.step
sed 's/step = 0.1/step = fast/' scene.toml >syntax.toml
expect 2 syntax.toml:11 -- run syntax.toml
sed 's/friction = 3.0/fiction = 3.0/' scene.toml >unknown.toml
expect 2 unknown.toml:8 shardlow.friction "is missing" -- run unknown.toml
expect 2 "trajectory: " allowed --out -- run scene.toml --set trajectory.interval=5
expect 2 time.until.colour allowed kinetic_temperature -- run scene.toml --until colour=1%
expect 2 "--until" QUANTITY=ERROR -- run scene.toml --until kinetic_temperature=100%

# --- run until errors are small -------------------------------------------------------------------------
expect 0 -- run scene.toml --until kinetic_temperature=2%,green_kubo_diffusion_constant=0.3 --until correlation_moment=50% --json
[ ! -s err ] && [ "$(grep -c '"reached": true' out)" -eq 3 ] || fail "run --until: $(cat out err)"
expect 0 -- run scene.toml --until kinetic_temperature=0.01% --set time.longest=20
grep -q 'kinetic_temperature.*0.01 % wanted.*time.longest' err || fail "run --until: an error not reached is not said: $(cat err)"

expect 2 "stability.toml" -- stability --verification "$work" --cache c
expect 2 "work-precision nonsense" allowed integrators -- work-precision nonsense

# --- run: outputs that cannot be written ----------------------------------------------------------------
expect 2 no/such/directory -- run scene.toml --out no/such/directory/a.h5
mkdir directory
expect 2 directory -- run scene.toml --out directory
expect 2 scene.toml/a.h5 -- run scene.toml --out scene.toml/a.h5
cp scene.toml precious
expect 2 precious -- run scene.toml --out precious
cmp -s scene.toml precious || fail "run --out: an existing file was changed"
no_remains "unwritable output"
[ ! -e no ] || fail "run --out: created a directory"

# --- run: results, pipes, cache -------------------------------------------------------------------------
expect 0 -- run scene.toml --out a.h5
grep -q kinetic_temperature out || fail "run: prints no kinetic temperature"
expect 0 -- run scene.toml --out a.h5 --json
check "run --json is no JSON" is_json out
grep -q '"kinetic_temperature"' out || fail "run --json: no kinetic temperature"
! grep -v ' % done after ' err || fail "run: wrote to standard error: $(cat err)"
cp out cached.json
expect 0 -- run scene.toml --json
[ "$(numbers out)" = "$(numbers cached.json)" ] || fail "run: a result from the file differs from a new one"
expect 0 -- run scene.toml --set trajectory.interval=5 --out moving.h5
[ -s moving.h5md ] || fail "run: no trajectory beside the results"
expect 2 a.h5 -- run scene.toml --out a.h5 --seed 2
# either engine gives the same numbers; the plain one says what it costs, and its results are its own
order=(--set pairs.order=id --set pairs.search=brute --json)
expect 0 -- run scene.toml "${order[@]}"
cp out fast.json
expect 0 -- run scene.toml "${order[@]}" --engine plain --out plain.h5
grep -q '^dpdref: the plain engine looks at all 2.56e+03 pairs' err || fail "run --engine plain: does not say what it costs: $(cat err)"
[ "$(numbers out | grep -v '"key"')" = "$(numbers fast.json | grep -v '"key"')" ] || fail "run --engine plain: other numbers"
expect 2 plain.h5 engine -- run scene.toml "${order[@]}" --out plain.h5
expect 2 fast plain -- run scene.toml --engine slow
expect 2 pairs.order random -- run scene.toml --engine plain --set pairs.order=random
expect 0 -- run scene.toml --seed 18446744073709551615 --json
grep -q '"seed": 18446744073709551615' out || fail "run --seed: not the seed that was given"
no_remains run
for seed in -1 18446744073709551616 1x; do
    expect 2 "--seed: $seed" -- run scene.toml --seed="$seed"
done

# --- export ---------------------------------------------------------------------------------------------
expect 2 -- export
expect 2 -- export lammps scene.toml
expect 2 "export lammps: shardlow.weight: " allowed quadratic -- export lammps scene.toml --out deck
[ ! -e deck ] || fail "export: a refused scene left a directory"
observables='sample={ observables = ["kinetic_temperature"] }'
expect 0 -- export lammps scene.toml --set shardlow.weight=quadratic --set "$observables" --out deck
grep -q '^pair_style dpd/fdt 1 1 1$' deck/in.dpdref || fail "export: the deck is $(cat deck/in.dpdref)"
expect 2 ".: holds " -- export lammps scene.toml --set shardlow.weight=quadratic --set "$observables" --out .

# --- run: divergence ------------------------------------------------------------------------------------
cat >unstable.toml <<'TOML'
dimension = 2
stages = ["euler", "sample", "drift", "kick"]
[box]
length = [20.0, 20.0]
[particles]
density = 0.2
[euler]
gamma = 1.0
sigma = 1.0
cutoff = 4.0
[time]
step = 2.0
duration = 100000.0
[sample]
observables = ["kinetic_temperature"]
TOML
expect 3 "diverged at step " time.step -- run unstable.toml --out unstable.h5
grep -qE 'diverged at step [0-9]+ ' err || fail "divergence: no step in $(cat err)"
cp err first
[ -s unstable.h5 ] || fail "divergence: no file is left"
expect 3 "diverged at step " -- run unstable.toml --out unstable.h5
cmp -s err first || fail "divergence: not at the same step again"
no_remains divergence

# --- run: signals and resuming --------------------------------------------------------------------------
# a run of seconds; its checkpoints are frequent
long=(run scene.toml --set particles.density=6 --set "box.length=[16.0, 16.0]" --set time.duration=600
    --set time.checkpoint=0.05 --json)
expect 0 -- "${long[@]}"
cp out whole.json
[ "$(tr -d -c '\r' <out | wc -c)" -eq 0 ] && ! grep -v ' % done after ' err ||
    fail "pipe: progress characters, or noise: $(cat err)"

# start OUTPUT: begins the run in the background, returns when its first file is there
start() {
    "$dpdref" "${long[@]}" --out "$1" >out 2>err </dev/null &
    pid=$!
    for _ in $(seq 200); do
        [ -e "$1" ] && break
        sleep 0.02
    done
    sleep "$2"
}

for signal in INT TERM; do
    start "$signal.h5" 0.3
    kill -s "$signal" "$pid"
    wait "$pid"
    code=$?
    [ "$code" -eq 130 ] || fail "SIG$signal: exit code $code, expected 130 (too fast a machine?)"
    grep -qE '^dpdref: interrupted at step [0-9]+ of 6000; the same command goes on from there$' err ||
        fail "SIG$signal: says $(cat err)"
    [ "$(grep -vc ' % done after ' err)" -eq 1 ] || fail "SIG$signal: more than a line: $(cat err)"
    [ ! -s out ] || fail "SIG$signal: printed results"
    expect 0 -- "${long[@]}" --out "$signal.h5"
    [ "$(numbers out)" = "$(numbers whole.json)" ] || fail "SIG$signal: the resumed run differs"
    no_remains "SIG$signal"
done

start KILL.h5 0.5
kill -s KILL "$pid"
wait "$pid" 2>/dev/null
code=$?
[ "$code" -eq 137 ] || fail "SIGKILL: exit code $code: it had ended before"
if command -v h5dump >/dev/null; then
    step=$(h5dump -d /checkpoint/step KILL.h5 | sed -n 's/.*(0): \([0-9]*\).*/\1/p')
    [ "${step:-0}" -gt 0 ] || fail "SIGKILL: no checkpoint after half a second"
fi
rm -f KILL.h5.*.part # a kill may hit a checkpoint being written; the file itself is whole
expect 0 -- "${long[@]}" --out KILL.h5
[ "$(numbers out)" = "$(numbers whole.json)" ] || fail "SIGKILL: the resumed run differs"
no_remains SIGKILL

# --- curves as text -------------------------------------------------------------------------------------
expect 0 -- run scene.toml --csv -
[ "$(head -n 1 out)" = curve,x,value,error,blocks ] || fail "run --csv -: begins with $(head -n 1 out)"
[ "$(grep -cE '^velocity_autocorrelation,[0-9.]+,[-0-9.e]+,[0-9.e-]+,[0-9]+$' out)" -eq 11 ] || fail "run --csv -: not lags 0 to 10: $(cat out)"
# at lag 0 kT/m, of 72 particles at some 100 instants
awk -F, '$1 == "velocity_autocorrelation" && $2 == 0 { exit !(($3 - 1) ^ 2 < 0.01) }' out || fail "run --csv -: $(cat out)"
mv out printed.csv
expect 0 -- run scene.toml --csv curves.csv
cmp -s curves.csv printed.csv && grep -q '^kinetic' <(tr -d ' ' <out) || fail "run --csv FILE: other curves, or no table: $(cat out)"
expect 0 -- run scene.toml --set 'sample.profile.bins=4' --set sample.profile.temperature=true --csv -
for curve in density_profile velocity_profile temperature_profile; do
    [ "$(grep -c "^$curve," out)" -eq 4 ] || fail "run --csv -: $curve: $(cat out)"
done
expect 2 "--csv nowhere/c.csv" -- run scene.toml --csv nowhere/c.csv
grep -v velocity_autocorrelation scene.toml | grep -v longest >curveless.toml
expect 2 "measures no curve" -- run curveless.toml --csv -

# --- compare --------------------------------------------------------------------------------------------
printf 'quantity,value,error,blocks\nkinetic_temperature,1.0,0.05,20\ncolour,1,0.1,8\n' >code.csv
expect 0 -- compare code.csv --reference a.h5 --resolution 1
grep -qE '^kinetic_temperature .* agrees$' out && grep -qE '^colour .* no reference$' out || fail "compare: $(cat out)"
grep -q '^1 comparisons with a.h5: 1 agree.*whole table 1 %' out || fail "compare: $(cat out)"
grep -q '^not measured: .*kinetic_stress' out || fail "compare: does not say what is missing: $(cat out)"
expect 0 -- compare code.csv --reference a.h5 --json
check "compare --json is no JSON" is_json out
call compare code.csv --reference a.h5 --as kinetic_temperature=kinetic_temperature*2
[ "$code" -eq 1 ] && grep -qE '^kinetic_temperature .* disagrees$' out || fail "compare: exit code $code: $(cat out)"
# a file without a reference is no agreement
printf '1 2\n3 4\n' >numbers.dat
for form in "" --json; do
    call compare numbers.dat --answer gw-0.04 --answers "$answers" $form
    [ "$code" -eq 4 ] || fail "compare without a reference: exit code $code, expected 4"
    [ "$(wc -l <err)" -eq 1 ] && grep -q '^dpdref: nothing was compared' err || fail "compare without a reference: $(cat err)"
done
expect 2 "--answer ID" -- compare code.csv
expect 2 code.csv -- compare code.csv --reference code.csv
expect 2 none.json -- compare code.csv --answer gas --answers none.json
expect 2 "no column T" -- compare code.csv --reference a.h5 --as T=kinetic_temperature

# --- answer ---------------------------------------------------------------------------------------------
# the data are found from any directory, here from one that is not the clone; alone, the program says what is missing
expect 0 -- answer gw-0.04
grep -q '^gw-0.04: ' out || fail "answer from another directory: $(cat out)"
mkdir alone && cp "$dpdref" alone/dpdref
built=$dpdref dpdref=$work/alone/dpdref
expect 2 answers.json "--answers" -- answer gw-0.04
expect 2 "--verification" -- exact
expect 2 "--verification" -- figure my1
dpdref=$built
expect 2 "--answers" -- answer gw-0.04 --answers nowhere.json
expect 2 "n is 3, not 3.1" "--measure" -- answer n=3.1 a=25 gamma=4.5 dt=0.04
expect 0 -- answer --of molly n=3 dt=0.04
grep -q 'molly: .* λ=0.65$' out || fail "answer --of molly: another integrator: $(cat out)"
expect 2 "lambda=0.6" -- answer --of molly n=3 dt=0.04 λ=0.6
expect 2 "above 0 and below 1" -- answer gw-0.04 --measure --within 0%
expect 2 --measure -- answer gw-0.04 --within 1%
expect 3 "diverged at step" -- answer n=3 a=1e7 gamma=4.5 dt=0.04 N=100 --measure
fluid="n=3 a=25 gamma=4.5 dt=0.04 N=100 --within 5% --measure"
# shellcheck disable=SC2086
expect 0 -- answer $fluid --json
check "answer --measure --json is no JSON" is_json out
cp out measured.json
grep -q 'runs, about .* of one core' err || fail "answer --measure: no price: $(cat err)"
# shellcheck disable=SC2086
expect 0 -- answer $fluid --json
cmp -s out measured.json && [ ! -s err ] || fail "answer --measure again: other numbers, or a price: $(cat err)"
# kT of 8 where 1 is right; the state point that is there is another one
printf 'quantity,value,error\nkinetic_temperature,8.0,0.1\n' >hot.csv
# shellcheck disable=SC2086
call compare hot.csv $fluid
[ "$code" -eq 1 ] && grep -q '^kinetic_temperature .* disagrees' out || fail "compare --measure: exit code $code: $(cat out err)"
expect 2 "N is 3000, not 100" -- compare hot.csv n=3 a=25 gamma=4.5 dt=0.04 N=100
expect 2 "one reference" -- compare hot.csv n=3 --reference a.h5

# --- report ---------------------------------------------------------------------------------------------
expect 2 figures "dpdref figure" -- report
expect 2 nothing -- report --figures nothing

# --- figure: one of two points, then from the cache, then the report; a figure needs gnuplot -------------
expect 2 nosuch -- figure nosuch --verification .
if command -v gnuplot >/dev/null; then
    mkdir -p definitions/tiny
    : >definitions/style.gp
    echo 'plot data index "gas:kinetic_temperature:value" using 1:2:3 with yerrorbars' >definitions/tiny/plot.gp
    cat >definitions/tiny/figure.toml <<'TOML'
paper = "none"
figure = "0"
title = "temperature"
caption = "a test"
[scene]
dimension = 2
stages = ["shardlow", "sample", "drift"]
box.length = [5.0, 5.0]
particles.density = 3.0
shardlow.friction = 1.0
time = { step = 0.1, duration = 200.0 }
sample.observables = ["kinetic_temperature"]
[budget.quick]
seeds = 2
[budget.paper]
seeds = 3
[[curve]]
name = "gas"
vary = "time.step"
values = [0.1, 0.5]
paper_only = [0.5]
[[curve.compare]]
quantity = "kinetic_temperature"
theory = "value"
value = 1.0
tolerance = 0.2
TOML
    # a budget may be an error instead of a duration; 1 % of 75 particles needs more than the least duration
    mkdir definitions/tiny-until
    cp definitions/tiny/plot.gp definitions/tiny-until
    sed 's/^seeds = 2/seeds = 1\nset = { "time.duration" = 20.0, "time.until.kinetic_temperature" = 0.01 }/' \
        definitions/tiny/figure.toml >definitions/tiny-until/figure.toml
    expect 0 -- figure tiny-until --verification definitions --cache until --out tiny-until
    awk '$1 == 0.1 { n++; large += $3 > 0.0101 * $2 } END { exit !n || large }' tiny-until/data/tiny-until.dat ||
        fail "figure: its error is not what the budget wants: $(cat tiny-until/data/tiny-until.dat)"

    mkdir definitions/tiny-too # another figure of the same runs
    cp definitions/tiny/* definitions/tiny-too
    tiny=(figure tiny --verification definitions --cache cache --out tiny --jobs 2)
    expect 0 -- "${tiny[@]}"
    grep -q '^1 comparisons: 1 agree' out || fail "figure: $(tail -1 out)"
    check "figure: no picture" test -s tiny/tiny.svg -a -s tiny/tiny.png
    [ "$(ls cache | wc -l)" -eq 2 ] || fail "figure: not two runs in the cache"
    cp tiny/data/tiny.dat first.dat
    touch -d 2000-01-01 cache/*
    expect 0 -- "${tiny[@]}"
    [ -z "$(find cache -newermt 2001-01-01 -name '*.h5')" ] || fail "figure: ran again what the cache holds"
    check "figure: other numbers from the cache" cmp first.dat tiny/data/tiny.dat
    # judged and drawn again without a run: the same data
    redraw=(figure tiny --verification definitions --out tiny --redraw)
    expect 0 -- "${redraw[@]}"
    check "--redraw: other numbers" cmp first.dat tiny/data/tiny.dat
    # a closed form is evaluated, not taken from what another program left
    mkdir -p closed/tiny
    : >closed/style.gp
    sed 's/:value/:ng17/' definitions/tiny/plot.gp >closed/tiny/plot.gp
    sed 's/^theory = "value"/theory = "ng17"\nrelation = "at_least"/; /^value = /d; /^tolerance = /d' definitions/tiny/figure.toml >closed/tiny/figure.toml
    cp -r tiny closed/out
    closed=(figure tiny --verification closed --out closed/out --redraw)
    expect 0 -- "${closed[@]}"
    cp closed/out/data/tiny.json closed/first.json
    sed -i 's/"theory_value": [^,]*/"theory_value": 0.5/' closed/out/data/tiny.json
    check "--redraw: no theory to change" [ "$(cmp -s closed/first.json closed/out/data/tiny.json; echo $?)" -eq 1 ]
    expect 0 -- "${closed[@]}"
    check "--redraw: kept the value of a closed form" cmp closed/first.json closed/out/data/tiny.json
    expect 2 "there is none" -- figure tiny --verification definitions --out nowhere --redraw
    for study in stability "work-precision integrators"; do
        name=${study% *}
        mkdir -p "redrawn/$name" && cp -r "$figures/$name/data" "redrawn/$name"
        # shellcheck disable=SC2086 # a command and an id
        expect 0 -- $study --verification "$figures/../verification" --budget paper --redraw --out "redrawn/$name"
        check "$name --redraw: other data" diff -r "$figures/$name/data" "redrawn/$name/data"
        [ -n "$(find "redrawn/$name" -name '*.png')" ] || fail "$name --redraw: no picture"
        # shellcheck disable=SC2086
        expect 2 "there is none" -- $study --verification "$figures/../verification" --budget paper --redraw --out nowhere
    done
    expect 0 -- report --figures tiny
    grep -q '^1 comparisons: 1 agree' out || fail "report: $(tail -1 out)"
    check "report: no table" test -s tiny/report.csv -a -s tiny/report.json

    # in three shards, each with a cache of its own: merged by copying, nothing runs again, and all is the same
    # but run times
    for k in 1 2 3; do
        expect 0 -- figure tiny tiny-too --verification definitions --budget paper --shard $k/3 --cache shard$k --out none
        [ "$(ls shard$k | wc -l)" -eq 2 ] || fail "--shard $k/3: not two of six runs in its cache"
        grep -q "^figures: shard $k/3: 2 of 6 runs, 0 of them were there" out || fail "--shard: says $(cat out)"
        mkdir -p merged && cp shard$k/*.h5 merged
    done
    [ ! -e none ] || fail "--shard: wrote figures"
    expect 0 -- figure tiny --verification definitions --budget paper --shard 1/1 --cache merged
    grep -q "6 of 6 runs, 6 of them were there" out || fail "--shard: a merged cache lacks runs: $(cat out)"
    touch -d 2000-01-01 merged/*
    for cache in merged whole; do
        expect 0 -- figure tiny --verification definitions --budget paper --cache $cache --out of-$cache
    done
    [ -z "$(find merged -newermt 2001-01-01 -name '*.h5')" ] || fail "--shard: ran again what the shards had done"
    without_times() { sed 's/; run time .*//' "$1/data/tiny.dat" | awk 'NF == 9 { $9 = "" } { print }'; }
    [ "$(without_times of-merged)" = "$(without_times of-whole)" ] || fail "--shard: other numbers than in one go"
    expect 2 --shard "4/3" "1 <= k <= n" -- figure tiny --verification definitions --shard 4/3
    sed -i 's/value = 1.0/value = 3.0/; s/tolerance = 0.2/tolerance = 0.1/' definitions/tiny/figure.toml
    call "${tiny[@]}"
    [ "$code" -eq 1 ] || fail "figure: exit code $code for a comparison that disagrees, expected 1"
    call "${redraw[@]}"
    [ "$code" -eq 1 ] || fail "--redraw: exit code $code for a comparison that disagrees, expected 1"
fi

# --- sizes, depths and lengths: by their key, before anything is taken -----------------------------------
expect 2 "box.length" bytes -- run scene.toml --set 'box.length=[1e12,2]' --set 'particles={number=10}'
expect 2 "box.length" bytes -- run scene.toml --set 'box.length=[2,1e12]' --set 'particles={number=10}'
expect 2 "box.length" -- run scene.toml --set 'box.length=[1e200,1e200]' --set 'particles={number=10}'
expect 2 "particles.number" bytes -- run scene.toml --set 'particles={number=999999999}'
expect 2 "velocity_autocorrelation.longest" bytes -- run scene.toml --set time.duration=1e11 \
    --set sample.velocity_autocorrelation.longest=1e10
expect 2 "time.duration" "below one step" -- run scene.toml --set time.duration=0.01
many=$(printf '"drift",%.0s' {1..260})
expect 2 stages "1 to 250" -- run scene.toml --set "stages=[\"shardlow\",\"sample\",$many]"
expect 2 "nested" -- run scene.toml --set "$(printf 'a.%.0s' {1..3000})a=1"
{ printf 'a.%.0s' {1..100000}; echo 'a = 1'; } >deep.toml
expect 2 "nested" -- run deep.toml

# --- outputs that take nothing, inputs that are no files -------------------------------------------------
# what convert prints for dpdref runs with its comments opened, and with lines of one's own before and behind
for words in "lammps-dpd T=1 A=25 gamma=4.5 timestep=0.02" "mirheo a=25 gamma=4.5 kBT=1 power=0.75"; do
    expect 0 -- convert ${words%% *} dpdref ${words#* }
    sed 's/^# \(.* = .*\)/\1/; s/number = 3000/number = 50/' out >converted.toml
    expect 0 -- run converted.toml
    expect 0 -- convert ${words%% *} dpdref ${words#* }
    { echo "dimension = 2"; cat out; echo "box.length = [5.0, 5.0]"; echo "particles.number = 50"
      echo "time.duration = 0.2"; echo "time.step = 0.02"; } | awk '!/^time.step/ || !seen++' >converted.toml
    expect 0 -- run converted.toml
done
# the exact answers in another order of the pairs
definitions=$figures/../verification
expect 0 -- exact --verification "$definitions" --json --order 2-3,1-3,1-2,0-3,0-2,0-1
check "exact --order is no JSON" is_json out
echo "2-3 1-3 1-2 0-3 0-2 0-1" >order.txt
cp out by_argument
expect 0 -- exact --verification "$definitions" --json --order order.txt
check "exact --order FILE differs" cmp -s out by_argument
expect 2 order "2-3 is missing" -- exact --verification "$definitions" --order 0-1,0-2,0-3,1-2,1-3
expect 2 order "'0+1' is no pair" -- exact --verification "$definitions" --json --order 0+1

for arguments in "run scene.toml" "run scene.toml --json" "theory" "convert"; do
    # shellcheck disable=SC2086
    "$dpdref" $arguments >/dev/full 2>err
    [ $? -eq 2 ] && [ "$(wc -l <err)" -eq 1 ] || fail "$arguments > /dev/full: $(cat err)"
    # shellcheck disable=SC2086
    "$dpdref" $arguments >&- 2>err
    [ $? -eq 2 ] && [ "$(wc -l <err)" -eq 1 ] || fail "$arguments >&-: $(cat err)"
done
expect 2 "a file or a pipe" -- run /dev/zero
expect 2 "regular" -- run scene.toml --out /dev/null
"$dpdref" run <(cat scene.toml) --json >out 2>err || fail "run of a pipe: $(cat err)"

# --- signals: a hangup makes a checkpoint, a pipe without end is left within seconds -----------------------
"$dpdref" run scene.toml --set time.duration=1e6 --out hup.h5 >/dev/null 2>err &
sleep 1
kill -HUP $! && wait $!
[ $? -eq 130 ] && grep -q "interrupted at step" err && [ -s hup.h5 ] || fail "SIGHUP: $(cat err)"
mkfifo pipe
"$dpdref" run pipe >/dev/null 2>err &
reader=$!
sleep 60 >pipe &
writer=$!
sleep 1
kill -TERM $reader
SECONDS=0
wait $reader
[ $? -eq 130 ] && [ "$(wc -l <err)" -eq 1 ] || fail "SIGTERM while a pipe is read: $(cat err)"
[ "$SECONDS" -lt 30 ] || fail "SIGTERM while a pipe is read: took $SECONDS s"
kill $writer

# --- files that are not what they were, or another's ----------------------------------------------------
for name in lag_empty obs_nl; do gunzip -c "$data/$name.h5.gz" >$name.h5; done
expect 2 "lag has 200 values" -- compare lag_empty.h5 --answer s1-0.02 --answers "$answers"
expect 2 "not all are numbers" -- compare obs_nl.h5 --answer s1-0.02 --answers "$answers"
for format in "" --json; do
    # shellcheck disable=SC2086
    expect 2 "UTF-8" -- compare "$data/json_bad_utf8.log" --answer s1-0.02 --answers "$answers" $format
done
printf 'quantity,value,error\nkinetic_temperature,1.0,0.05\n' >values.csv
expect 0 -- run scene.toml --set sample.profile.bins=10 --out rank16.h5
if /usr/bin/python3 -c 'import h5py' 2>/dev/null; then
    check "a result's profile gets sixteen axes" /usr/bin/python3 -B "$trials/rank.py" rank16.h5
    call compare values.csv --reference rank16.h5
    grep -q "density_profile/sum: is no table.*made again" err || fail "a profile of sixteen axes: $(cat err)"
    [ "$code" -eq 0 ] || fail "a profile of sixteen axes: exit code $code"
fi
with_trajectory=(run scene.toml --set trajectory.interval=10 --json)
expect 0 -- "${with_trajectory[@]}" --out t.h5
numbers out >whole.json
cp scene.toml other.h5md
expect 2 other.h5md "not the trajectory" -- "${with_trajectory[@]}" --out other.h5
cmp -s scene.toml other.h5md || fail "a file that is no trajectory of the run was changed"
rm t.h5md
"$dpdref" "${with_trajectory[@]}" --out t.h5 >out 2>err || fail "a trajectory that is gone: $(cat err)"
grep -q "warning: t.h5md: is gone" err || fail "a trajectory that is gone is not said: $(cat err)"
printf 'x' | dd of=t.h5 bs=1 seek=1000 conv=notrunc status=none
"$dpdref" "${with_trajectory[@]}" --out t.h5 >out 2>err || fail "a damaged result: $(cat err)"
grep -q "damaged" err && [ "$(wc -l <err)" -eq 1 ] || fail "a damaged result is not said: $(cat err)"
numbers out | cmp -s - whole.json || fail "a damaged result: other numbers"
check "a damaged result was not kept" test -s t.h5.damaged -a -s t.h5md

# --- two processes on one file: one waits, both have the numbers ------------------------------------------
for k in 1 2; do
    "$dpdref" run scene.toml --set time.duration=100 --out shared.h5 --json >out$k 2>err$k || fail "two processes: $(cat err$k)" &
done
wait %1 %2 2>/dev/null; wait
numbers out1 >both.json
numbers out2 | cmp -s - both.json || fail "two processes on one file: other numbers"
[ "$(cat err1 err2 | wc -l)" -le 1 ] || fail "two processes on one file: $(cat err1 err2)"

[ "$failures" -eq 0 ] && echo "all checks passed"
exit $((failures > 0))
