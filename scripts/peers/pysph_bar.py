"""The Taylor bar in PySPH: `python -m peers.pysph_bar SPACING STEPS`, run in `scripts/`, prints a line of JSON.

The equations are those of PySPH's own example `solid_mech.taylor_bar`, which is plane: Mie-Grueneisen pressure, perfect plasticity (von
Mises), Jaumann rate, viscosity, XSPH, energy; besides artificial stress, as in its other examples of solids. Spatial are the velocity
gradient (PySPH has it) and the return to the yield surface (here: the one PySPH has looks at the stresses in a plane only). The wall is a spring
against each particle, as in LAMMPS. One evaluation a step, search every step, double precision.
"""

import json
import sys
import time
from math import sqrt

import numpy
from compyle.api import get_config
from cyarray.api import UIntArray
from pysph.base.kernels import CubicSpline
from pysph.base.nnps import LinkedListNNPS
from pysph.solver.solver import Solver
from pysph.sph.basic_equations import (
    ContinuityEquation,
    MonaghanArtificialViscosity,
    VelocityGradient3D,
    XSPHCorrection,
)
from pysph.sph.equation import Equation, Group
from pysph.sph.integrator import PECIntegrator
from pysph.sph.integrator_step import SolidMechStep
from pysph.sph.solid_mech.basic import (
    EnergyEquationWithStress,
    HookesDeviatoricStressRate,
    MomentumEquationWithStress,
    MonaghanArtificialStress,
    get_particle_array_elastic_dynamics,
)
from pysph.sph.solid_mech.hvi import MieGruneisenEOS

from . import RADIUS, SPEED, SUPPORT, layers

# Copper, SI units.
DENSITY = 8960.0
SOUND_SPEED = 3940.0
HUGONIOT_SLOPE = 1.489
GRUNEISEN = 2.02
YOUNG = 124e9
POISSON = 0.34
YIELD_STRESS = 0.4e9


class VonMises(Equation):
    """Return to the yield surface; adds up the equivalent plastic strain.

    The stress that the corrector starts from is returned too: PySPH's own return leaves it, so that what is beyond the surface
    stays in memory and comes back when the bar unloads.
    """

    def __init__(self, dest, sources, yield_stress):
        self.yield_stress = yield_stress
        super().__init__(dest, sources)

    def loop(
        self,
        d_idx,
        d_s00,
        d_s01,
        d_s02,
        d_s11,
        d_s12,
        d_s22,
        d_s000,
        d_s010,
        d_s020,
        d_s110,
        d_s120,
        d_s220,
        d_plastic_strain,
        d_G,
    ):
        diagonal = d_s00[d_idx] * d_s00[d_idx] + d_s11[d_idx] * d_s11[d_idx] + d_s22[d_idx] * d_s22[d_idx]
        rest = d_s01[d_idx] * d_s01[d_idx] + d_s02[d_idx] * d_s02[d_idx] + d_s12[d_idx] * d_s12[d_idx]
        stress = sqrt(1.5 * (diagonal + 2.0 * rest))
        if stress > self.yield_stress:
            share = self.yield_stress / stress
            d_s00[d_idx] *= share
            d_s01[d_idx] *= share
            d_s02[d_idx] *= share
            d_s11[d_idx] *= share
            d_s12[d_idx] *= share
            d_s22[d_idx] *= share
            d_s000[d_idx] *= share
            d_s010[d_idx] *= share
            d_s020[d_idx] *= share
            d_s110[d_idx] *= share
            d_s120[d_idx] *= share
            d_s220[d_idx] *= share
            d_plastic_strain[d_idx] += (stress - self.yield_stress) / (3.0 * d_G[0])


class Wall(Equation):
    """Spring against particles nearer than half a spacing to the plane z = 0."""

    def __init__(self, dest, sources, stiffness, reach):
        self.stiffness = stiffness
        self.reach = reach
        super().__init__(dest, sources)

    def loop(self, d_idx, d_z, d_m, d_aw):
        if d_z[d_idx] < self.reach:
            d_aw[d_idx] += self.stiffness * (self.reach - d_z[d_idx]) / d_m[d_idx]


def bar(spacing, kernel):
    """Particles of the bar; lengths in m."""
    smoothing = SUPPORT / kernel.radius_scale * spacing
    side = (numpy.arange(-100, 100) + 0.5) * spacing
    height = (numpy.arange(layers(spacing * 1e3)) + 0.5) * spacing
    x, y, z = (values.ravel() for values in numpy.meshgrid(side, side, height, indexing="ij"))
    inside = x * x + y * y <= (RADIUS * 1e-3) ** 2
    particles = get_particle_array_elastic_dynamics(
        name="bar",
        x=x[inside],
        y=y[inside],
        z=z[inside],
        w=-SPEED,
        h=smoothing,
        m=DENSITY * spacing**3,
        rho=DENSITY,
        constants={
            "E": YOUNG,
            "nu": POISSON,
            "rho_ref": DENSITY,
            "wdeltap": kernel.kernel(rij=spacing, h=smoothing),
            "n": 4,
        },
    )
    particles.add_property("plastic_strain")
    return particles


def equations(spacing):
    """Two passes over the pairs: velocity gradient, then all that needs the stresses of neighbours."""
    viscosity = {"alpha": 1.0, "beta": 1.0}
    alone = {"dest": "bar", "sources": None}
    pairs = {"dest": "bar", "sources": ["bar"]}
    return [
        Group(
            equations=[
                MieGruneisenEOS(**alone, gamma=GRUNEISEN, r0=DENSITY, c0=SOUND_SPEED, S=HUGONIOT_SLOPE),
                VelocityGradient3D(**pairs),
                VonMises(**alone, yield_stress=YIELD_STRESS),
                MonaghanArtificialStress(**alone, eps=0.3),
            ]
        ),
        Group(
            equations=[
                ContinuityEquation(**pairs),
                MomentumEquationWithStress(**pairs),
                MonaghanArtificialViscosity(**pairs, **viscosity),
                EnergyEquationWithStress(**pairs, **viscosity, eta=0.01),
                HookesDeviatoricStressRate(**alone),
                XSPHCorrection(**pairs, eps=0.5),
                Wall(**alone, stiffness=YOUNG * spacing, reach=0.5 * spacing),
            ]
        ),
    ]


def mean_neighbors(search, count):
    """Mean number of neighbours, the particle itself left out."""
    found, total = UIntArray(), 0
    search.set_context(0, 0)
    for particle in range(count):
        search.get_nearest_particles(0, 0, particle, found)
        total += found.length - 1
    return total / count


def main():
    spacing, steps = float(sys.argv[1]) * 1e-3, int(sys.argv[2])
    get_config().use_openmp = False
    kernel = CubicSpline(dim=3)
    particles = bar(spacing, kernel)
    count = particles.get_number_of_particles()
    solver = Solver(
        kernel=kernel,
        dim=3,
        integrator=PECIntegrator(bar=SolidMechStep()),
        dt=0.2 * spacing * SUPPORT / kernel.radius_scale / SOUND_SPEED,
        tf=1.0,
    )
    search = LinkedListNNPS(dim=3, particles=[particles], radius_scale=kernel.radius_scale, cache=True)
    solver.set_parallel_manager(None)
    solver.setup([particles], equations(spacing), search, kernel, fixed_h=True)
    neighbors = mean_neighbors(search, count)
    solver.set_disable_output(True)
    solver.set_max_steps(steps + 1)
    ends = []
    solver.add_post_step_callback(lambda _: ends.append(time.perf_counter()))
    solver.solve(show_progress=False)
    print(
        json.dumps(
            {
                "particles": count,
                "neighbors": neighbors,
                "rate": count * steps / (ends[-1] - ends[0]),
                "time": solver.t * 1e6,
                "extent": float(numpy.ptp(particles.z) + spacing) * 1e3,
                "plastic_strain": float(particles.plastic_strain.max()),
            }
        )
    )


if __name__ == "__main__":
    main()
