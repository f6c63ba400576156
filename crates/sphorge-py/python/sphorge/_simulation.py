"""Simulations that a program drives."""

from __future__ import annotations

import atexit
import json
import math
import os
import warnings
import weakref
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from types import TracebackType
from typing import Any, TYPE_CHECKING

from . import _sphorge
from ._arrays import array
from ._deck import Deck, _as_deck
from ._errors import SphorgeError, SphorgeWarning
from ._run import Frame, Run, _seconds

if TYPE_CHECKING:
    from ._arrays import Array


class _Stop:
    """The type of `STOP`."""

    def __repr__(self) -> str:
        return "sphorge.STOP"


#: Returned by a callback, it ends the run as Ctrl-C does.
STOP = _Stop()

#: Unit and meaning of every field.
fields: dict[str, tuple[str, str]] = {name: (unit, meaning) for name, unit, _, meaning in _sphorge.fields()}

Callback = Callable[["State"], Any]


class State:
    """A simulation between two of its steps. Its fields can be read until the simulation goes on.

    >>> speed = state["speed"]                  # read-only, double precision, in the order of the particles' ids
    """

    def __init__(self, simulation: Simulation, step: int, time: float, dt: float) -> None:
        self._simulation = simulation
        self._turn = simulation._turn
        #: Steps done.
        self.step = step
        #: Time, s.
        self.time = time
        #: Size of the last step, s.
        self.dt = dt

    @property
    def count(self) -> int:
        """Number of particles."""
        return self._simulation.particles

    @property
    def positions(self) -> Array:
        """Positions, (particles, 3), m."""
        return self["position"]

    @property
    def units(self) -> dict[str, str]:
        """SI unit of every field."""
        return {name: unit for name, (unit, _) in fields.items()}

    def __getitem__(self, field: str) -> Array:
        if self._turn != self._simulation._turn:
            raise SphorgeError(f"this state is gone: the simulation has gone on from step {self.step}", hint="copy what is needed later")
        return array(self._simulation._driver.read(field))

    def __repr__(self) -> str:
        return f"<sphorge.State at step {self.step}, {self.time:g} s>"


class _Every:
    """A callback with its interval."""

    def __init__(self, call: Callback, steps: int | None, time: float | None, step: int, now: float) -> None:
        self.call, self.steps, self.time = call, steps, time
        self.next_step = None if steps is None else (step // steps + 1) * steps
        self.next_time = None if time is None else (math.floor(now / time * (1 + 1e-9)) + 1) * time

    def is_due(self, step: int, time: float) -> bool:
        """Whether it is to be called now; if so, when next."""
        if self.next_step is not None and self.steps is not None and step >= self.next_step:
            self.next_step = (step // self.steps + 1) * self.steps
            return True
        if self.next_time is not None and self.time is not None and time >= self.next_time * (1 - 1e-12):
            self.next_time = (math.floor(time / self.time * (1 + 1e-9)) + 1) * self.time
            return True
        return False


class Simulation:
    """A run that goes on while its frames are asked for. It writes the same files as ``sphorge run``.

    >>> for frame in sphorge.Simulation("iron-plate"):
    ...     print(frame.time, frame["plastic_strain"].max())

    The deck is read when the simulation is made: later changes of it change nothing.
    """

    def __init__(
        self,
        deck: Deck | str | os.PathLike[str] | Mapping[str, Any],
        out: str | os.PathLike[str] | None = None,
        *,
        threads: int | None = None,
        engine: str = "cpu",
        device: str | None = None,
        overwrite: bool = False,
        checkpoint_minutes: float = 10.0,
        checkpoint_at_end: bool = False,
    ) -> None:
        deck = _as_deck(deck)
        folder = Path("out") / deck.name if out is None else Path(out)
        _check_threads(threads)
        self._begin(
            folder,
            _sphorge.Driver(
                deck._deck,
                folder,
                threads=threads,
                engine_name=engine,
                device=device,
                overwrite=overwrite,
                checkpoint_minutes=checkpoint_minutes,
                checkpoint_at_end=checkpoint_at_end,
            ),
        )

    @classmethod
    def resume(
        cls,
        folder: str | os.PathLike[str],
        set: Mapping[str, Any] | None = None,
        *,
        threads: int | None = None,
        device: str | None = None,
        checkpoint_minutes: float = 10.0,
        checkpoint_at_end: bool = False,
    ) -> Simulation:
        """Goes on with the run in a folder from its last checkpoint, as ``sphorge resume`` does."""
        from ._toml import override

        _check_threads(threads)
        simulation = cls.__new__(cls)
        overrides = [(key, override(value, key)) for key, value in (set or {}).items()]
        driver = _sphorge.Driver.resume(
            Path(folder),
            overrides,
            threads=threads,
            device=device,
            checkpoint_minutes=checkpoint_minutes,
            checkpoint_at_end=checkpoint_at_end,
        )
        simulation._begin(Path(folder), driver)
        return simulation

    def _begin(self, folder: Path, driver: _sphorge.Driver) -> None:
        #: Folder of the run.
        self.folder = folder
        #: What there was to note.
        self.notes: list[str] = []
        #: Names and texts of what checks have found broken.
        self.warnings: list[tuple[str, str]] = []
        self._driver = driver
        self._pending: list[int] = []
        self._latest = -1
        self._turn = 0
        self._every: list[_Every] = []
        self._is_calling = False
        self._has_ended = False
        self._concluded = False
        self._step, self._time, self._dt = 0, 0.0, 0.0
        _open.add(self)
        self._take(driver.news())

    def _take(self, progress: tuple[Any, ...]) -> None:
        """Takes what the run tells."""
        self._has_ended, self._step, self._time, self._dt, frames, notes, found = progress
        # Where steps were taken back, a frame comes again.
        new = [index for index, _ in frames if index > self._latest]
        self._pending += new
        self._latest = max([self._latest, *new])
        self.notes += notes
        self.warnings += found
        for _, text in found:
            warnings.warn(text, SphorgeWarning, stacklevel=4)

    def _refuse_a_callback(self) -> None:
        if self._is_calling:
            message = "a callback cannot drive the run that calls it between two steps"
            raise SphorgeError(message, hint="return sphorge.STOP to end the run")

    def _advance(self, *, step: int | None = None, frame: bool = False) -> None:
        """Goes on to a step, the next frame or the end, and calls what is due on the way."""
        self._refuse_a_callback()
        while not self._has_ended:
            steps = [every.next_step for every in self._every if every.next_step is not None]
            times = [every.next_time for every in self._every if every.next_time is not None]
            if step is not None:
                steps.append(step)
            self._turn += 1
            self._take(self._driver.go(step=min(steps, default=None), time=min(times, default=None), frame=frame))
            if self._has_ended:
                return
            self._call()
            if self._has_ended or (step is not None and self._step >= step) or (frame and self._pending):
                return

    def _call(self) -> None:
        """Calls the callbacks that are due."""
        for every in [every for every in self._every if every.is_due(self._step, self._time)]:
            self._is_calling = True
            try:
                asked = every.call(self.state)
            except BaseException:
                # The files are complete before anyone hears of it.
                self._is_calling = False
                self._finish()
                raise
            finally:
                self._is_calling = False
            if asked is STOP:
                self._finish()
                return

    def _finish(self) -> None:
        """Ends the run where it is, which saves its state."""
        self._turn += 1
        self._driver.stop()
        self._take(self._driver.news())

    def _conclude(self) -> None:
        """Raises what the run has failed by, once."""
        if not self._concluded:
            self._concluded = True
            _open.discard(self)
            self._driver.summary()

    @property
    def particles(self) -> int:
        """Number of particles."""
        return self._driver.particles

    @property
    def time(self) -> float:
        """Time reached, s."""
        return self._time

    @property
    def steps(self) -> int:
        """Steps done."""
        return self._step

    @property
    def has_ended(self) -> bool:
        """Whether there is no step to come."""
        return self._has_ended

    @property
    def state(self) -> State:
        """The present state, until the simulation goes on."""
        return State(self, self._step, self._time, self._dt)

    @property
    def summary(self) -> dict[str, Any] | None:
        """The summary of the run once it has ended."""
        if not self._has_ended:
            return None
        text = self._driver.summary()
        return None if text is None else json.loads(text)

    def step(self) -> State | None:
        """Takes a step; the state after it, or ``None`` if the run has ended."""
        self._advance(step=self._step + 1)
        if self._has_ended:
            self._conclude()
            return None
        return self.state

    def run(self) -> Run:
        """Goes on to the end, and returns the run with its files."""
        self._advance()
        self._conclude()
        return Run(self.folder)

    def stop(self) -> Run:
        """Ends the run where it is and saves its state, as Ctrl-C does; nothing if it has ended."""
        self._refuse_a_callback()
        if not self._has_ended:
            self._finish()
        self._conclude()
        return Run(self.folder)

    def every(self, *, steps: int | None = None, time: float | str | None = None) -> Callable[[Callback], Callback]:
        """Has a function called with the `State` after every so many steps, or after the first step past every multiple of a time.

        >>> @simulation.every(time="1 us")
        ... def watch(state):
        ...     return sphorge.STOP if state["temperature"].max() > 900 else None

        An exception that it raises ends the run as Ctrl-C does, and is passed on.
        """
        if (steps is None) == (time is None):
            raise TypeError("every(): give either steps or time")
        if steps is not None and (isinstance(steps, bool) or not isinstance(steps, int) or steps < 1):
            raise ValueError(f"every(): steps is a whole number from 1 on, not {steps!r}")
        interval = None if time is None else _seconds(time)
        if interval is not None and not (math.isfinite(interval) and interval > 0):
            raise ValueError(f"every(): time is above zero, not {time!r}")

        def add(call: Callback) -> Callback:
            if not callable(call):
                raise TypeError(f"every(): {call!r} cannot be called")
            self._every.append(_Every(call, steps, interval, self._step, self._time))
            return call

        return add

    def __iter__(self) -> Iterator[Frame]:
        return self

    def __next__(self) -> Frame:
        self._refuse_a_callback()
        if not self._pending:
            self._advance(frame=True)
        if not self._pending:
            self._conclude()
            raise StopIteration
        index = self._pending.pop(0)
        single = self.folder / "fields" / f"{index:06}.vtp"
        pieces = self.folder / "fields" / f"{index:06}.pvtp"
        return Frame(pieces if pieces.exists() and not single.exists() else single)

    def __enter__(self) -> Simulation:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if not self._has_ended:
            self._finish()
        if error is None:
            self._conclude()

    def __repr__(self) -> str:
        where = "ended" if self._has_ended else "under way"
        return f"<sphorge.Simulation in {os.fspath(self.folder)!r}: {where}, step {self._step}, {self._time:g} s>"


def _check_threads(threads: int | None) -> None:
    if threads is not None and (isinstance(threads, bool) or not isinstance(threads, int) or not 1 <= threads <= 4096):
        raise ValueError(f"threads is a whole number from 1 to 4096, not {threads!r}")


_open: weakref.WeakSet[Simulation] = weakref.WeakSet()
_process = os.getpid()


@atexit.register
def _close() -> None:
    """Saves the states of simulations that were left, before the process takes their threads away."""
    if os.getpid() != _process:
        return
    for simulation in list(_open):
        try:
            simulation._driver.stop()
        except Exception:  # noqa: BLE001 (there is nobody left to tell)
            pass
