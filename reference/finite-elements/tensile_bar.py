"""Bars and strips pulled apart, in explicit finite elements: force, plastic strain in the middle, narrowest place, over time.

    python3 reference/finite-elements/tensile_bar.py           # needs numpy; one process; writes tensile_bar.json beside this file

The elements and the return to the yield stress are those of `solver.py` (four nodes, mean dilatation, axisymmetric or in plane strain). Half the length is
modelled, from the plane of symmetry in the middle to the grip, whose nodes move as one body. No artificial viscosity is needed in tension; a
little damps the waves of the start.

Written for these checks alone, apart from Sphorge: what do material and load of a deck say, whatever the particles do?
"""

import json
import os
import time
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
import numpy as np

from solver import SHAPE, plastic_increment, points
from taylor_bar import COPPER, mie_gruneisen

ALUMINIUM = dict(rho=2770.0, G=28.6e9, A=265e6, B=426e6, n=0.34, C=0.015, m=1.0, T0=293.15, Tm=775.0, Cp=875.0, beta=0.9)
ALUMINIUM = mie_gruneisen(ALUMINIUM, 5328.0, 1.338, 2.0)
# The waisted bar of Fraser et al. with linear hardening: bilinear is Johnson-Cook with n = 1, without rate and heat.
STEEL = dict(rho=7850.0, G=210e9 / 2.6, A=350e6, B=2e9, n=1.0, C=0.0, m=1.0, T0=293.15, Tm=1e9, Cp=460.0, beta=0.9)
STEEL |= {"K": 210e9 / 1.2, "pressure": lambda compression, energy: 210e9 / 1.2 * (compression - 1)}


def straight(half):
    return lambda z: np.full_like(z, half)


def waisted(z):
    """Radius of the waisted bar by the distance from its middle."""
    return np.interp(z, [0.0, 0.025, 0.05, 0.25], [0.05, 0.05, 0.075, 0.075])


def constant(speed):
    return lambda t: speed


def ramp(t):
    """Half the speed of the pulled end: either half of the bar takes its share."""
    return 0.5 * min(t / 5e-3, 1.0)


def solve(metal, half_length, radius, grip, pull, end, across, along, axisymmetric, courant=0.8, viscosity=(0.06, 1.2), rows=40, triaxial=False):
    """`radius` of z, `pull` (m/s) of t; the grip is what is farther than `grip` from the middle. Rows of the
    history are `COLUMNS`; plastic strain is that of the innermost element, the edge that of the middle. `triaxial`: the innermost element's
    mean stress over von Mises stress is another column."""
    rho0, G = metal["rho"], metal["G"]
    heights = np.linspace(0, half_length, along + 1)
    share = np.linspace(0, 1, across + 1)
    r, z = (radius(heights)[:, None] * share).ravel(), np.repeat(heights, across + 1)
    corner = np.arange(len(r)).reshape(along + 1, across + 1)
    middle_row, axis = corner[0], corner[:, 0]
    elements = np.stack([c.ravel() for c in (corner[:-1, :-1], corner[:-1, 1:], corner[1:, 1:], corner[1:, :-1])])
    gather = lambda values: np.bincount(elements.ravel(), values.ravel(), len(r))
    weight = points(r[elements], z[elements], axisymmetric)[3]
    first_volume = weight.sum(0)
    mass = gather(rho0 * SHAPE.T @ weight)
    gripped = np.nonzero(z > grip - 1e-9)[0]
    vr, vz = np.zeros_like(r), np.zeros_like(z)
    vz[gripped] = pull(0.0)
    count = len(first_volume)
    S, strain, T, flow = np.zeros((4, 4, count)), np.zeros((4, count)), np.full((4, count), metal["T0"]), np.zeros((4, count))
    energy, last_pressure, sound = np.zeros(count), np.zeros(count), np.sqrt((metal["K"] + 4 * G / 3) / rho0)
    whole = 2 * np.pi if axisymmetric else 2
    t, steps, force, found, wanted = 0.0, 0, 0.0, [], 0
    while True:
        if t >= wanted * end / rows - 1e-15:
            found.append([float(t), float((z.max() - half_length) / half_length), float(force), float(strain[:, 0].mean()),
                          float(r[middle_row[-1]]), float(strain.mean(0).max()), float(T.mean(0).max())])
            if triaxial:
                deviator = S[:, :, 0]
                equivalent = np.sqrt(1.5 * ((deviator[:3] ** 2).sum(0) + 2 * deviator[3] ** 2)).mean()
                found[-1].append(float(-last_pressure[0] / max(equivalent, 1.0)))
            wanted += 1
        if t >= end - 1e-15:
            break
        re, ze = r[elements], z[elements]
        longest = np.max([np.hypot(re[a] - re[b], ze[a] - ze[b]) for a, b in ((0, 1), (1, 2), (2, 3), (3, 0), (0, 2), (1, 3))], 0)
        area = 0.5 * ((re[2] - re[0]) * (ze[3] - ze[1]) - (re[3] - re[1]) * (ze[2] - ze[0]))
        if np.min(area) <= 0:
            raise RuntimeError(f"an element turned inside out at {t:g} s")
        dt = min(courant * np.min(area / longest) / sound, max(wanted * end / rows - t, 1e-12))
        vre, vze = vr[elements], vz[elements]
        Dr, Dz, over_r, weight = points(re + 0.5 * dt * vre, ze + 0.5 * dt * vze, axisymmetric)
        r, z = r + dt * vr, z + dt * vz
        t, steps = t + dt, steps + 1
        drr, dzz, up, out = (Dr * vre).sum(1), (Dz * vze).sum(1), (Dz * vre).sum(1), (Dr * vze).sum(1)
        dtt = (over_r * vre).sum(1) if axisymmetric else np.zeros_like(drr)
        third, spin, shear = (drr + dzz + dtt) / 3, 0.5 * (up - out), 0.5 * (up + out)
        divergence = 3 * np.sum(weight * third, 0) / weight.sum(0)
        D = np.stack([drr - third, dzz - third, dtt - third, shear])
        turn = spin * np.stack([2 * S[3], -2 * S[3], np.zeros_like(spin), S[1] - S[0]])
        trial = S + dt * (2 * G * D + turn)
        equivalent = np.sqrt(1.5 * (trial[0] ** 2 + trial[1] ** 2 + trial[2] ** 2 + 2 * trial[3] ** 2)) + 1e-9
        increment = plastic_increment(metal, equivalent, strain, T, dt, flow * dt)
        factor = 1 - 3 * G * increment / equivalent
        middle, S = 0.5 * (S + trial * factor), trial * factor
        strain, flow = strain + increment, increment / dt
        Dr, Dz, over_r, weight = points(r[elements], z[elements], axisymmetric)
        volume = weight.sum(0)
        compression = first_volume / volume
        rho = rho0 * compression
        T = T + metal["beta"] * equivalent * factor * increment / (rho * metal["Cp"])
        width = np.sqrt(volume / (np.mean(r[elements], 0) if axisymmetric else 1.0))
        push = rho * width * (viscosity[1] * width * divergence**2 - viscosity[0] * sound * divergence) * (divergence < 0)
        pressure = metal["pressure"](compression, energy) + push
        distortion = dt * (middle[0] * D[0] + middle[1] * D[1] + middle[2] * D[2] + 2 * middle[3] * D[3])
        energy = energy + (np.sum(distortion * weight, 0) / volume - dt * 0.5 * (last_pressure + pressure) * divergence) / rho
        last_pressure = pressure
        radial = ((S[0] - pressure) * weight)[:, None] * Dr + (S[3] * weight)[:, None] * Dz
        if axisymmetric:
            radial += ((S[2] - pressure) * weight)[:, None] * over_r
        axial = gather((((S[1] - pressure) * weight)[:, None] * Dz + (S[3] * weight)[:, None] * Dr).sum(0))
        # What the other half does to the nodes of the plane of symmetry: their stress and their inertia, which is none.
        force = -whole * np.sum(axial[middle_row])
        vr, vz = vr - dt * gather(radial.sum(0)) / mass, vz - dt * axial / mass
        vr[axis], vz[middle_row] = 0, 0
        vr[gripped], vz[gripped] = 0, pull(t + 0.5 * dt)
    return {"elements": [across, along], "steps": steps, "history": found}


COLUMNS = ["time", "elongation", "force", "plastic_strain", "edge", "largest_plastic_strain", "largest_temperature"]
# Name, arguments of `solve`, meshes.
CASES = [
    (
        "strip",
        dict(metal=ALUMINIUM, half_length=0.01, radius=straight(0.01), grip=0.009, pull=constant(10.0), end=0.4e-3, axisymmetric=False),
        [(10, 10), (20, 20)],
    ),
    (
        "rod",
        dict(metal=COPPER, half_length=0.015, radius=straight(0.004), grip=0.014, pull=constant(10.0), end=0.6e-3, axisymmetric=True),
        [(4, 15), (8, 30)],
    ),
    (
        "waisted",
        dict(metal=STEEL, half_length=0.25, radius=waisted, grip=0.23, pull=ramp, end=10e-3, axisymmetric=True),
        [(5, 25), (10, 50), (20, 100)],
    ),
]


def run(name, arguments, mesh):
    began = time.time()
    row = solve(**arguments, across=mesh[0], along=mesh[1])
    last = dict(zip(COLUMNS, row["history"][-1]))
    print(name, mesh, last, row["steps"], "steps", f"{time.time() - began:.0f} s", flush=True)
    return row


if __name__ == "__main__":
    path = Path(__file__).with_suffix(".json")
    cases = {name: [] for name, _, _ in CASES}
    # The coarse meshes first: the file is written after each run.
    works = sorted(((name, arguments, mesh) for name, arguments, meshes in CASES for mesh in meshes), key=lambda work: work[2])
    for name, arguments, mesh in works:
        cases[name].append(run(name, arguments, mesh))
        result = {"command": "python3 reference/finite-elements/tensile_bar.py", "columns": COLUMNS}
        result |= {"units": "SI; force of the strip per metre of depth, of a half of it on either side of the axis"}
        result |= {"cases": [{"body": body, "meshes": meshes} for body, meshes in cases.items()]}
        path.write_text(json.dumps(result) + "\n")
