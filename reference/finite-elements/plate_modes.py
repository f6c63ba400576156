"""Period of the first bending mode of the plate of `oscillating-plate`, clamped and free: eigenvalues of linear elasticity in plane strain.

    python3 reference/finite-elements/plate_modes.py           # needs numpy; a few seconds; prints

Nine-node elements with full integration, written for this check alone. The amplitudes of the case change the period by 0.1 % at most.
Clamped, 20 x 2 and 40 x 4 elements: 0.25429, 0.25490 s (CalculiX, 20-node bricks: 0.25473 s at the smallest amplitude). With ends that
are free: 0.041441, 0.041447 s. Clamped and half a per cent longer: 0.257433 s, which is 0.99993 of what the square of the length says.
"""

import numpy as np

YOUNG, POISSON, DENSITY, LENGTH, THICKNESS = 2e6, 0.3975, 1000.0, 0.2, 0.02
LAME, SHEAR = YOUNG * POISSON / (1 + POISSON) / (1 - 2 * POISSON), YOUNG / 2 / (1 + POISSON)
STIFFNESS = np.array([[LAME + 2 * SHEAR, LAME, 0], [LAME, LAME + 2 * SHEAR, 0], [0, 0, SHEAR]])
GAUSS, WEIGHTS = np.array([-np.sqrt(0.6), 0, np.sqrt(0.6)]), np.array([5, 8, 5]) / 9


def shape(s):
    """Quadratic shape functions of three nodes on a line, and their derivatives."""
    return np.array([s * (s - 1) / 2, 1 - s * s, s * (s + 1) / 2]), np.array([s - 0.5, -2 * s, s + 0.5])


def period(along, across, clamped, length=LENGTH):
    dx, dy = length / along, THICKNESS / across
    rows = 2 * across + 1
    stiff, heavy = np.zeros((18, 18)), np.zeros((18, 18))
    for a, wa in zip(GAUSS, WEIGHTS):
        for b, wb in zip(GAUSS, WEIGHTS):
            (na, da), (nb, db) = shape(a), shape(b)
            n, nx, ny = np.outer(na, nb).ravel(), np.outer(da, nb).ravel() * 2 / dx, np.outer(na, db).ravel() * 2 / dy
            strain, motion = np.zeros((3, 18)), np.zeros((2, 18))
            strain[0, ::2], strain[1, 1::2], strain[2, ::2], strain[2, 1::2] = nx, ny, ny, nx
            motion[0, ::2], motion[1, 1::2] = n, n
            stiff += strain.T @ STIFFNESS @ strain * dx * dy / 4 * wa * wb
            heavy += DENSITY * motion.T @ motion * dx * dy / 4 * wa * wb
    count = 2 * (2 * along + 1) * rows
    k, m = np.zeros((count, count)), np.zeros((count, count))
    for i in range(along):
        for j in range(across):
            nodes = [(2 * i + a) * rows + 2 * j + b for a in range(3) for b in range(3)]
            freedoms = np.array([[2 * n, 2 * n + 1] for n in nodes]).ravel()
            k[np.ix_(freedoms, freedoms)] += stiff
            m[np.ix_(freedoms, freedoms)] += heavy
    free = np.arange(2 * rows if clamped else 0, count)
    inverse = np.linalg.inv(np.linalg.cholesky(m[np.ix_(free, free)]))
    values = np.linalg.eigvalsh(inverse @ k[np.ix_(free, free)] @ inverse.T)
    # Without a clamp the plate has three motions of a rigid body.
    return 2 * np.pi / np.sqrt(values[0 if clamped else 3])


if __name__ == "__main__":
    for mesh in ((20, 2), (40, 4)):
        print(mesh, "clamped %.6f s, free %.6f s" % (period(*mesh, True), period(*mesh, False)))
    print("clamped, 201 mm: %.6f s" % period(40, 4, True, 0.201))
