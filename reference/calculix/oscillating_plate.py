"""Oscillating plate of Gray, Monaghan & Swift (2001) in finite elements: period for four amplitudes.

    python3 reference/calculix/oscillating_plate.py            # writes oscillating_plate.json beside this file

Plane strain by one layer of 20-node bricks held across, large displacements, the trapezoidal rule (no numerical damping). The
plate is clamped at x = 0 and starts with the velocity of the first mode of thin-plate theory, as the deck `oscillating-plate` does.
"""

import json
import math
from pathlib import Path

import calculix

LENGTH, THICKNESS, DEPTH = 0.2, 0.02, 0.005
YOUNG, POISSON, DENSITY = 2e6, 0.3975, 1000.0
SOUND_SPEED = math.sqrt(YOUNG / (3 * (1 - 2 * POISSON)) / DENSITY)
STEP, END = 1e-3, 0.53


def mode(x):
    """First mode of a clamped thin plate, 1 at the free end."""
    k = 1.875 / LENGTH
    a, b = math.cos(1.875) + math.cosh(1.875), math.sin(1.875) - math.sinh(1.875)
    shape = lambda x: a * (math.cosh(k * x) - math.cos(k * x)) + b * (math.sinh(k * x) - math.sin(k * x))
    return shape(x) / shape(LENGTH)


def model(amplitude, along, across):
    """Input of CalculiX for a velocity `amplitude` (m/s) of the free end, `along` x `across` elements; and its observed node."""
    # 20-node bricks: nodes on a grid of half elements, those with more than one odd index left out.
    number = {}
    for i in range(2 * along + 1):
        for j in range(2 * across + 1):
            for k in range(3):
                if (i % 2) + (j % 2) + (k % 2) <= 1:
                    number[i, j, k] = len(number) + 1
    place = lambda i, j, k: (LENGTH * i / (2 * along), THICKNESS * (j / (2 * across) - 0.5), DEPTH * k / 2)
    nodes = "\n".join("%d, %.9g, %.9g, %.9g" % (n, *place(*ijk)) for ijk, n in number.items())
    elements = []
    corners = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2)]
    middles = [(1, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0), (1, 0, 2), (2, 1, 2), (1, 2, 2), (0, 1, 2)]
    posts = [(0, 0, 1), (2, 0, 1), (2, 2, 1), (0, 2, 1)]
    for i in range(along):
        for j in range(across):
            own = [number[2 * i + a, 2 * j + b, c] for a, b, c in corners + middles + posts]
            elements.append(calculix.lines([i * across + j + 1] + own))
    elements = "\n".join(e.replace("\n", ",\n") for e in elements)
    root = calculix.lines([n for (i, _, _), n in number.items() if i == 0])
    velocity = "\n".join(
        "%d, 2, %.9g" % (n, amplitude * mode(place(*ijk)[0])) for ijk, n in number.items() if ijk[0] > 0
    )
    observed = number[2 * along, across, 0]
    text = f"""*NODE, NSET=ALL
{nodes}
*ELEMENT, TYPE=C3D20, ELSET=PLATE
{elements}
*NSET, NSET=ROOT
{root}
*NSET, NSET=TIP
{observed}
*MATERIAL, NAME=RUBBER
*ELASTIC
{YOUNG}, {POISSON}
*DENSITY
{DENSITY}
*SOLID SECTION, ELSET=PLATE, MATERIAL=RUBBER
*BOUNDARY
ALL, 3, 3
ROOT, 1, 2
*INITIAL CONDITIONS, TYPE=VELOCITY
{velocity}
*STEP, NLGEOM, INC=100000
*DYNAMIC, DIRECT, ALPHA=0
{STEP}, {END}
*NODE PRINT, NSET=TIP
U
*END STEP
"""
    return text, observed


def solve(share, along=40, across=4):
    """Period and largest deflection of the free end for a velocity of `share` sound speeds."""
    text, _ = model(share * SOUND_SPEED, along, across)
    tip = [(time, rows[0][2]) for heading, time, rows in calculix.run(text) if heading.startswith("displacements")]
    # Deflection rises through zero at the beginning of every period; the first time it is at rest there at t = 0.
    crossings = [0.0]
    for (t0, u0), (t1, u1) in zip(tip, tip[1:]):
        if u0 < 0 <= u1:
            crossings.append(t0 - u0 * (t1 - t0) / (u1 - u0))
    return {
        "share_of_sound_speed": share,
        "period": (crossings[-1] - crossings[0]) / (len(crossings) - 1),
        "largest_deflection": max(abs(u) for _, u in tip),
        "elements": [along, across],
    }


if __name__ == "__main__":
    runs = [solve(share) for share in (0.001, 0.01, 0.03, 0.05)]
    # The coarser mesh tells what the mesh still does to the period.
    runs.append(solve(0.01, 20, 2))
    result = {
        "command": "python3 reference/calculix/oscillating_plate.py",
        "program": calculix.version(),
        "units": "SI",
        "runs": runs,
    }
    Path(__file__).with_suffix(".json").write_text(json.dumps(result, indent=2) + "\n")
    for run in runs:
        print(run)
