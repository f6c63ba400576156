"""The same Taylor bar in several codes, one module each.

Copper, 7.62 x 25.4 mm, 190 m/s on a rigid wall; particles on a cubic lattice, half a spacing from the wall at the start; cubic spline
or a kernel of the same support, radius 2.5 spacings.
"""

import dataclasses
import math

RADIUS = 3.81
"""Radius of the bar, mm."""

LENGTH = 25.4
"""Length of the bar, mm."""

SPEED = 190.0
"""Speed of the impact, m/s."""

SUPPORT = 2.5
"""Radius of the kernel, spacings."""


@dataclasses.dataclass
class Run:
    """What a run took and what it came to."""

    particles: int
    neighbors: float
    """Mean number of neighbours of a particle, itself left out."""
    rate: float
    """Particle-steps a second of the steps alone, on one core."""
    time: float
    """Simulated time, us."""
    extent: float
    """From the lowest to the highest particle at the end, plus one spacing, mm."""
    plastic_strain: float
    """Largest equivalent plastic strain at the end."""

    def shortened(self, spacing):
        """How much the bar has become shorter, mm."""
        return layers(spacing) * spacing - self.extent

    def check(self, code, spacing):
        """Ends the program where the run cannot be that of a bar that hit a wall."""
        lost, closed = self.shortened(spacing), SPEED * self.time / 1000.0
        if not math.isfinite(self.plastic_strain) or self.plastic_strain <= 0.0 or not 0.0 < lost < 1.1 * closed:
            raise SystemExit(f"{code}: no bar that hit a wall: {self}, shorter by {lost} mm, closed in by {closed} mm")


def layers(spacing):
    """Layers of particles along the bar: centres half a spacing from the wall, a spacing apart, none outside."""
    return math.floor(LENGTH / spacing + 0.5 + 1e-9)
