"""Tensile bar of Fraser et al. in finite elements: plastic strain and von Mises stress at the middle of the waist.

    python3 reference/calculix/tensile.py                      # writes tensile.json beside this file

Axisymmetric, large displacements, implicit dynamics; the bar of the deck `tensile`. Four-node elements (CAX4) of several sizes, as the
paper's finite elements are; eight-node elements (CAX8R), which converge sooner, show where the answer with hardening lies. One end is
held, the other pulled, 0 to 1 m/s over 5 ms, then 1 m/s: 7.5 mm at 10 ms. Perfectly plastic, and with a linear hardening of 2 GPa, for
which the answer converges with the mesh. The lower half is modelled as well as the upper: waves run through both.
"""

import json
from pathlib import Path

import calculix

YOUNG, POISSON, DENSITY, YIELD = 210e9, 0.3, 7850.0, 350e6
END = 10e-3
# Axial distance and radius, m; the ends of the sections are element boundaries.
PROFILE = [(0.0, 0.075), (0.2, 0.075), (0.225, 0.05), (0.275, 0.05), (0.3, 0.075), (0.5, 0.075)]
# The deck holds and pulls two particles deep, 20 mm.
GRIP = 0.02


def radius(z):
    for (z0, r0), (z1, r1) in zip(PROFILE, PROFILE[1:]):
        if z <= z1:
            return r0 + (r1 - r0) * (z - z0) / (z1 - z0)
    return PROFILE[-1][1]


def model(size, hardening, step, element):
    """Input of CalculiX; elements of `size` m in the waist, hardening slope in Pa."""
    # Axial element boundaries: fine in the waist, up to four times coarser in the grips.
    heights = [0.0]
    while heights[-1] < 0.5 - 1e-9:
        z = heights[-1]
        coarse = z < 0.18 - 1e-9 or z > 0.32 - 1e-9
        heights.append(round(z + (min(4 * size, 0.02) if coarse else size), 9))
    across = round(0.05 / size)
    rows = len(heights) - 1
    # Nodes stand on a grid of half elements; four-node elements use every second one each way.
    grid = [heights[i // 2] if i % 2 == 0 else 0.5 * (heights[i // 2] + heights[i // 2 + 1]) for i in range(2 * rows + 1)]
    number = {}
    nodes = []
    for i, z in enumerate(grid):
        for j in range(2 * across + 1):
            if (i % 2 == 0 and j % 2 == 0) or (element == "CAX8R" and not (i % 2 and j % 2)):
                number[i, j] = len(nodes) + 1
                nodes.append("%d, %.9g, %.9g" % (number[i, j], radius(z) * j / (2 * across), z))
    corners = [(0, 0), (0, 2), (2, 2), (2, 0)]
    middles = [(0, 1), (1, 2), (2, 1), (1, 0)] if element == "CAX8R" else []
    elements = []
    for i in range(rows):
        for j in range(across):
            own = [number[2 * i + di, 2 * j + dj] for di, dj in corners + middles]
            elements.append("%d, %s" % (i * across + j + 1, ", ".join(map(str, own))))
    held = [n for (i, _), n in number.items() if grid[i] < GRIP + 1e-9]
    pulled = [n for (i, _), n in number.items() if grid[i] > 0.5 - GRIP - 1e-9]
    axis = [n for (_, j), n in number.items() if j == 0]
    middle = max(i for i, z in enumerate(heights) if z < 0.25 - 1e-9)
    centre = middle * across + 1
    plastic = "%.9g, 0.0" % YIELD + ("\n%.9g, 10.0" % (YIELD + 10 * hardening) if hardening else "\n%.9g, 10.0" % (YIELD + 1.0))
    # Displacement of the pulled end: 100 t^2 up to 5 ms, then on at 1 m/s.
    pull = []
    for k in range(101):
        t = END * k / 100
        pull.append("%.9g, %.9g" % (t, 100 * t * t if t <= 5e-3 else 2.5e-3 + (t - 5e-3)))
    text = f"""*NODE, NSET=ALL
{chr(10).join(nodes)}
*ELEMENT, TYPE={element}, ELSET=BAR
{chr(10).join(elements)}
*NSET, NSET=HELD
{calculix.lines(held).replace(chr(10), "," + chr(10))}
*NSET, NSET=PULLED
{calculix.lines(pulled).replace(chr(10), "," + chr(10))}
*NSET, NSET=AXIS
{calculix.lines(axis).replace(chr(10), "," + chr(10))}
*ELSET, ELSET=CENTRE
{centre}
*MATERIAL, NAME=STEEL
*ELASTIC
{YOUNG}, {POISSON}
*PLASTIC
{plastic}
*DENSITY
{DENSITY}
*SOLID SECTION, ELSET=BAR, MATERIAL=STEEL
*AMPLITUDE, NAME=PULL
{chr(10).join(pull)}
*BOUNDARY
AXIS, 1, 1
HELD, 1, 2
PULLED, 1, 1
*STEP, NLGEOM, INC=100000
*DYNAMIC, ALPHA=-0.05
{step}, {END}, 1e-9, {step}
*BOUNDARY, AMPLITUDE=PULL
PULLED, 2, 2, 1.0
*EL PRINT, ELSET=CENTRE
PEEQ, S
*END STEP
"""
    return text


def mises(s):
    """Of the components xx, yy, zz, xy, xz, yz."""
    xx, yy, zz, xy, xz, yz = s
    return (0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3 * (xy * xy + xz * xz + yz * yz)) ** 0.5


def solve(size, hardening, element, step=2e-4):
    history = {}
    for heading, time, rows in calculix.run(model(size, hardening, step, element)):
        # Rows are element, integration point, values; the mean of the points.
        values = [row[2:] for row in rows]
        mean = [sum(column) / len(values) for column in zip(*values)]
        entry = history.setdefault(time, [0.0, 0.0])
        if heading.startswith("equivalent plastic strain"):
            entry[0] = mean[0]
        elif heading.startswith("stresses"):
            entry[1] = mises(mean)
    times = sorted(history)
    return {
        "element": element,
        "element_size": size,
        "hardening": hardening,
        "plastic_strain": history[times[-1]][0],
        "von_mises_stress": history[times[-1]][1],
        "history": [[t, *history[t]] for t in times[:: max(1, len(times) // 25)]],
    }


if __name__ == "__main__":
    runs = []
    for element, sizes in (("CAX4", [10e-3, 5e-3, 2.5e-3, 1.25e-3]), ("CAX8R", [10e-3, 5e-3, 2.5e-3])):
        for hardening in (0.0, 2e9):
            for size in sizes:
                runs.append(solve(size, hardening, element))
                print({key: value for key, value in runs[-1].items() if key != "history"}, flush=True)
    result = {
        "command": "python3 reference/calculix/tensile.py",
        "program": calculix.version(),
        "units": "SI",
        "history": "time, plastic strain and von Mises stress of the element at the middle of the waist",
        "runs": runs,
    }
    Path(__file__).with_suffix(".json").write_text(json.dumps(result, indent=1) + "\n")
