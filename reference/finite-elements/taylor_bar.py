"""Taylor bars and the Taylor plate in finite elements (`solver.py`), each on several meshes.

    python3 reference/finite-elements/taylor_bar.py              # needs numpy; two processes; writes taylor_bar.json beside this file
    python3 reference/finite-elements/taylor_bar.py --missing    # runs only what is not in taylor_bar.json yet
    python3 reference/finite-elements/taylor_bar.py copper-bar 190 12 84    # prints one run: body, m/s, elements across the radius and along

Written for these checks alone, apart from Sphorge: what do the constants of a deck say, whatever the particles do?
"""

import json
import os
import re
import sys
import time
from multiprocessing import Pool
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
import numpy as np

from solver import solve
from strength import JohnsonCook, ZerilliArmstrongFcc


RESULT = Path(__file__).with_suffix(".json")


def mie_gruneisen(metal, sound_speed, slope, gruneisen, polynomial=False):
    """Pressure by compression (density over first) and specific energy: Hugoniot of Us = c + S Up, exact or to the third power."""
    stiffness = metal["rho"] * sound_speed**2

    def pressure(compression, energy):
        eta = compression - 1
        squeezed = np.maximum(eta, 0)
        if polynomial:
            over = slope - 1
            hugoniot = squeezed * (1 + squeezed * (1 + 2 * over + squeezed * (2 * over + 3 * over**2)))
        else:
            chi = squeezed / compression
            hugoniot = chi / (1 - slope * np.minimum(chi, 0.9 / slope)) ** 2
        cold = stiffness * (np.minimum(eta, 0) + hugoniot * (1 - 0.5 * gruneisen * squeezed))
        return cold + gruneisen * metal["rho"] * compression * energy

    return metal | {"K": stiffness, "pressure": pressure}


def metal(rho, G, Cp, strength, T0=293.15):
    """What the decks say of a metal, less its pressure law; 0.9 of the plastic work heats."""
    return dict(rho=rho, G=G, Cp=Cp, strength=strength, T0=T0, beta=0.9)


COPPER = metal(8960.0, 46e9, 383.0, JohnsonCook(90e6, 292e6, 0.31, 0.025, 1.09, 293.15, 1356.0))
COPPER = mie_gruneisen(COPPER, 3940.0, 1.49, 2.0)
COPPER_ZERILLI = metal(8930.0, 47.7e9, 383.0, ZerilliArmstrongFcc(65e6, 890e6, 0.0028, 0.000115))
COPPER_ZERILLI = mie_gruneisen(COPPER_ZERILLI, 3940.0, 1.489, 2.02)
IRON = metal(7890.0, 80e9, 452.0, JohnsonCook(175e6, 380e6, 0.32, 0.060, 0.55, 293.15, 1811.0))
IRON = mie_gruneisen(IRON, 3630.0, 1.80, 1.81, polynomial=True)
STEEL_4340 = metal(7830.0, 75.8e9, 477.0, JohnsonCook(792e6, 510e6, 0.26, 0.014, 1.03, 293.15, 1793.0))
STEEL_4340 = mie_gruneisen(STEEL_4340, 4578.0, 1.33, 1.67)
ALUMINIUM = metal(2703.0, 27.6e9, 885.0, JohnsonCook(324e6, 114e6, 0.42, 0.002, 1.34, 293.15, 933.6))
ALUMINIUM = mie_gruneisen(ALUMINIUM, 5240.0, 1.40, 1.97)
# The bar with published finite-element answers tells that these elements can be trusted.
STEEL = metal(7830.0, 206.9e9 / 2.6, 460.0, JohnsonCook(806e6, 614e6, 0.168, 0.0089, 1.1, 293.15, 1813.15))
STEEL |= {"K": 206.9e9 / 1.2, "pressure": lambda compression, energy: 206.9e9 / 1.2 * (compression - 1)}

# Metal, length, radius or half width, end of the run, axisymmetric.
BODIES = {
    "copper-bar": (COPPER, 0.0254, 0.00381, 90e-6, True),
    "taylor-bar-42crmo4": (STEEL, 0.0324, 0.0032, 80e-6, True),
    "taylor-plate": (IRON, 0.02546, 0.0038, 60e-6, False),
    "copper-zerilli-bar": (COPPER_ZERILLI, 0.0254, 0.00381, 90e-6, True),
    "iron-bar": (IRON, 0.0254, 0.00381, 90e-6, True),
    "4340-bar": (STEEL_4340, 0.0254, 0.00381, 90e-6, True),
    "4340-short-bar": (STEEL_4340, 0.0127, 0.00381, 90e-6, True),
    "6061-bar": (ALUMINIUM, 0.02347, 0.00381, 90e-6, True),
    # That of `external_forces.rs` among the tests.
    "block": (COPPER, 0.006, 0.003, 16e-6, False),
}
# Body, speed, friction, whether the wall lets go, meshes (elements across the radius and along the length).
CASES = [
    ("taylor-bar-42crmo4", 287.0, 0.0, False, [(6, 60), (12, 120), (24, 240)]),
    ("taylor-plate", 200.0, 0.0, False, [(5, 34), (8, 54), (12, 80)]),
    ("copper-bar", 130.0, 0.0, False, [(6, 42), (12, 84), (24, 168)]),
    ("copper-bar", 146.0, 0.0, False, [(6, 42), (12, 84), (24, 168)]),
    ("copper-bar", 190.0, 0.0, False, [(6, 42), (12, 84), (24, 168)]),
    # Elements twice as tall: those of the foot are pressed so flat that they set the step, and 24 x 96 turn inside out at 300 m/s.
    ("copper-bar", 250.0, 0.0, False, [(6, 24), (12, 48), (24, 96), (36, 144)]),
    ("copper-bar", 300.0, 0.0, False, [(8, 32), (12, 48), (16, 64)]),
    ("copper-zerilli-bar", 190.0, 0.0, False, [(6, 42), (12, 84), (24, 168)]),
    ("iron-bar", 221.0, 0.0, False, [(6, 42), (12, 84), (24, 168)]),
    ("4340-bar", 208.0, 0.0, False, [(6, 42), (12, 84), (24, 168)]),
    ("4340-short-bar", 282.0, 0.0, False, [(6, 21), (12, 42), (24, 84)]),
    ("6061-bar", 262.0, 0.0, False, [(6, 39), (12, 78), (24, 156)]),
    ("taylor-plate", 200.0, 0.1, False, [(8, 54)]),
    ("taylor-plate", 200.0, 0.3, False, [(8, 54)]),
    ("copper-bar", 190.0, 0.1, False, [(8, 56)]),
    ("copper-bar", 190.0, 0.3, False, [(8, 56)]),
    ("copper-bar", 190.0, 0.0, True, [(5, 35), (8, 56), (12, 84), (24, 168)]),
    ("taylor-bar-42crmo4", 287.0, 0.0, True, [(6, 60), (12, 120), (24, 240)]),
    ("iron-bar", 221.0, 0.0, True, [(6, 42), (12, 84), (24, 168)]),
    ("taylor-plate", 200.0, 0.0, True, [(5, 34), (12, 80), (24, 160)]),
    ("block", 200.0, 0.0, False, [(6, 12), (12, 24), (24, 48)]),
    ("block", 200.0, 0.0, True, [(6, 12), (12, 24), (24, 48)]),
]


def run(work):
    body, speed, friction, lets_go, mesh = work
    metal, length, radius, end, axisymmetric = BODIES[body]
    began = time.time()
    with np.errstate(all="raise", under="ignore"):
        try:
            answer = solve(metal, length, radius, speed, *mesh, end, axisymmetric, friction, lets_go)
        except (FloatingPointError, RuntimeError) as error:
            answer = {"failed": str(error)}
    row = {"body": body, "speed": speed, "friction": friction, "lets_go": lets_go, "elements": list(mesh)} | answer
    print({k: v for k, v in row.items() if k not in ("outline", "below_side", "about_axis")}, f"{time.time() - began:.0f} s", flush=True)
    return row


def deviations(rows):
    """Of each mesh to the next finer one, as shares: the numbers of the shape, and the outline at its worst height."""
    found = []
    for a, b in zip(rows, rows[1:]):
        if "failed" in a or "failed" in b:
            continue
        shares = {k: a[k] / b[k] - 1 for k in ("length", "foot_diameter", "plastic_strain", "temperature")}
        ra, rb = (np.array(row["outline"]["radius_mm"]) for row in (a, b))
        found.append({"from": a["elements"], "to": b["elements"]} | shares | {"outline": float(np.max(np.abs(ra / rb - 1)))})
    return found


def known():
    """The rows that `taylor_bar.json` has, each by its work: a metal or a solver that was changed since is not noticed."""
    rows = {}
    for case in json.loads(RESULT.read_text())["cases"]:
        own = {k: v for k, v in case.items() if k not in ("deviations", "meshes", "plane_strain")}
        for row in case["meshes"]:
            rows[(*own.values(), tuple(row["elements"]))] = own | row
    return rows


def report(done):
    """Write what is done so far: `done` holds a row per run."""
    cases = []
    for body, speed, friction, lets_go, meshes in CASES:
        rows = [done[work] for work in ((body, speed, friction, lets_go, mesh) for mesh in meshes) if work in done]
        case = {"body": body, "speed": speed, "friction": friction, "lets_go": lets_go, "plane_strain": not BODIES[body][4]}
        own = [{k: v for k, v in row.items() if k not in case} for row in rows]
        cases.append(case | {"deviations": deviations(rows), "meshes": own})
    units = "SI; length and diameter over the first ones (diameter: width of the plate); J, for the plate J per m; outline in mm"
    result = {"command": "python3 reference/finite-elements/taylor_bar.py", "units": units, "cases": cases}
    # A list of numbers is a line.
    text = re.sub(r"\[[-\d.e,\s]+\]", lambda numbers: " ".join(numbers[0].split()), json.dumps(result, indent=1))
    RESULT.write_text(text + "\n")


if __name__ == "__main__":
    if len(sys.argv) == 5:
        body, speed, across, along = sys.argv[1:]
        run((body, float(speed), 0.0, False, (int(across), int(along))))
        sys.exit()
    works = [(*case[:4], mesh) for case in CASES for mesh in case[4]]
    # The coarse ones first: the file is written after each run.
    works.sort(key=lambda work: work[4])
    missing = sys.argv[1:] == ["--missing"]
    done = known() if missing else {}
    with Pool(2) as pool:
        for row in pool.imap_unordered(run, [work for work in works if work not in done]):
            done[(row["body"], row["speed"], row["friction"], row["lets_go"], tuple(row["elements"]))] = row
            report(done)
