"""Round bars of steel with and without a notch, pulled, in explicit finite elements: force, plastic strain and triaxiality in their middle.

    python3 reference/finite-elements/notched_bar.py       # needs numpy; one process, ten minutes; writes notched_bar.json beside this file

The elements are those of `tensile_bar.py`, axisymmetric, without damage: what a law of damage makes of a history of plastic strain and
triaxiality is an integral, and until it is one the law changes nothing.
"""

import json
import sys
import time
from pathlib import Path

import numpy as np

from strength import JohnsonCook
from tensile_bar import constant, solve

# Weldox 460 E as in the deck `notched-bars`, linear pressure.
STEEL = dict(rho=7750.0, G=211e9 / 2.66, strength=JohnsonCook(499e6, 382e6, 0.458, 0.0, 1.0, 293.15, 1e9), T0=293.15, Cp=460.0, beta=0.0)
BULK = 211e9 / (3 * (1 - 2 * 0.33))
STEEL |= {"K": BULK, "pressure": lambda compression, energy: BULK * (compression - 1)}
NARROW, WIDE = 3e-3, 5e-3


def notched(notch):
    def radius(z):
        end = np.sqrt(notch**2 - (NARROW + notch - WIDE) ** 2)
        return np.where(z < end, NARROW + notch - np.sqrt(np.maximum(notch**2 - z**2, 0)), WIDE)

    return radius


def smooth(z):
    return np.interp(z, [0.0, 6e-3, 8e-3, 10e-3], [NARROW, NARROW, WIDE, WIDE])


# Name, radius, end.
BARS = [("smooth", smooth, 0.8e-3), ("notch of 6 mm", notched(6e-3), 0.2e-3), ("notch of 2 mm", notched(2e-3), 0.12e-3)]
COLUMNS = ["elongation", "force", "plastic_strain", "triaxiality"]
MESHES = [(6, 20), (12, 40)]


if __name__ == "__main__":
    path = Path(__file__).with_suffix(".json")
    bars = {name: [] for name, _, _ in BARS}
    for mesh in MESHES:
        for name, radius, end in BARS:
            began = time.time()
            row = solve(STEEL, 10e-3, radius, 9e-3, constant(4.0), end, mesh[0], mesh[1], True, rows=80, triaxial=True)
            history = [[round(10e-3 * h[1], 9), round(h[2], 1), round(h[3], 6), round(h[7], 5)] for h in row["history"]]
            print(name, mesh, history[-1], row["steps"], "steps", f"{time.time() - began:.0f} s", flush=True, file=sys.stderr)
            bars[name].append({"elements": list(mesh), "history": history})
            result = {"command": "python3 reference/finite-elements/notched_bar.py", "columns": COLUMNS}
            result |= {"units": "SI; elongation of half of the bar"}
            result |= {"bars": [{"name": of, "meshes": meshes} for of, meshes in bars.items()]}
            path.write_text(json.dumps(result) + "\n")
