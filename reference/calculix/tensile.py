"""Tensile bar of Fraser et al. in finite elements: plastic strain and von Mises stress at the middle of the waist.

    python3 reference/calculix/tensile.py                      # writes tensile.json beside this file

Axisymmetric, four-node elements (CAX4), large displacements, implicit dynamics; the bar of the deck `tensile`. One end is held, the
other pulled, 0 to 1 m/s over 5 ms, then 1 m/s: 7.5 mm at 10 ms. Perfectly plastic, and with a linear hardening of 2 GPa, for
which the answer converges with the mesh. The lower half is modelled as well as the upper: waves run through both.
"""

import json
import sys
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


def model(size, hardening, step):
    """Input of CalculiX; elements of `size` m in the waist, hardening slope in Pa. Also the element at the middle."""
    # Axial element boundaries: fine in the waist, up to four times coarser in the grips.
    heights = [0.0]
    while heights[-1] < 0.5 - 1e-9:
        z = heights[-1]
        coarse = z < 0.18 - 1e-9 or z > 0.32 - 1e-9
        heights.append(round(z + (min(4 * size, 0.02) if coarse else size), 9))
    across = round(0.05 / size)
    number = {}
    nodes = []
    for i, z in enumerate(heights):
        for j in range(across + 1):
            number[i, j] = len(nodes) + 1
            nodes.append("%d, %.9g, %.9g" % (number[i, j], radius(z) * j / across, z))
    elements = []
    for i in range(len(heights) - 1):
        for j in range(across):
            own = [number[i, j], number[i, j + 1], number[i + 1, j + 1], number[i + 1, j]]
            elements.append("%d, %s" % (i * across + j + 1, ", ".join(map(str, own))))
    held = [number[i, j] for i, z in enumerate(heights) for j in range(across + 1) if z < GRIP + 1e-9]
    pulled = [number[i, j] for i, z in enumerate(heights) for j in range(across + 1) if z > 0.5 - GRIP - 1e-9]
    axis = [number[i, 0] for i in range(len(heights))]
    middle = max(i for i, z in enumerate(heights) if z < 0.25 - 1e-9)
    centre = middle * across + 1
    plastic = "%.9g, 0.0" % YIELD + ("\n%.9g, 10.0" % (YIELD + 10 * hardening) if hardening else "\n%.9g, 10.0" % (YIELD + 1.0))
    # Displacement of the pulled end: 100 t^2 up to 5 ms, then on at 1 m/s.
    rows = []
    for k in range(101):
        t = END * k / 100
        rows.append("%.9g, %.9g" % (t, 100 * t * t if t <= 5e-3 else 2.5e-3 + (t - 5e-3)))
    text = f"""*NODE, NSET=ALL
{chr(10).join(nodes)}
*ELEMENT, TYPE=CAX4, ELSET=BAR
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
{chr(10).join(rows)}
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


def solve(size, hardening, step=2e-4):
    history = {}
    for heading, time, rows in calculix.run(model(size, hardening, step)):
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
        "element_size": size,
        "hardening": hardening,
        "plastic_strain": history[times[-1]][0],
        "von_mises_stress": history[times[-1]][1],
        "history": [[t, *history[t]] for t in times[:: max(1, len(times) // 25)]],
    }


if __name__ == "__main__":
    sizes = [float(word) for word in sys.argv[1:]] or [10e-3, 5e-3, 2.5e-3, 1.25e-3]
    runs = []
    for hardening in (0.0, 2e9):
        for size in sizes:
            runs.append(solve(size, hardening))
            print({key: value for key, value in runs[-1].items() if key != "history"}, flush=True)
            result = {
                "command": "python3 reference/calculix/tensile.py",
                "program": calculix.version(),
                "units": "SI",
                "history": "time, plastic strain and von Mises stress of the element at the middle of the waist",
                "runs": runs,
            }
            Path(__file__).with_suffix(".json").write_text(json.dumps(result, indent=1) + "\n")
