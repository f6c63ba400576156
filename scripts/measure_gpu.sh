#!/usr/bin/env bash
# Runs all measurements on a graphics card in one call, with a program built elsewhere; writes results.json and results.md.
#
# usage: measure_gpu.sh --program FILE [--out FOLDER] [--device WORDS] [--nvrtc FOLDER] [--tests FILE] [--seconds N] [--small] [PART...]
#
#   --program   `sphorge`, built with `cargo build --release --features gpu`
#   --out       folder for all results; parts add to existing ones [default: out/measure-gpu]
#   --device    words of the name of the card [default: the first that `sphorge devices` lists]
#   --nvrtc     folder with NVIDIA's compiler (libnvrtc.so.*, libnvrtc-builtins.so.*), if it is not installed on the machine
#   --tests     tests of the crate, built with `cargo test -p sphorge-gpu --features device --release --no-run`
#   --seconds   time of each measurement of speed [default: 4]
#   --small     sizes that a software renderer computes in a minute, to test this script
#
# Parts (default: all):
#   devices     the cards that are available
#   tests       parity of laws, pair sums and whole runs with the processor, if --tests is given
#   bullet      the bullet of the paper with every strategy
#   processor   the same with the CPU engine, for the residual velocity
#   speed       particle-steps per second of 2e5 and 2e6 particles, time of each kernel and its share of the peak of the card
#   large       the same with 1e7 particles, with a search every step and a skin
#   cases       the other cases of `sphorge bench`
#   vulkan      the speed of 2e5 and 2e6 particles through Vulkan, for a card that also supports CUDA
#
# Needs bash and awk, no network.
set -uo pipefail

program='' out=out/measure-gpu device='' tests='' small=0 seconds=4 parts=()
usage() { awk 'NR > 1 && !/^#/ { exit } NR > 1 { sub(/^# ?/, ""); print }' "${BASH_SOURCE[0]}"; }
fail() { echo "$1" >&2; exit 2; }
while [ $# -gt 0 ]; do
    case $1 in
        --program | --out | --device | --nvrtc | --tests | --seconds)
            [ $# -ge 2 ] || fail "$1 wants a value"
            case $1 in
                --program) program=$2 ;;
                --out) out=$2 ;;
                --device) device=$2 ;;
                --nvrtc) export SPHORGE_NVRTC=$2 ;;
                --tests) tests=$2 ;;
                --seconds) seconds=$2 ;;
            esac
            shift 2
            ;;
        --small) small=1; shift ;;
        -h | --help) usage; exit 0 ;;
        devices | tests | bullet | processor | speed | large | cases | vulkan) parts+=("$1"); shift ;;
        *) usage >&2; fail "unknown argument: $1" ;;
    esac
done
[ -x "$program" ] || fail "--program names no program: '$program'"
[ ${#parts[@]} -gt 0 ] || parts=(devices tests bullet processor speed large cases vulkan)
mkdir -p "$out"
# Mesa's drivers write what is of no use here.
export NODEVICE_SELECT=1

card=(--engine gpu)
[ -z "$device" ] || card+=(--device "$device")

# Every strategy of the table of docs/adaptive-search.md: its name, and `search`.
strategies=(
    'every-step|"every-step"'
    'skin|"skin"'
    'guarded-1e-4|{ adaptive = { plastic-strain-threshold = 1e-4 } }'
    'guarded-1e-5|{ adaptive = { plastic-strain-threshold = 1e-5 } }'
    'guarded-1e-6|{ adaptive = { plastic-strain-threshold = 1e-6 } }'
    'published-1e-4|{ adaptive = { plastic-strain-threshold = 1e-4, guard = "none" } }'
    'published-1e-5|{ adaptive = { plastic-strain-threshold = 1e-5, guard = "none" } }'
    'frozen|{ total-lagrangian = { form = "frozen" } }'
)
bullet=(--set output.frames=2)
# Spacings of the block that make 2e5, 2e6 and, the largest, 1e7 particles of it.
spacings=('1 mm' '0.46 mm') largest='0.27 mm'
if [ $small = 1 ]; then
    bullet+=(--set 'particles.spacing="24 mm"' --set 'body.1.spacing="12 mm"' --set 'time.end="60 us"')
    spacings=('6 mm' '4 mm') largest='3 mm' seconds=0.2
fi

# is_done FILE: whether a run has reached its end, as its summary says.
is_done() {
    case $(text "$1" status 2>/dev/null) in completed*) return 0 ;; *) return 1 ;; esac
}

# run_bullets FOLDER ENGINE...: the bullet by every strategy; what is there already is kept, what fails is told and left out.
run_bullets() {
    local folder=$out/$1 row name search
    shift
    mkdir -p "$folder"
    for row in "${strategies[@]}"; do
        name=${row%%|*} search=${row#*|}
        is_done "$folder/$name/summary.json" && continue
        echo "  $name"
        "$program" run bullet "$@" "${bullet[@]}" --set "search=$search" --overwrite -o "$folder/$name" >"$folder/$name.txt" 2>&1 ||
            { echo "    failed:"; tail -n 5 "$folder/$name.txt"; }
    done
}

# bench NAME ARGUMENT...: one call of `sphorge bench`, whose numbers go to NAME.json and whose progress to NAME.txt.
bench() {
    local name=$out/bench-$1
    shift
    "$program" bench "$@" --seconds $seconds --json >"$name.json.part" 2>"$name.txt" && mv "$name.json.part" "$name.json" ||
        { echo "    failed:"; tail -n 5 "$name.txt"; rm -f "$name.json.part"; }
}

# by_size PREFIX ARGUMENT...: the block in all sizes but the largest.
by_size() {
    local prefix=$1 spacing
    shift
    for spacing in "${spacings[@]}"; do
        echo "  block, $spacing"
        bench "$prefix-${spacing%% *}mm" block "$@" --set "particles.spacing=\"$spacing\""
    done
}

devices() {
    "$program" devices >"$out/devices.txt" 2>&1
    cat "$out/devices.txt"
    ! command -v nvidia-smi >/dev/null || nvidia-smi --query-gpu=name,driver_version,memory.total,clocks.max.sm,power.limit --format=csv | tee "$out/nvidia-smi.csv"
}
tests() {
    [ -n "$tests" ] || { echo "  none given"; return; }
    # Of a software renderer the laws and two whole runs.
    local only=()
    [ $small = 0 ] || only=(laws the_leapfrog a_melt)
    # In several processes, whose compilers do not wait for one another; each takes every n-th test.
    local shards k names
    shards=$((($(nproc) + 1) / 2))
    for ((k = 0; k < shards; k++)); do
        mapfile -t names < <("$tests" --list "${only[@]}" 2>/dev/null | sed -n 's/: test$//p' | awk -v n=$shards -v k=$k 'NR % n == k')
        [ ${#names[@]} = 0 ] ||
            SPHORGE_NEEDS_CARD=any timeout 590 "$tests" --test-threads 2 --exact "${names[@]}" >"$out/tests-$k.txt" 2>&1 &
    done
    wait
    cat "$out"/tests-*.txt >"$out/tests.txt"
    rm "$out"/tests-*.txt
    grep -E '^test .*FAILED|panicked' "$out/tests.txt"
    awk '/^test .* \.\.\. ok$/ { ok++ } /^test .* \.\.\. FAILED$/ { failed++ } /^test result/ { ended++ }
        END { printf "test result: %d passed, %d failed; %d of '$shards' processes ended\n", ok, failed, ended }' "$out/tests.txt" |
        tee -a "$out/tests.txt"
}
bullet() { run_bullets bullet "${card[@]}"; }
processor() { run_bullets processor --engine cpu; }
speed() { by_size speed "${card[@]}"; }
large() {
    echo "  block, $largest"
    bench "speed-${largest%% *}mm" block "${card[@]}" --strategy every-step --strategy skin --set "particles.spacing=\"$largest\""
}
cases() {
    local coarse=()
    # The sets are of all cases: coarse ones are those that have such a key.
    [ $small = 0 ] || coarse=(--strategy skin)
    for case in taylor-bar penetration bullet; do
        [ $small = 0 ] || [ $case = penetration ] || continue
        echo "  $case"
        bench "case-$case" $case "${card[@]}" "${coarse[@]}"
    done
}
vulkan() {
    # The name of a card that Vulkan reaches, in the table of `sphorge devices`.
    if ! "$program" devices 2>/dev/null | awk -F '┆' '$2 ~ /Vulkan/ && ($4 ~ /card/ || '$small') { found = 1 } END { exit !found }'; then
        echo "  no card is reached by Vulkan"
        return
    fi
    by_size vulkan --engine gpu --device vulkan
}

# number FILE KEY: the first number of that name.
number() { awk -F '[:,]' -v key="\"$2\"" 'index($1, key) { gsub(/ /, "", $2); print $2; exit }' "$1"; }
# text FILE KEY: the first text of that name.
text() { awk -F '"' -v key="$2" '$2 == key { print $4; exit }' "$1"; }

# Runs of the bullet as rows of a table: card and processor.
bullet_table() {
    local row name own other every='' seconds speed_up velocity beside difference
    echo "| search | time s | speed-up | searched | steps | velocity left m/s | on the processor | difference | time there s |"
    echo "|---|---|---|---|---|---|---|---|---|"
    for row in "${strategies[@]}"; do
        name=${row%%|*} own=$out/bullet/$name/summary.json other=$out/processor/$name/summary.json
        is_done "$own" || { echo "| $name | did not run | | | | | | | |"; continue; }
        seconds=$(stages "$own")
        [ $name != every-step ] || every=$seconds
        speed_up=$(awk -v a="$every" -v b="$seconds" 'BEGIN { if (a != "") printf "%.2f", a / b }')
        velocity=$(number "$own" residual_velocity) beside='' difference=''
        if is_done "$other"; then
            beside=$(number "$other" residual_velocity)
            difference=$(awk -v a="$velocity" -v b="$beside" 'BEGIN { printf "%+.2f %%", 100 * (a / b - 1) }')
        fi
        printf '| %s | %.2f | %s | %.1f %% | %s | %.2f | %s | %s | %s |\n' $name "$seconds" "$speed_up" \
            "$(awk -v s="$(number "$own" searched_fraction)" 'BEGIN { print 100 * s }')" "$(number "$own" steps)" "$velocity" \
            "$([ -z "$beside" ] || printf %.2f "$beside")" "$difference" "$([ ! -s "$other" ] || stages "$other")"
    done
}

# Seconds of the steps of a run, without output.
stages() {
    awk -F '[:,]' '/"stage_seconds"/ { inside = 1; next } inside && /}/ { exit } inside && !/"output"/ { sum += $2 } END { printf "%.2f", sum }' "$1"
}

# The rows of calls of `sphorge bench`, one table for all.
bench_table() {
    echo "| measured | case | search | particles | neighbours | million particle-steps/s | bytes a particle | device |"
    echo "|---|---|---|---|---|---|---|---|"
    local file
    for file in "$out"/bench-*.json; do
        [ -s "$file" ] || continue
        awk -v name="$(basename "$file" .json)" '
            function value(line) { sub(/^[^:]*: /, "", line); sub(/,$/, "", line); gsub(/"/, "", line); return line }
            /"skipped"/ { exit }
            /^      "case"/ { of["case"] = value($0) }
            /^      "search"/ { of["search"] = value($0) }
            /^      "particles"/ { of["particles"] = value($0) }
            /^      "mean_neighbors"/ { of["neighbors"] = value($0) }
            /^      "particle_steps_per_second_per_core"/ { of["rate"] = value($0) }
            /^      "bytes_per_particle"/ { of["bytes"] = value($0) }
            /^      "device"/ {
                printf "| %s | %s | %s | %d | %.1f | %.3f | %.0f | %s |\n", substr(name, 7), of["case"], of["search"], of["particles"], of["neighbors"],
                    of["rate"] / 1e6, of["bytes"], value($0)
            }' "$file"
    done
}

# The kernels of every measurement.
kernel_tables() {
    local file
    for file in "$out"/bench-*.json; do
        [ -s "$file" ] || continue
        awk -v name="$(basename "$file" .json)" '
            function value(line) { sub(/^[^:]*: /, "", line); sub(/,$/, "", line); gsub(/"/, "", line); return line }
            function share(text) { return text == "null" ? "-" : sprintf("%.1f", 100 * text) }
            /"skipped"/ { exit }
            /^      "case"/ { case_ = value($0) }
            /^      "search"/ { search = value($0) }
            /^      "kernels"/ {
                printf "\n%s: %s, %s\n\n| kernel | launches a step | us | %% of time | %% of bandwidth | %% of arithmetic |\n|---|---|---|---|---|---|\n", substr(name, 7), case_, search
            }
            /^          "kernel"/ { of["kernel"] = value($0) }
            /^          "launches_per_step"/ { of["launches"] = value($0) }
            /^          "seconds"/ { of["seconds"] = value($0) }
            /^          "share"/ { of["share"] = value($0) }
            /^          "share_of_bandwidth"/ { of["bandwidth"] = value($0) }
            /^          "share_of_arithmetic"/ {
                printf "| %s | %.2f | %.1f | %.1f | %s | %s |\n", of["kernel"], of["launches"], 1e6 * of["seconds"], 100 * of["share"], share(of["bandwidth"]), share(value($0))
            }' "$file"
    done
}

# What the card can do, of the first measurement that has it.
limits() {
    local file
    for file in "$out"/bench-*.json; do
        grep -q '"operations_per_second"' "$file" 2>/dev/null || continue
        printf '%s: copies %.0f GB/s, %.2f tera-operations/s by products that are added to something, a launch that is waited for takes %.1f us.\n' \
            "$(awk -F '"' '/"card": {/ { inside = 1 } inside && $2 == "name" { print $4; exit }' "$file")" \
            "$(awk -v x="$(number "$file" bytes_per_second)" 'BEGIN { print x / 1e9 }')" \
            "$(awk -v x="$(number "$file" operations_per_second)" 'BEGIN { print x / 1e12 }')" \
            "$(awk -v x="$(number "$file" launch_seconds)" 'BEGIN { print x * 1e6 }')"
        return
    done
}

write_markdown() {
    echo "# Measured on a graphics card"
    echo
    echo "$("$program" --version), $(date -u +%Y-%m-%d)$([ $small = 0 ] || echo ', small sizes')."
    [ ! -s "$out/devices.txt" ] || { echo; echo '```'; cat "$out/devices.txt"; echo '```'; }
    [ ! -s "$out/tests.txt" ] || { echo; echo "Tests: $(grep '^test result' "$out/tests.txt" | tail -n 1)"; }
    echo; echo "## The bullet of the paper"; echo
    bullet_table
    echo; echo "## Speed"; echo
    limits
    echo
    bench_table
    echo; echo "## Kernels"
    kernel_tables
}

write_json() {
    local file separator
    echo '{'
    printf '"date": "%s",\n"small": %s,\n' "$(date -u +%Y-%m-%dT%H:%M:%SZ)" "$([ $small = 1 ] && echo true || echo false)"
    for kind in bullet processor; do
        printf '"%s": {' $kind
        separator=''
        for file in "$out/$kind"/*/summary.json; do
            [ -s "$file" ] || continue
            printf '%s\n"%s": ' "$separator" "$(basename "$(dirname "$file")")"
            cat "$file"
            separator=,
        done
        printf '},\n'
    done
    printf '"bench": {'
    separator=''
    for file in "$out"/bench-*.json; do
        [ -s "$file" ] || continue
        printf '%s\n"%s": ' "$separator" "$(basename "$file" .json | cut -c7-)"
        cat "$file"
        separator=,
    done
    printf '}\n}\n'
}

for part in "${parts[@]}"; do
    started=$SECONDS
    echo "== $part"
    $part
    echo "== $part took $((SECONDS - started)) s"
    # What is there is written after each part: a call may be cut off.
    write_markdown >"$out/results.md"
    write_json >"$out/results.json"
done
echo "written: $out/results.md, $out/results.json"
