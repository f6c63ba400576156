"""Explicit finite elements for an impact on a rigid wall: four-node elements with mean dilatation, axisymmetric or in plane strain.

The wall is z = 0. The foot of the body slides on it, with Coulomb friction or none, and stays on it unless the wall lets go; other
nodes that reach the wall stop there and may leave. Strength is a law of `strength.py`, with the heat of plastic work; pressure is a
function of compression and energy.

A body has `across` x `along` elements between its axis (r = 0, of revolution or of symmetry) and its side. Arrays hold one
number per integration point and element, (4, elements), or per corner and element. Masses and energies are per radian, or for half
a plate and a metre of depth, until `solve` reports them for the whole body.
"""

import numpy as np

# Derivatives of the shape functions along a and b, and the functions, at the four Gauss points of the unit element: (point, node).
SIDES = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
GAUSS = SIDES / np.sqrt(3)
ALONG_A = SIDES[None, :, 0] * (1 + GAUSS[:, None, 1] * SIDES[None, :, 1]) / 4
ALONG_B = SIDES[None, :, 1] * (1 + GAUSS[:, None, 0] * SIDES[None, :, 0]) / 4
SHAPE = (1 + GAUSS[:, None, 0] * SIDES[None, :, 0]) * (1 + GAUSS[:, None, 1] * SIDES[None, :, 1]) / 4

# Half a particle with 12 and with 24 of them across, as shares of the radius.
DEPTHS = (1 / 12, 1 / 24)


def points(r, z, axisymmetric):
    """Of each integration point: gradients of the shape functions (point, node, element), N/r, volume."""
    ra, rb, za, zb = ALONG_A @ r, ALONG_B @ r, ALONG_A @ z, ALONG_B @ z
    det = ra * zb - rb * za
    a, b = ALONG_A[:, :, None], ALONG_B[:, :, None]
    Dr = a * (zb / det)[:, None] - b * (za / det)[:, None]
    Dz = b * (ra / det)[:, None] - a * (rb / det)[:, None]
    if not axisymmetric:
        return Dr, Dz, None, det
    radius = SHAPE @ r
    return Dr, Dz, SHAPE[:, :, None] / radius[:, None], det * radius


def plastic_increment(metal, equivalent, strain, T, dt, guess):
    """Plastic strain of the step that brings the stress `equivalent` to the yield stress: Newton in a bracket."""
    law, G = metal["strength"], metal["G"]
    thermal = law.thermal(T)
    found = np.zeros_like(equivalent)
    at = np.nonzero(equivalent > law.stress(strain, found, dt, thermal)[0])
    q, p, thermal = equivalent[at], strain[at], thermal[at]
    low, high = np.zeros_like(q), q / (3 * G)
    g = np.clip(guess[at], 1e-3 * high, high)
    for _ in range(60):
        stress, slope = law.stress(p, g, dt, thermal)
        over = q - 3 * G * g - stress
        if not over.size or np.max(np.abs(over) / q) < 1e-9:
            break
        low, high = np.where(over > 0, g, low), np.where(over > 0, high, g)
        newton = g + over / (3 * G + slope)
        g = np.where((newton > low) & (newton < high), newton, 0.5 * (low + high))
    found[at] = g
    return found


def solve(metal, length, radius, speed, across, along, end, axisymmetric=True, friction=0.0, lets_go=False, courant=0.8,
          viscosity=(0.06, 1.2)):
    """Final shape, largest strain and temperature (means of an element), energies, of a body thrown at the wall at `speed`."""
    rho0, G = metal["rho"], metal["G"]
    r, z = (c.ravel() for c in np.meshgrid(np.linspace(0, radius, across + 1), np.linspace(0, length, along + 1)))
    corner = np.arange(len(r)).reshape(along + 1, across + 1)
    foot, axis, side = corner[0], corner[:, 0], corner[:, -1]
    elements = np.stack([c.ravel() for c in (corner[:-1, :-1], corner[:-1, 1:], corner[1:, 1:], corner[1:, :-1])])
    gather = lambda values: np.bincount(elements.ravel(), values.ravel(), len(r))
    weight = points(r[elements], z[elements], axisymmetric)[3]
    first_volume = weight.sum(0)
    mass = gather(rho0 * SHAPE.T @ weight)
    vr, vz = np.zeros_like(r), np.full_like(z, -float(speed))
    thrown = 0.5 * np.sum(mass * vz**2)
    vz[foot] = 0
    kinetic = lambda: 0.5 * np.sum(mass * (vr**2 + vz**2))
    # The mass of the foot stops at once: a loss that goes away with the mesh.
    kinetic_in = kinetic()
    count = len(first_volume)
    S, strain, T, flow = np.zeros((4, 4, count)), np.zeros((4, count)), np.full((4, count), metal["T0"]), np.zeros((4, count))
    energy, last_pressure, sound = np.zeros(count), np.zeros(count), np.sqrt((metal["K"] + 4 * G / 3) / rho0)
    worked = dict(plastic_work=0.0, viscous_work=0.0, friction_work=0.0, wall_work=0.0)
    t, steps = 0.0, 0
    while t < end:
        re, ze = r[elements], z[elements]
        longest = np.max([np.hypot(re[a] - re[b], ze[a] - ze[b]) for a, b in ((0, 1), (1, 2), (2, 3), (3, 0), (0, 2), (1, 3))], 0)
        area = 0.5 * ((re[2] - re[0]) * (ze[3] - ze[1]) - (re[3] - re[1]) * (ze[2] - ze[0]))
        if np.min(area) <= 0:
            raise RuntimeError(f"an element turned inside out at {t:g} s")
        dt = min(courant * np.min(area / longest) / sound, end - t + 1e-15)
        vre, vze = vr[elements], vz[elements]
        Dr, Dz, over_r, weight = points(re + 0.5 * dt * vre, ze + 0.5 * dt * vze, axisymmetric)
        r, z = r + dt * vr, z + dt * vz
        t, steps = t + dt, steps + 1
        # Rate of deformation and spin.
        drr, dzz, up, out = (Dr * vre).sum(1), (Dz * vze).sum(1), (Dz * vre).sum(1), (Dr * vze).sum(1)
        dtt = (over_r * vre).sum(1) if axisymmetric else np.zeros_like(drr)
        third, spin, shear = (drr + dzz + dtt) / 3, 0.5 * (up - out), 0.5 * (up + out)
        divergence = 3 * np.sum(weight * third, 0) / weight.sum(0)
        # Trial deviator rr, zz, tt, rz with the Jaumann rate, returned to the yield stress.
        D = np.stack([drr - third, dzz - third, dtt - third, shear])
        turn = spin * np.stack([2 * S[3], -2 * S[3], np.zeros_like(spin), S[1] - S[0]])
        trial = S + dt * (2 * G * D + turn)
        equivalent = np.sqrt(1.5 * (trial[0] ** 2 + trial[1] ** 2 + trial[2] ** 2 + 2 * trial[3] ** 2)) + 1e-9
        increment = plastic_increment(metal, equivalent, strain, T, dt, flow * dt)
        factor = 1 - 3 * G * increment / equivalent
        middle, S = 0.5 * (S + trial * factor), trial * factor
        strain, flow = strain + increment, increment / dt
        plastic_work = equivalent * factor * increment
        # Pressure with artificial viscosity, from the mean density of the element; energy takes the work of all stresses.
        Dr, Dz, over_r, weight = points(r[elements], z[elements], axisymmetric)
        volume = weight.sum(0)
        compression = first_volume / volume
        rho = rho0 * compression
        T = T + metal["beta"] * plastic_work / (rho * metal["Cp"])
        width = np.sqrt(volume / (np.mean(r[elements], 0) if axisymmetric else 1.0))
        push = rho * width * (viscosity[1] * width * divergence**2 - viscosity[0] * sound * divergence) * (divergence < 0)
        pressure = metal["pressure"](compression, energy) + push
        distortion = dt * (middle[0] * D[0] + middle[1] * D[1] + middle[2] * D[2] + 2 * middle[3] * D[3])
        energy = energy + (np.sum(distortion * weight, 0) / volume - dt * 0.5 * (last_pressure + pressure) * divergence) / rho
        last_pressure = pressure
        worked["plastic_work"] += np.sum(plastic_work * weight)
        worked["viscous_work"] -= np.sum(dt * push * divergence * volume)
        # Forces of the stresses on the nodes.
        radial = ((S[0] - pressure) * weight)[:, None] * Dr + (S[3] * weight)[:, None] * Dz
        if axisymmetric:
            radial += ((S[2] - pressure) * weight)[:, None] * over_r
        axial = ((S[1] - pressure) * weight)[:, None] * Dz + (S[3] * weight)[:, None] * Dr
        old_r, old_z = vr, vz
        vr, vz = vr - dt * gather(radial.sum(0)) / mass, vz - dt * gather(axial.sum(0)) / mass
        vr[axis] = 0
        # The wall holds the foot or lets it go, and stops nodes of the side that would go through it; what presses on it may rub.
        free = np.concatenate([foot, side[1:]]) if lets_go else side[1:]
        held = np.concatenate([foot[:0] if lets_go else foot, free[z[free] + dt * vz[free] < 0]])
        stopped = -z[held] / dt
        push_back = mass[held] * (stopped - vz[held])
        vz[held] = stopped
        rub = np.minimum(friction * np.maximum(push_back, 0), mass[held] * np.abs(vr[held])) * np.sign(vr[held])
        vr[held] -= rub / mass[held]
        worked["wall_work"] -= np.sum(push_back * 0.5 * (old_z[held] + stopped))
        worked["friction_work"] += np.sum(rub * 0.5 * (old_r[held] + vr[held]))
    elastic = np.sum(((S[0] ** 2 + S[1] ** 2 + S[2] ** 2 + 2 * S[3] ** 2) * weight)) / (4 * G)
    whole = 2 * np.pi if axisymmetric else 2
    energies = dict(thrown=thrown, kinetic_in=kinetic_in, kinetic_end=kinetic(), internal=np.sum(rho0 * first_volume * energy))
    energies |= dict(elastic_distortion=elastic) | worked
    energies = {name: float(whole * amount) for name, amount in energies.items()}
    out_of = energies["kinetic_end"] + energies["internal"] + energies["friction_work"] + energies["wall_work"]
    energies["balance"] = out_of / energies["kinetic_in"] - 1
    heights, radii = outline(r[side], z[side], np.linspace(0, z[side][-1], 20))
    return {
        "steps": steps,
        # A wall that lets go may stand off by the end.
        "length": float((z.max() - z.min()) / length),
        "foot_diameter": float(r[foot].max() / radius),
        "largest_diameter": float(r.max() / radius),
        "plastic_strain": float(strain.mean(0).max()),
        "temperature": float(T.mean(0).max()),
        "largest_density": float(rho.max() / rho0),
        "energies": energies,
        "outline": {"height_mm": (1e3 * heights).round(4).tolist(), "radius_mm": (1e3 * radii).round(4).tolist()},
        "below_side": [below_side(r[corner], z[corner], depth) for depth in DEPTHS],
        "about_axis": [about_axis(strain, across, along, radius / length, depth) for depth in DEPTHS],
    }


def about_axis(strain, across, along, radius_over_length, depth):
    """Mean plastic strain of the material that four particles about the axis at the foot stand for, each 2 `depth` wide and tall as a share
    of the radius: a disc of the area of four and as tall as one. Each integration point has the quarter of its element around it."""
    a, b, c, d = strain.reshape(4, along, across)
    fine = np.stack([np.stack([a, b], 2), np.stack([d, c], 2)], 1).reshape(2 * along, 2 * across)
    radii, heights = (np.arange(2 * n + 1) / (2 * n) for n in (across, along))
    within = np.diff(np.minimum(radii, 2 * depth * np.sqrt(4 / np.pi)) ** 2)
    below = np.diff(np.minimum(heights, 2 * depth * radius_over_length))
    return {"depth": depth, "plastic_strain": float(below @ fine @ within / (below.sum() * within.sum()))}


def below_side(r, z, depth):
    """The line of material that was `depth` below the side at first, as a share of the radius; finer towards the wall."""
    at = (1 - depth) * (r.shape[1] - 1)
    a = min(int(at), r.shape[1] - 2)
    r, z = ((1 - at + a) * c[:, a] + (at - a) * c[:, a + 1] for c in (r, z))
    heights, radii = outline(r, z, z[-1] * np.linspace(0, 1, 60) ** 2)
    return {"depth": depth, "height_mm": (1e3 * heights).round(4).tolist(), "radius_mm": (1e3 * radii).round(4).tolist()}


def outline(r, z, heights):
    """Radius of the side at heights from the wall to its top; the largest where the side folds."""
    radii = []
    for h in np.clip(heights, z.min(), z.max()):
        (a,) = np.nonzero((np.minimum(z[:-1], z[1:]) <= h) & (h <= np.maximum(z[:-1], z[1:])))
        rise = z[a + 1] - z[a]
        share = np.where(np.abs(rise) > 1e-12, (h - z[a]) / np.where(np.abs(rise) > 1e-12, rise, 1), 0)
        radii.append(np.max(np.maximum(r[a] + share * (r[a + 1] - r[a]), np.where(np.abs(rise) > 1e-12, 0, r[a + 1]))))
    return heights, np.array(radii)
