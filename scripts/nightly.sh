#!/usr/bin/env bash
# What takes too long for every change, or draws at random: run whole before a release and after a change of numerics, on an idle machine.
#
#     scripts/nightly.sh [cuda|vulkan|ranks|physics|mutations|attacks|fuzz|decks|guide|validate]...     all of them without a name, some hours on two cores
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

jobs=(cuda vulkan ranks physics mutations attacks fuzz decks guide validate)
for job in "$@"; do
    if [[ " ${jobs[*]} " != *" $job "* ]]; then
        echo "no job \`$job\`: there are ${jobs[*]}" >&2
        exit 2
    fi
done
[ $# = 0 ] || jobs=("$@")
cargo build --release --locked --quiet
sphorge=target/release/sphorge

for job in "${jobs[@]}"; do
    printf '\n== %s\n' "$job"
    case $job in
        # Every model by CUDA, whose driver and compiler are stood in for.
        cuda)
            scripts/cuda_stand_in.sh target/nightly/cuda-stand-in
            LD_LIBRARY_PATH="$PWD/target/nightly/cuda-stand-in" STAND_IN_CACHE="$PWD/target/nightly/cuda-kernels" SPHORGE_NEEDS_CARD=CUDA \
                cargo test -p sphorge-gpu --features device --lib --locked
            ;;
        # Every model on Vulkan, that of a card or of the software renderer.
        vulkan) SPHORGE_NEEDS_CARD=Vulkan cargo test -p sphorge-gpu --features device --lib --locked ;;
        # Every number of ranks, and the tests of physics that take long.
        ranks) SPHORGE_ALL_RANKS=yes cargo test -p sphorge-mpi --test same_bits --locked ;;
        physics) cargo test -p sphorge --test physics --locked -- --ignored ;;
        # Shipped decks with slips, other ones each time.
        mutations) PROPTEST_CASES=20000 cargo test -p sphorge-cli --test mutations --locked ;;
        attacks)
            for kind in damaged forged decks; do
                python3 scripts/attack_runs.py "$kind" $sphorge 300
            done
            ;;
        fuzz) scripts/fuzz.sh 300 ;;
        # Inputs that differ in their last bits, and what is shipped as it is shipped.
        decks) python3 scripts/check_last_bits.py $sphorge && python3 scripts/check_decks.py $sphorge ;;
        # What the pages show, against what their commands print and compute.
        guide) python3 scripts/guide_runs.py $sphorge ;;
        validate) $sphorge validate --resume -o target/nightly/validate ;;
    esac
done
