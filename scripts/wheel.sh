#!/usr/bin/env bash
# Builds the package for Python, a wheel with the command line in it, and tests it in a fresh environment.
#
#     scripts/wheel.sh [--profile PROFILE] [--manylinux] [--no-tests]
#
# The wheel comes to target/wheel/dist. With --manylinux it runs on any Linux of the last ten years (glibc 2.17), for which it is linked by Zig and compiled
# anew; otherwise on systems with a glibc not older than that of this machine. Needs Rust and Python 3.10 or later; fetches maturin, numpy and pytest.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

work=$PWD/target/wheel
profile=release options=() tools=("maturin>=1.9,<2") tests=yes
while [ $# -gt 0 ]; do
    case $1 in
        --profile) profile=$2 && shift ;;
        --manylinux) options=(--zig --compatibility manylinux2014) tools+=("maturin[zig]") ;;
        --no-tests) tests= ;;
        *) sed -n '2,8s/^# \{0,1\}//p' "$0" && exit 2 ;;
    esac
    shift
done

# environment FOLDER PACKAGE...: a Python of its own with these packages.
environment() {
    [ -x "$1/bin/python" ] || python3 -m venv "$1"
    "$1/bin/python" -m pip install --quiet --disable-pip-version-check "${@:2}"
}

environment "$work/tools" "${tools[@]}"
rm -rf "$work/dist"
# Its own Python finds Zig.
PATH="$work/tools/bin:$PATH" maturin build --manifest-path crates/sphorge-py/Cargo.toml --locked --quiet --profile "$profile" --out "$work/dist" \
    -i "$work/tools/bin/python" "${options[@]}"
ls -l "$work/dist"
[ -n "$tests" ] || exit 0

rm -rf "$work/fresh"
environment "$work/fresh" "$work"/dist/sphorge-*.whl pytest
# From the tests alone: the sources of the package are not in the way of what is installed.
"$work/fresh/bin/python" -m pytest -c crates/sphorge-py/pyproject.toml --rootdir crates/sphorge-py/tests -p no:cacheprovider crates/sphorge-py/tests
"$work/fresh/bin/sphorge" --version
