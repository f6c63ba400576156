"""A run on ranks of this machine: the command line, started by ``mpirun``."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _sphorge
from ._errors import FolderError, SphorgeError

if TYPE_CHECKING:
    from ._deck import Deck

_ALONE = "a run on ranks is a program of its own: its frames can be looped over, and that is all"
_WHY = "leave out ranks, or look at the frames"


class RankedDriver:
    """Looks at a run that others make as if it drove it."""

    def __init__(self, deck: Deck, folder: Path, ranks: int, options: list[str]) -> None:
        if not _sphorge.has_mpi:
            raise SphorgeError(
                "this package was built without MPI, which `ranks` needs",
                hint="build it by `maturin build --features mpi --auditwheel skip` in crates/sphorge-py; without MPI, `threads` can use all processors of one machine",
            )
        mpirun = shutil.which("mpirun")
        if mpirun is None:
            raise SphorgeError("there is no `mpirun` here", hint="it comes with MPI (Debian: apt install openmpi-bin)")
        checked = deck.check()
        self.particles: int = checked["particles"]
        # Told once.
        self._notes: list[str] = checked["notes"]
        self._folder = folder
        self._process = os.getpid()
        self._own = Path(tempfile.mkdtemp(prefix="sphorge-"))
        path, text, overrides = deck._deck.source()
        if path is None:
            path = self._own / f"{deck.name}.toml"
            path.write_text(text, encoding="utf-8")
        words = [f"--set={key}={value}" for key, value in overrides]
        # More ranks than processors, and threads of a rank on any of them, as `sphorge run --ranks` starts them.
        settings = {"OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_hwloc_base_binding_policy": "none", "OMPI_MCA_orte_execute_quiet": "1"}
        program = [mpirun, "-n", str(ranks), sys.executable, "-m", "sphorge", "run", os.fspath(path), "-o", os.fspath(folder), "--quiet"]
        self._told = open(self._own / "told", "wb+")
        self._running = subprocess.Popen(
            [*program, *options, *words],
            env={**os.environ, **settings},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=self._told,
            start_new_session=True,
        )
        self._frames = 0
        self._is_asked = False
        self._reached = (0, 0.0)

    def _look(self) -> tuple[Any, ...]:
        """What is new in the folder."""
        code = self._running.poll()
        try:
            listed = _sphorge.frames(self._folder)
        except FolderError:
            # Not yet.
            listed = []
        new = [(index, listed[index][0]) for index in range(self._frames, len(listed))]
        self._frames = max(self._frames, len(listed))
        if new:
            self._reached = (_sphorge.Frame(listed[-1][1]).step, new[-1][1])
        step, reached = self._reached
        notes, self._notes = self._notes, []
        return (code is not None, step, reached, 0.0, new, notes, [])

    def news(self) -> tuple[Any, ...]:
        return self._look()

    def go(self, *, step: int | None = None, time: float | None = None, frame: bool = False, seconds: float | None = None) -> tuple[Any, ...]:
        if step is not None or time is not None:
            raise SphorgeError(_ALONE, hint=_WHY)
        since = _clock()
        while True:
            seen = self._look()
            if seen[0] or (frame and seen[4]) or (seconds is not None and _clock() - since > seconds):
                return seen
            try:
                self._running.wait(0.05)
            except subprocess.TimeoutExpired:
                pass
            except KeyboardInterrupt:
                self.stop()
                raise

    @property
    def at(self) -> tuple[int, float]:
        return self._reached

    def ask_to_stop(self) -> None:
        # Once: at a second one they would not save.
        if self._running.poll() is None and os.getpid() == self._process and not self._is_asked:
            self._is_asked = True
            # `mpirun` gives this signal to its ranks, which save their states.
            self._running.send_signal(signal.SIGUSR2)

    def stop(self, by: str | None = None) -> None:
        if self._running.poll() is None and os.getpid() == self._process:
            self.ask_to_stop()
            self._running.wait()

    def summary(self) -> str | None:
        code = self._running.poll()
        if code is None:
            return None
        if code not in (0, 130):
            self._told.seek(0)
            text = self._told.read().decode("utf-8", "replace").strip()
            raise SphorgeError(_sphorge.words(text) or f"the run on ranks ended with code {code}")
        return _sphorge.summary(self._folder)

    def whole(self) -> None:
        return None

    def read(self, field: str) -> Any:
        raise SphorgeError(_ALONE, hint=_WHY)

    def drive(self, forces: Any, velocities: Any) -> None:
        raise SphorgeError(_ALONE, hint=_WHY)

    def __del__(self) -> None:
        if getattr(self, "_running", None) is not None:
            self.stop()
            self._told.close()
            shutil.rmtree(self._own, ignore_errors=True)


def _clock() -> float:
    return time.monotonic()
