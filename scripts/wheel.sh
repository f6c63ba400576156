#!/usr/bin/env bash
# Builds the package for Python, a wheel with the command line in it, and tests it in a fresh environment.
#
#     scripts/wheel.sh [--profile PROFILE] [--manylinux] [--no-tests] [--extras] [--mpi]
#
# With --extras the tests of what other packages take (pandas, polars, pyarrow, xarray, pyvista, optuna; 1.5 GB with all they bring) are not skipped, and the notebooks of
# the documentation are executed. That of rerun, which takes half a gigabyte, is skipped unless it is in target/wheel/extras already.
# With --mpi a second package, with MPI and without optimisation, is built to target/wheel/mpi-dist, and its runs on ranks are tested, where MPI is installed.
#
# The wheel comes to target/wheel/dist. With --manylinux it runs on any Linux of the last ten years (glibc 2.17), for which it is linked by Zig and compiled
# anew; otherwise on systems with a glibc not older than that of this machine. Needs Rust and Python 3.10 or later; fetches maturin, numpy and pytest.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

work=$PWD/target/wheel
profile=release options=() tools=("maturin>=1.9,<2") tests=yes extras= mpi=
while [ $# -gt 0 ]; do
    case $1 in
        --profile) profile=$2 && shift ;;
        --manylinux) options=(--zig --compatibility manylinux2014) tools+=("maturin[zig]") ;;
        --no-tests) tests= ;;
        --extras) extras=yes ;;
        --mpi) mpi=yes ;;
        *) sed -n '2,12s/^# \{0,1\}//p' "$0" && exit 2 ;;
    esac
    shift
done

# environment FOLDER PACKAGE...: a Python of its own with these packages.
environment() {
    [ -x "$1/bin/python" ] || python3 -m venv "$1"
    "$1/bin/python" -m pip install --quiet --disable-pip-version-check "${@:2}"
}

environment "$work/tools" "${tools[@]}"
# wheel FOLDER PROFILE OPTION...: builds a wheel. Its own Python finds Zig.
wheel() {
    rm -rf "$1"
    PATH="$work/tools/bin:$PATH" maturin build --manifest-path crates/sphorge-py/Cargo.toml --locked --quiet --out "$1" --profile "$2" \
        -i "$work/tools/bin/python" "${@:3}"
}
wheel "$work/dist" "$profile" "${options[@]}"
ls -l "$work/dist"
[ -n "$tests" ] || exit 0

rm -rf "$work/fresh"
environment "$work/fresh" "$work"/dist/sphorge-*.whl pytest
# test_with ENVIRONMENT [FILE]...: from the tests alone, so that the sources of the package are not in the way of what is installed.
test_with() {
    local of=("${@:2}")
    [ ${#of[@]} -gt 0 ] || of=(.)
    "$1/bin/python" -m pytest -c crates/sphorge-py/pyproject.toml --rootdir crates/sphorge-py/tests -p no:cacheprovider "${of[@]/#/crates/sphorge-py/tests/}"
}
test_with "$work/fresh"
"$work/fresh/bin/sphorge" --version

# Runs on ranks by MPI itself. The program of the tests of ranks has been compiled so.
ranks() {
    if ! command -v mpirun >/dev/null || ! command -v mpicc >/dev/null; then
        echo "skipped: no MPI here (Debian: apt install openmpi-bin libopenmpi-dev libclang-dev)"
        return 0
    fi
    # The MPI of this machine is not copied into the package: `mpirun` has to be of the same.
    wheel "$work/mpi-dist" dev --features mpi --auditwheel skip
    rm -rf "$work/mpi"
    environment "$work/mpi" "$work"/mpi-dist/sphorge-*.whl pytest
    test_with "$work/mpi" test_ranks.py
}
[ -z "$mpi" ] || ranks
[ -n "$extras" ] || exit 0

environment "$work/extras" pytest pandas polars pyarrow xarray pyvista optuna nbclient ipykernel mypy
"$work/extras/bin/python" -m pip install --quiet --disable-pip-version-check --force-reinstall --no-deps "$work"/dist/sphorge-*.whl
# Those that take what other packages bring: the others have passed without them.
mapfile -t with_extras < <(cd crates/sphorge-py/tests && grep -l importorskip -- *.py)
test_with "$work/extras" "${with_extras[@]}"
"$work/extras/bin/python" -m mypy --strict --cache-dir="$work/mypy" crates/sphorge-py/python/sphorge
# What `import *` takes is pyo3's own list.
echo "sphorge._sphorge.__all__" >"$work/not-in-stubs"
(cd "$work" && extras/bin/python -m mypy.stubtest --allowlist not-in-stubs sphorge._sphorge)
"$work/extras/bin/python" scripts/notebooks.py --execute "$work/notebooks"
