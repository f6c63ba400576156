"""Colliding rubber rings in finite elements: how fast they part.

    python3 reference/finite-elements/rubber_rings.py          # needs numpy; a minute; prints

The rings of the deck `rubber-rings` are equal, so one of them meets a wall without friction, a millimetre away, that lets go of it. Elements
are those of `solver.py`, half a ring in plane strain, elastic with the Jaumann rate and linear pressure. Speed after over speed before at
0.4 ms: 0.7912, 0.7978, 0.8000 with 6 x 72, 10 x 120, 16 x 192 elements; 0.7989 for 0.7978 without viscosity.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
import numpy as np

from solver import SHAPE, points

YOUNG, POISSON, DENSITY, SPEED = 10e6, 0.3975, 1.0, 237.9
BULK, SHEAR = YOUNG / 3 / (1 - 2 * POISSON), YOUNG / 2 / (1 + POISSON)
SOUND = np.sqrt((BULK + 4 * SHEAR / 3) / DENSITY)


def solve(across, around, end=0.4e-3, viscosity=(0.06, 1.2), gap=1e-3, courant=0.7):
    radius, angle = np.linspace(0.03, 0.04, across + 1), np.linspace(0, np.pi, around + 1)
    x, y = (0.04 + gap - np.outer(np.cos(angle), radius)).ravel(), np.outer(np.sin(angle), radius).ravel()
    node = np.arange(len(x)).reshape(around + 1, across + 1)
    # Counterclockwise: the ring is walked from the wall away.
    elements = np.stack([c.ravel() for c in (node[1:, :-1], node[1:, 1:], node[:-1, 1:], node[:-1, :-1])])
    gather = lambda values: np.bincount(elements.ravel(), values.ravel(), len(x))
    weight = points(x[elements], y[elements], False)[3]
    assert weight.min() > 0
    mass, first = gather(DENSITY * SHAPE.T @ weight), weight.sum(0)
    vx, vy = np.full_like(x, -SPEED), np.zeros_like(x)
    axis = np.concatenate([node[0], node[-1]])
    S, t = np.zeros((4, 4, elements.shape[1])), 0.0
    while t < end:
        xe, ye = x[elements], y[elements]
        longest = np.max([np.hypot(xe[a] - xe[b], ye[a] - ye[b]) for a, b in ((0, 1), (1, 2), (2, 3), (3, 0), (0, 2), (1, 3))], 0)
        area = 0.5 * ((xe[2] - xe[0]) * (ye[3] - ye[1]) - (xe[3] - xe[1]) * (ye[2] - ye[0]))
        dt = min(courant * np.min(area / longest) / SOUND, end - t + 1e-15)
        ux, uy = vx[elements], vy[elements]
        Dx, Dy, _, weight = points(xe + 0.5 * dt * ux, ye + 0.5 * dt * uy, False)
        x, y, t = x + dt * vx, y + dt * vy, t + dt
        dxx, dyy, up, out = (Dx * ux).sum(1), (Dy * uy).sum(1), (Dy * ux).sum(1), (Dx * uy).sum(1)
        third, spin, shear = (dxx + dyy) / 3, 0.5 * (up - out), 0.5 * (up + out)
        divergence = 3 * np.sum(weight * third, 0) / weight.sum(0)
        D = np.stack([dxx - third, dyy - third, -third, shear])
        S = S + dt * (2 * SHEAR * D + spin * np.stack([2 * S[3], -2 * S[3], np.zeros_like(spin), S[1] - S[0]]))
        Dx, Dy, _, weight = points(x[elements], y[elements], False)
        volume = weight.sum(0)
        compression, width = first / volume, np.sqrt(volume)
        rho = DENSITY * compression
        push = rho * width * (viscosity[1] * width * divergence**2 - viscosity[0] * SOUND * divergence) * (divergence < 0)
        pressure = BULK * (compression - 1) + push
        along = ((S[0] - pressure) * weight)[:, None] * Dx + (S[3] * weight)[:, None] * Dy
        up = ((S[1] - pressure) * weight)[:, None] * Dy + (S[3] * weight)[:, None] * Dx
        vx, vy = vx - dt * gather(along.sum(0)) / mass, vy - dt * gather(up.sum(0)) / mass
        vy[axis] = 0
        # The wall at x = 0.
        stopped = np.nonzero(x + dt * vx < 0)[0]
        vx[stopped] = -x[stopped] / dt
    total = np.sum(mass)
    kinetic = np.sum(mass * (vx**2 + vy**2)) / (total * SPEED**2)
    return {"elements": (across, around), "speed": float(np.sum(mass * vx) / total / SPEED), "kinetic": float(kinetic), "edge": float(x.min())}


if __name__ == "__main__":
    for mesh in ((6, 72), (10, 120), (16, 192)):
        print(solve(*mesh), flush=True)
    print("without viscosity", solve(10, 120, viscosity=(0.0, 0.0)))
