#!/usr/bin/env python3
"""Runs `penetration` with inputs that differ in their last bits, and looks whether all runs end and how far their measures are apart.

    check_last_bits.py PROGRAM [--methods patino default] [--runs N] [--jobs N] [--set KEY=VALUE]... [--keep FOLDER]

A disc through a plate at 6 km/s is chaotic: what the last bits of its inputs change has grown to the size of a particle long before the end. Whether a
run ends, and what its crater and its cloud are, must not depend on them. Run number k has its disc shifted by k billionths of a micrometre (1e-12 of its
radius), and takes the precisions and the instruction sets of the processor (`SPHORGE_INSTRUCTIONS`) in turn. Exit code 1 if a run does not end,
or if crater, length or width of the cloud differ by more than 2 % of their mean over the runs of a method. `--set` adds to every run, such as a coarser spacing.

Needs Python 3.9 and nothing else.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

METHODS = {
    "patino": [],
    # What the deck has of the method of the paper goes.
    "default": ["method=total-lagrangian", "search=total-lagrangian", "numerics.viscosity=true", "numerics.temperature=plastic-work"],
}
PRECISIONS = ["mixed", "double"]
# On a processor that has less these are what it has.
INSTRUCTIONS = ["avx512", "avx2", "scalar"]
JUDGED = ["crater_diameter", "cloud_length", "cloud_width"]
SHOWN = JUDGED + ["crater_lips", "max_temperature"]
MOST_APART = 0.02


def run(program, folder, method, k, overrides):
    precision, instructions = PRECISIONS[k % 2], INSTRUCTIONS[k % 3]
    out = folder / f"{method}-{k}"
    disc = f'body.1.shape={{ disc = {{ centre = ["{k * 5e-15!r} m", "5 mm"], radius = "5 mm" }} }}'
    sets = [disc, f"numerics.precision={precision}", "output.frames=1", *METHODS[method], *overrides]
    command = [program, "run", "penetration", "-o", str(out), "--threads", "1", "--overwrite"] + [word for one in sets for word in ("--set", one)]
    start = time.monotonic()
    ended = subprocess.run(command, capture_output=True, text=True, env=os.environ | {"SPHORGE_INSTRUCTIONS": instructions})
    summary = json.loads((out / "summary.json").read_text()) if (out / "summary.json").exists() else {}
    status, measures = summary.get("status", "did not start"), summary.get("measures", {})
    shown = "".join(f" {measures.get(of) or float('nan'):11.6g}" for of in SHOWN)
    print(
        f"{method:8s} {k:2d} {precision:6s} {instructions:7s}{shown} {summary.get('steps', 0):7d} {summary.get('repeated_steps', 0):5d}"
        f" {time.monotonic() - start:6.0f} s  {status}: {', '.join(warning['name'] for warning in summary.get('warnings', []))}",
        flush=True,
    )
    if ended.returncode != 0:
        print(ended.stderr.strip()[-800:], flush=True)
    return status.startswith("completed"), measures


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program", help="the binary")
    parser.add_argument("--methods", nargs="+", choices=METHODS, default=list(METHODS))
    parser.add_argument("--runs", type=int, default=10, metavar="N", help="of each method")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, metavar="N", help="runs at a time")
    parser.add_argument("--set", action="append", default=[], dest="overrides", metavar="KEY=VALUE")
    parser.add_argument("--keep", type=Path, metavar="FOLDER", help="keep the folders of the runs there")
    arguments = parser.parse_args()
    program = str(Path(arguments.program).resolve())
    cases = [(method, k) for method in arguments.methods for k in range(arguments.runs)]
    print(f"method    k precision instructions {' '.join(SHOWN)} steps repeated")
    with tempfile.TemporaryDirectory() as temporary, ThreadPoolExecutor(arguments.jobs) as pool:
        folder = arguments.keep or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        results = dict(zip(cases, pool.map(lambda case: run(program, folder, *case, arguments.overrides), cases)))
    is_right = True
    for method in arguments.methods:
        ended = [measures for (of, _), (has_ended, measures) in results.items() if of == method and has_ended]
        print(f"\n{method}: {len(ended)} of {arguments.runs} runs ended")
        is_right &= len(ended) == arguments.runs
        for measure in SHOWN:
            values = [measures[measure] for measures in ended if measures.get(measure) is not None]
            if len(values) < 2:
                continue
            mean = statistics.mean(values)
            apart, deviation = (max(values) - min(values)) / mean, statistics.stdev(values) / mean
            print(f"  {measure:16s} mean {mean:.6g}, {min(values):.6g} to {max(values):.6g}: {apart:.2%} apart, standard deviation {deviation:.2%}")
            is_right &= measure not in JUDGED or apart <= MOST_APART
    return 0 if is_right else 1


if __name__ == "__main__":
    sys.exit(main())
