#!/usr/bin/env bash
# Fuzzes the readers of all texts and files that a user can pass to Sphorge: fuzz.sh SECONDS [TARGET...]
#
# Builds the targets of the folder `fuzz` with stable Rust and a C++ compiler (libFuzzer comes with the crate libfuzzer-sys) and runs
# them one after the other for the given number of seconds each, starting from the shipped decks, the corpus of bad decks, the files of a
# tiny run and the inputs found earlier. Prints executions, coverage and crashes. Inputs that crash a target are in fuzz/artifacts/TARGET;
# the exit code is then 1.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../fuzz"

seconds=${1:?usage: scripts/fuzz.sh SECONDS [TARGET...]}
shift
targets=("$@")
[ ${#targets[@]} -gt 0 ] || targets=(deck table frame history checkpoint)

host=$(rustc -vV | sed -n 's/^host: //p')
export RUSTFLAGS="--cfg fuzzing -C passes=sancov-module -C llvm-args=-sanitizer-coverage-level=4 \
-C llvm-args=-sanitizer-coverage-inline-8bit-counters -C llvm-args=-sanitizer-coverage-pc-table \
-C llvm-args=-sanitizer-coverage-trace-compares"
# With a target named, the flags are not those of build scripts.
cargo build --release --locked --target "$host" --bins
programs=${CARGO_TARGET_DIR:-target}/$host/release

crashed=0
for target in "${targets[@]}"; do
    corpus=corpus/$target artifacts=artifacts/$target log=artifacts/$target.log
    mkdir -p "$corpus" "$artifacts"
    if [ "$target" = deck ]; then
        cp ../decks/*.toml ../crates/sphorge-deck/corpus/*.toml "$corpus"
    elif [ "$target" = table ]; then
        # The first byte chooses the plane.
        for file in ../crates/sphorge-deck/corpus/*.csv; do
            { printf '\001' && cat "$file"; } >"$corpus/$(basename "$file")"
        done
    fi
    status=0
    SPHORGE_FUZZ_SEEDS=$corpus "$programs/$target" "$corpus" -max_total_time="$seconds" -artifact_prefix="$artifacts/" \
        -print_final_stats=1 -rss_limit_mb=4096 -timeout=60 -max_len=16384 >"$log" 2>&1 || status=$?
    # Every process leaves its folder behind.
    rm -rf /dev/shm/sphorge-fuzz-"$target"-* "${TMPDIR:-/tmp}"/sphorge-fuzz-"$target"-*
    executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
    coverage=$(grep -o 'cov: [0-9]*' "$log" | tail -n 1)
    printf '%-11s %10s executions, %s edges, %s\n' "$target" "${executions:-?}" "${coverage#cov: }" \
        "$([ $status = 0 ] && echo 'no crash' || echo "CRASH: see fuzz/$log and fuzz/$artifacts")"
    [ $status = 0 ] || crashed=1
done
exit $crashed
