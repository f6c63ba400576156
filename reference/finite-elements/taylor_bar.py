"""Taylor bars in finite elements: explicit, axisymmetric, four-node elements with mean dilatation, Johnson-Cook, heat of plastic work.

    python3 reference/finite-elements/taylor_bar.py            # needs numpy; writes taylor_bar.json beside this file

Written for these checks alone, apart from Sphorge: what do the constants of a deck say, whatever the particles do? The wall is rigid
and without friction: nodes of the foot slide on it.
"""

import json
from pathlib import Path

import numpy as np

GAUSS = [(a / np.sqrt(3), b / np.sqrt(3)) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]


def shape(a, b):
    """Shape functions and their derivatives at a point of the unit element."""
    values = np.array([(1 - a) * (1 - b), (1 + a) * (1 - b), (1 + a) * (1 + b), (1 - a) * (1 + b)]) / 4
    slopes = np.array([[-(1 - b), 1 - b, 1 + b, -(1 + b)], [-(1 - a), -(1 + a), 1 + a, 1 - a]]) / 4
    return values, slopes


SHAPES = [shape(a, b) for a, b in GAUSS]


def points(x, elements):
    """Of each integration point: shape functions, gradients, radius, weight (volume per radian)."""
    corners = x[elements]
    found = []
    for values, slopes in SHAPES:
        jacobian = np.einsum("an,enb->eab", slopes, corners)
        det = jacobian[:, 0, 0] * jacobian[:, 1, 1] - jacobian[:, 0, 1] * jacobian[:, 1, 0]
        inverse = np.empty_like(jacobian)
        inverse[:, 0, 0], inverse[:, 1, 1] = jacobian[:, 1, 1] / det, jacobian[:, 0, 0] / det
        inverse[:, 0, 1], inverse[:, 1, 0] = -jacobian[:, 0, 1] / det, -jacobian[:, 1, 0] / det
        radius = corners[:, :, 0] @ values
        found.append((values, np.einsum("eab,bn->ean", inverse, slopes), radius, det * radius))
    return found


def solve(metal, length, radius, speed, across, along, end, courant=0.4, viscosity=(0.06, 1.2)):
    """Final length and foot diameter over the first ones, largest plastic strain and temperature (means of an element)."""
    rho0, G, T0, Tm = metal["rho"], metal["G"], metal["T0"], metal["Tm"]
    r, z = np.linspace(0, radius, across + 1), np.linspace(0, length, along + 1)
    x = np.array([(a, b) for b in z for a in r])
    node = lambda i, j: j * (across + 1) + i
    elements = np.array(
        [[node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)] for j in range(along) for i in range(across)]
    )
    count = len(elements)
    start = points(x, elements)
    first_volume = sum(p[3] for p in start)
    mass = np.zeros(len(x))
    for values, _, _, weight in start:
        np.add.at(mass, elements, rho0 * weight[:, None] * values[None, :])
    foot, axis = np.isclose(x[:, 1], 0), np.isclose(x[:, 0], 0)
    v = np.zeros_like(x)
    v[:, 1] = -speed
    v[foot, 1] = 0
    S, strain, T = np.zeros((4, count, 4)), np.zeros((4, count)), np.full((4, count), T0)
    energy, t, sound = np.zeros(count), 0.0, np.sqrt((metal["K"] + 4 * G / 3) / rho0)
    while t < end:
        corners = x[elements]
        edges = ((0, 1), (1, 2), (2, 3), (3, 0))
        size = min(np.min(np.hypot(*(corners[:, a] - corners[:, b]).T)) for a, b in edges)
        dt = min(courant * size / sound, end - t + 1e-15)
        middle = points(x + 0.5 * dt * v, elements)
        x = x + dt * v
        t += dt
        now = points(x, elements)
        volume = sum(p[3] for p in now)
        rho = rho0 * first_volume / volume
        ve = v[elements]
        divergence = sum(
            weight * (np.sum(D[:, 0] * ve[:, :, 0], 1) + np.sum(D[:, 1] * ve[:, :, 1], 1) + (ve[:, :, 0] @ N) / rr)
            for N, D, rr, weight in middle
        ) / sum(p[3] for p in middle)
        width = np.sqrt(volume / (np.mean(x[elements][:, :, 0], axis=1) + 1e-12))
        linear, quadratic = viscosity
        push = rho * width * (quadratic * width * divergence**2 - linear * sound * divergence)
        pressure = metal["pressure"](rho / rho0, energy) + np.where(divergence < 0, push, 0)
        plastic_work = np.zeros(count)
        for k, (N, D, rr, _) in enumerate(middle):
            # Rate of deformation and spin.
            drr, dzz = np.sum(D[:, 0] * ve[:, :, 0], 1), np.sum(D[:, 1] * ve[:, :, 1], 1)
            dtt = (ve[:, :, 0] @ N) / rr
            up, out = np.sum(D[:, 1] * ve[:, :, 0], 1), np.sum(D[:, 0] * ve[:, :, 1], 1)
            third, spin, shear = (drr + dzz + dtt) / 3, 0.5 * (up - out), 0.5 * (up + out)
            # Trial deviator rr, zz, tt, rz with the Jaumann rate.
            s = S[k]
            trial = np.stack(
                [
                    s[:, 0] + dt * (2 * G * (drr - third) + 2 * spin * s[:, 3]),
                    s[:, 1] + dt * (2 * G * (dzz - third) - 2 * spin * s[:, 3]),
                    s[:, 2] + dt * 2 * G * (dtt - third),
                    s[:, 3] + dt * (2 * G * shear + spin * (s[:, 1] - s[:, 0])),
                ],
                1,
            )
            equivalent = np.sqrt(1.5 * (np.sum(trial[:, :3] ** 2, 1) + 2 * trial[:, 3] ** 2)) + 1e-9
            softening = 1 - np.clip((T[k] - T0) / (Tm - T0), 0, 1) ** metal["m"]

            def yield_stress(increment):
                hardening = metal["A"] + metal["B"] * (strain[k] + increment) ** metal["n"]
                return hardening * (1 + metal["C"] * np.log(np.maximum(increment / dt, 1.0))) * softening

            low, high = np.zeros(count), equivalent / (3 * G)
            plastic = equivalent > yield_stress(low)
            for _ in range(40):
                half = 0.5 * (low + high)
                above = equivalent - 3 * G * half - yield_stress(half) > 0
                low, high = np.where(above, half, low), np.where(above, high, half)
            increment = np.where(plastic, 0.5 * (low + high), 0)
            factor = (equivalent - 3 * G * increment) / equivalent
            S[k] = trial * factor[:, None]
            strain[k] += increment
            work = equivalent * factor * increment
            T[k] += metal["beta"] * work / (rho * metal["Cp"])
            plastic_work += 0.25 * work
        force = np.zeros_like(x)
        for k, (N, D, rr, weight) in enumerate(now):
            s = S[k]
            radial = (s[:, 0] - pressure)[:, None] * D[:, 0] + s[:, 3][:, None] * D[:, 1]
            radial += ((s[:, 2] - pressure) / rr)[:, None] * N
            axial = (s[:, 1] - pressure)[:, None] * D[:, 1] + s[:, 3][:, None] * D[:, 0]
            np.add.at(force[:, 0], elements, -weight[:, None] * radial)
            np.add.at(force[:, 1], elements, -weight[:, None] * axial)
        energy += (plastic_work - dt * pressure * divergence) / rho
        v += dt * force / mass[:, None]
        v[foot, 1] = 0
        v[axis, 0] = 0
    return {
        "length": x[:, 1].max() / length,
        "foot_diameter": x[foot, 0].max() / radius,
        "plastic_strain": strain.mean(0).max(),
        "temperature": T.mean(0).max(),
    }


def mie_gruneisen(rho0, sound_speed, slope, gruneisen):
    """Pressure by compression (density over first) and specific energy."""

    def pressure(compression, energy):
        eta = 1 - 1 / compression
        stiffness = rho0 * sound_speed**2
        hugoniot = stiffness * eta / (1 - slope * np.clip(eta, None, 0.5)) ** 2
        cold = np.where(eta > 0, hugoniot * (1 - 0.5 * gruneisen * np.clip(eta, 0, None) * compression), stiffness * (compression - 1))
        return cold + gruneisen * rho0 * energy

    return pressure


COPPER = dict(rho=8960.0, G=46e9, K=8960.0 * 3940**2, A=90e6, B=292e6, n=0.31, C=0.025, m=1.09, T0=293.15, Tm=1356.0, Cp=383.0, beta=0.9)
COPPER["pressure"] = mie_gruneisen(8960.0, 3940.0, 1.49, 2.0)
# The bar with published finite-element answers tells that these elements can be trusted.
STEEL = dict(rho=7830.0, G=206.9e9 / 2.6, K=206.9e9 / 1.2, A=806e6, B=614e6, n=0.168, C=0.0089, m=1.1, T0=293.15, Tm=1813.15, Cp=460.0, beta=0.9)
STEEL["pressure"] = lambda compression, energy: STEEL["K"] * (compression - 1)

if __name__ == "__main__":
    runs = []
    for speed in (130.0, 146.0, 190.0):
        answer = solve(COPPER, 0.0254, 0.00381, speed, 5, 35, 90e-6)
        runs.append({"bar": "copper-bar", "speed": speed, "elements": [5, 35]} | {k: float(a) for k, a in answer.items()})
        print(runs[-1], flush=True)
    answer = solve(STEEL, 0.0324, 0.0032, 287.0, 6, 60, 80e-6)
    runs.append({"bar": "taylor-bar-42crmo4", "speed": 287.0, "elements": [6, 60]} | {k: float(a) for k, a in answer.items()})
    print(runs[-1], flush=True)
    result = {"command": "python3 reference/finite-elements/taylor_bar.py", "units": "SI; length and diameter over the first ones", "runs": runs}
    Path(__file__).with_suffix(".json").write_text(json.dumps(result, indent=2) + "\n")
