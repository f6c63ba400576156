"""Sphorge: Johnson-Cook with heat, Mie-Grueneisen pressure, viscosity, artificial stress, XSPH, energy.

With `search = "total-lagrangian"`: corrected gradients, bulk viscosity, hourglass control that yields with the material; no artificial
stress and no XSPH, which belong to sums over current neighbours.
"""

import json
import subprocess

from . import RADIUS, SPEED, SUPPORT, Run, layers

DECK = """
dimensions = "3d"
search = "{search}"
particles = {{ spacing = "{spacing} mm", smoothing = {smoothing}, lattice = "square" }}

[numerics]
precision = "{precision}"
artificial-stress = true
xsph = 0.5

[time]
end = "80 us"
max-steps = {steps}

[output]
frames = 1
history-interval = "80 us"

[[body]]
name = "bar"
material = "ofhc-copper"
shape = {{ cylinder = {{ from = ["0 mm", "0 mm", "0 mm"], to = ["0 mm", "0 mm", "{length} mm"], radius = "{radius} mm" }} }}
velocity = ["0 m/s", "0 m/s", "-{speed} m/s"]

[[wall]]
name = "anvil"
plane = {{ point = ["0 mm", "0 mm", "0 mm"], normal = [0, 0, 1] }}

[[measure]]
name = "length"
extent = {{ axis = "z" }}

[[measure]]
name = "plastic-strain"
maximum = {{ field = "plastic_strain" }}
"""


def run(program, folder, spacing, steps, precision, search):
    """Runs the bar on one thread; output is left out of the time."""
    deck = folder / "bar.toml"
    deck.write_text(
        DECK.format(
            spacing=spacing,
            smoothing=SUPPORT / 2.0,
            steps=steps,
            precision=precision,
            search=search,
            # The whole number of layers that the other codes have, the first half a spacing from the wall.
            length=layers(spacing) * spacing,
            radius=RADIUS,
            speed=SPEED,
        )
    )
    out = folder / "sphorge"
    command = [program, "run", str(deck), "-o", str(out), "--overwrite", "--threads", "1"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"Sphorge failed:\n{done.stderr[-1000:]}")
    summary = json.loads((out / "summary.json").read_text())
    seconds = sum(time for stage, time in summary["stage_seconds"].items() if stage != "output")
    return Run(
        particles=summary["particles"],
        neighbors=summary["mean_neighbors"],
        rate=summary["particles"] * summary["steps"] / seconds,
        time=summary["simulated_time"] * 1e6,
        extent=summary["measures"]["length"] * 1e3,
        plastic_strain=summary["measures"]["plastic-strain"],
    )
