"""PySPH, started as a program of its own, see `pysph_bar`."""

import importlib.util
import json
import os
import pathlib
import subprocess
import sys

from . import Run


def installed():
    """Whether this Python has PySPH."""
    return importlib.util.find_spec("pysph") is not None


def run(folder, spacing, steps):
    """Runs the bar without OpenMP; the time is that of the steps after the first."""
    scripts = str(pathlib.Path(__file__).parent.parent)
    environment = dict(os.environ, OMP_NUM_THREADS="1", PYTHONPATH=scripts)
    command = [sys.executable, "-m", "peers.pysph_bar", str(spacing), str(steps)]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"PySPH failed:\n{done.stdout[-1000:]}{done.stderr[-1000:]}")
    return Run(**json.loads(done.stdout.splitlines()[-1]))
