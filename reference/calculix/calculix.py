"""Runs CalculiX and reads the tables it prints. Needs `ccx` (Debian: calculix-ccx) and Python's standard library."""

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path


def version():
    """What `ccx -v` says."""
    text = subprocess.run(["ccx", "-v"], capture_output=True, text=True).stdout
    found = re.search(r"[Vv]ersion\s+([\w.]+)", text)
    return f"CalculiX {found.group(1)}" if found else "CalculiX"


def run(model, folder=None):
    """Solves a model given as text; tables of its .dat file: [(heading, time, [row, ...]), ...], rows of numbers."""
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(folder or temporary)
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "model.inp").write_text(model)
        environment = dict(os.environ, OMP_NUM_THREADS=os.environ.get("OMP_NUM_THREADS", "1"))
        done = subprocess.run(["ccx", "model"], cwd=folder, capture_output=True, text=True, env=environment)
        if done.returncode != 0 or "*ERROR" in done.stdout:
            sys.exit(done.stdout[-3000:] + done.stderr[-1000:])
        return tables((folder / "model.dat").read_text())


def tables(text):
    """Tables of a .dat file."""
    found = []
    for line in text.splitlines():
        words = line.split()
        if not words:
            continue
        heading = re.match(r"\s*(.*?)\s+and time\s+(\S+)", line)
        if heading:
            found.append((heading.group(1).split(" for set")[0], float(heading.group(2)), []))
        elif found:
            try:
                found[-1][2].append([float(word) for word in words])
            except ValueError:
                pass
    return found


def lines(numbers, per_line=10):
    """A list of numbers as lines of an input file."""
    numbers = [str(n) for n in numbers]
    return "\n".join(", ".join(numbers[k : k + per_line]) for k in range(0, len(numbers), per_line))
