#!/usr/bin/env python3
"""What the package for Python costs: callbacks, iteration against the command line, import, and what a new user waits for. Seconds are those of the processor, the smallest of
some turns, so that a machine that is shared can be measured on; those of a new user are of the clock on the wall.

    scripts/measure_python.py WHEEL [--write]

In an environment that has the package of that wheel. With --write the figures are written to docs/python.md, where they are quoted.
"""

from __future__ import annotations

import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import sphorge as sp

TURNS = 5
PAGE = Path(__file__).parents[1] / "docs/python.md"
#: What stands between these lines is written anew.
BEGIN, END = "<!-- written by scripts/measure_python.py -->\n", "<!-- end of it -->\n"


def processor(of: int = resource.RUSAGE_SELF) -> float:
    used = resource.getrusage(of)
    return used.ru_utime + used.ru_stime


def smallest(measures: dict[str, Callable[[], float]]) -> dict[str, float]:
    """Of each the smallest of some turns, one after the other."""
    found = {name: float("inf") for name in measures}
    for _ in range(TURNS):
        for name, measure in measures.items():
            found[name] = min(found[name], measure())
    return found


def first_picture(wheel: Path, place: Path) -> list[float]:
    """Seconds of the clock on the wall to install the wheel in a fresh environment, to run `iron-plate`, and to draw its pictures."""
    subprocess.run([sys.executable, "-m", "venv", str(place / "fresh")], check=True)
    python = str(place / "fresh/bin/python")
    seconds = []
    for command in (
        [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", str(wheel)],
        [python, "-m", "sphorge", "run", "iron-plate", "-o", str(place / "first"), "--quiet"],
        [python, "-m", "sphorge", "plot", str(place / "first")],
    ):
        start = time.monotonic()
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        seconds.append(time.monotonic() - start)
    return seconds


def main() -> None:
    wheel = Path(next((word for word in sys.argv[1:] if not word.startswith("-")), "")).absolute()
    if wheel.suffix != ".whl":
        sys.exit(__doc__)
    place = Path(tempfile.mkdtemp(prefix="sphorge-"))
    deck = sp.Deck("iron-plate")
    deck["particles.spacing"] = "0.6365 mm"
    deck["output.frames"] = 10
    (place / "bar.toml").write_text(deck.text)

    def driven(prepare: Callable[[sp.Simulation], None], loop: bool) -> Callable[[], float]:
        def measure() -> float:
            start = processor()
            simulation = sp.Simulation(deck, out=place / "driven", threads=1, overwrite=True)
            prepare(simulation)
            if loop:
                for _ in simulation:
                    pass
            else:
                simulation.run()
            return processor() - start

        return measure

    def told() -> float:
        start = processor(resource.RUSAGE_CHILDREN)
        run = [sys.executable, "-m", "sphorge", "run", str(place / "bar.toml"), "-o", str(place / "told"), "--threads", "1", "--overwrite", "--quiet"]
        subprocess.run(run, check=True, stdout=subprocess.DEVNULL)
        return processor(resource.RUSAGE_CHILDREN) - start

    def nothing() -> float:
        start = processor(resource.RUSAGE_CHILDREN)
        subprocess.run([sys.executable, "-m", "sphorge", "--version"], check=True, stdout=subprocess.DEVNULL)
        return processor(resource.RUSAGE_CHILDREN) - start

    def imported() -> float:
        program = "import time; t = time.process_time(); import sphorge; print(time.process_time() - t)"
        return float(subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout)

    try:
        seconds = smallest(
            {
                "command line": told,
                "start of it": nothing,
                "run": driven(lambda simulation: None, loop=False),
                "frames": driven(lambda simulation: None, loop=True),
                "callback every step": driven(lambda simulation: simulation.every(steps=1)(lambda state: None) and None, loop=False),
                "load every step": driven(lambda simulation: simulation.load("bar")(lambda state: [0.0, 0.0]) and None, loop=False),
                "field every step": driven(lambda simulation: simulation.every(steps=1)(lambda state: state["pressure"]) and None, loop=False),
                "import": imported,
            }
        )
        summary = sp.Run(place / "driven").summary
        assert summary is not None
        steps, particles = summary["steps"], summary["particles"]
        alone = seconds["command line"] - seconds["start of it"]
        against = [100 * (seconds[name] / alone - 1) for name in ("run", "frames")]
        calls = {name: f"{1e6 * (seconds[name] - seconds['run']) / steps:.0f} µs a step" for name in ("callback every step", "load every step", "field every step")}
        install, run, draw = first_picture(wheel, place)
        rows = {
            "`for frame in simulation` against `sphorge run`": f"{against[1]:+.1f} %",
            "`simulation.run()` against `sphorge run`": f"{against[0]:+.1f} %",
            "a callback every step that does nothing": calls["callback every step"],
            "a load every step": calls["load every step"],
            "a callback every step that reads a field": calls["field every step"],
            "`import sphorge`, without numpy, which comes with the first array": f"{seconds['import']:.2f} s",
            "the wheel": f"{wheel.stat().st_size / 1e6:.1f} MB",
            "a new user: to install the wheel and numpy, to run `iron-plate`, to draw its pictures": f"{install:.0f} s, {run:.0f} s, {draw:.0f} s",
        }
        text = (
            f"Measured by `scripts/measure_python.py` on one core, in seconds of the processor, of a Taylor impact of {particles} particles whose {steps} steps take "
            f"{1e3 * seconds['run'] / steps:.2f} ms each; what a new user waits for is by the clock, on {os.cpu_count()} cores:\n\n| | |\n|---|---|\n"
        )
        text += "".join(f"| {what} | {figure} |\n" for what, figure in rows.items())
        print(text)
        if "--write" in sys.argv:
            page = PAGE.read_text(encoding="utf-8")
            before, after = page.split(BEGIN)[0], page.split(END)[1]
            PAGE.write_text(f"{before}{BEGIN}{text}{END}{after}", encoding="utf-8")
    finally:
        shutil.rmtree(place)


main()
