"""Simulations that a program drives."""

from __future__ import annotations

import atexit
import json
import math
import os
import threading
import time
import warnings
import weakref
from collections.abc import Callable, Coroutine, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from types import TracebackType
from typing import Any, NoReturn, TYPE_CHECKING

from . import _notebook, _sphorge
from ._arrays import array
from ._deck import Deck, _as_deck, folder_for
from ._errors import FolderError, RunFailed, SphorgeError, SphorgeNote, SphorgeWarning
from ._run import Frame, Run, _seconds
from ._words import absolute, check_threads, did_you_mean, printable, repr_of, whole

if TYPE_CHECKING:
    from ._arrays import Array


class _Stop:
    """The type of `STOP`."""

    def __reduce__(self) -> str:
        # The one there is, also in another process.
        return "STOP"

    def __repr__(self) -> str:
        return "sphorge.STOP"


#: Returned by a callback, it ends the run as Ctrl-C does.
STOP = _Stop()

#: Unit and meaning of every field.
fields: dict[str, tuple[str, str]] = {name: (unit, meaning) for name, unit, _, meaning in _sphorge.fields()}

Callback = Callable[["State"], Any]

#: More steps than a run can count.
_MOST_STEPS = 2**62
#: Shorter than any step, s.
_SHORTEST = 1e-30

#: SI unit of the force on a body in one, two and three dimensions.
_FORCES = ("N/m^2", "N/m", "N")


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

    The deck is read when the simulation is made: later changes of it change nothing. ``ranks`` starts that many processes of this machine, which share the run; its
    frames can be looped over, and nothing else. ``progress`` shows a bar, in notebooks unless it is ``False``.
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
        ranks: int | None = None,
        progress: bool | None = None,
    ) -> None:
        deck = _as_deck(deck)
        given = folder_for(deck, "", out)
        folder = absolute(given)
        threads, ranks = check_threads(threads), check_threads(ranks, "ranks")
        if ranks is not None:
            from ._ranks import RankedDriver

            options = ["--engine", engine, *([] if device is None else ["--device", device]), *(["--overwrite"] if overwrite else [])]
            options += [] if threads is None else ["--threads", str(threads)]
            options += ["--checkpoint-minutes", str(checkpoint_minutes), *(["--checkpoint-at-end"] if checkpoint_at_end else [])]
            self._begin(folder, RankedDriver(deck, folder, ranks, options), given, progress)
            self._warn_of_the_deck()
            return
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
            given,
            progress,
        )
        self._warn_of_the_deck()

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
        progress: bool | None = None,
    ) -> Simulation:
        """Goes on with the run in a folder from its last checkpoint, as ``sphorge resume`` does."""
        from ._toml import override

        threads = check_threads(threads)
        if set is not None and not isinstance(set, Mapping):
            raise TypeError(f"resume(): set is a dict of keys and their values, not {type(set).__name__}")
        simulation = cls.__new__(cls)
        overrides = [(key, override(value, key)) for key, value in (set or {}).items()]
        place = absolute(folder)
        driver = _sphorge.Driver.resume(
            place,
            overrides,
            threads=threads,
            device=device,
            checkpoint_minutes=checkpoint_minutes,
            checkpoint_at_end=checkpoint_at_end,
        )
        simulation._begin(place, driver, Path(folder), progress)
        return simulation

    def _begin(self, folder: Path, driver: Any, given: Path, progress: bool | None) -> None:
        #: Folder of the run, absolute.
        self.folder = folder
        self._given = given
        #: What there was to note.
        self.notes: list[str] = []
        #: Names and texts of what checks have found broken.
        self.warnings: list[tuple[str, str]] = []
        self._driver = driver
        self._pending: list[int] = []
        self._latest = -1
        self._turn = 0
        self._every: list[_Every] = []
        self._loads: dict[int, Callback] = {}
        self._motions: dict[int, Callback] = {}
        self._is_calling = False
        # Held by the thread that drives it, and which one that is.
        self._helm = threading.Lock()
        self._thread: int | None = None
        self._is_asked_to_stop = False
        self._has_ended = False
        self._concluded = False
        self._step, self._time, self._dt = 0, 0.0, 0.0
        _open.add(self)
        self._take(driver.news())
        whole = driver.whole()
        self._end: float | None = None if whole is None else whole[0]
        self._most_steps: int | None = None if whole is None else whole[1]
        self._can_be_driven: bool = whole is not None and whole[2][0]
        # Bodies and motions that a program drove before the run was stopped.
        self._were_loaded: list[bool] = [] if whole is None else whole[2][1]
        self._were_moved: list[bool] = [] if whole is None else whole[2][2]
        self._dimensions: int = 0 if whole is None else whole[3]
        self._bodies: list[str] = [] if whole is None else whole[4]
        self._regions: list[str] = [] if whole is None else whole[5]
        shows = _notebook.is_notebook() if progress is None else bool(progress)
        self._bar = _notebook.Bar(folder.name) if shows else None

    def _warn_of_the_deck(self) -> None:
        """Tells what there is to note of the deck. Notes of a run that goes on are its own, and those of the deck were told."""
        for note in self.notes:
            warnings.warn(note, SphorgeNote, stacklevel=3)

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

    def _is_elsewhere(self) -> bool:
        """Whether another thread drives it now."""
        return self._thread not in (None, threading.get_ident())

    def _refuse_a_callback(self) -> None:
        if self._is_calling and not self._is_elsewhere():
            message = "a callback cannot drive the run that calls it between two steps"
            raise SphorgeError(message, hint="return sphorge.STOP to end the run")

    def _advance(self, *, step: int | None = None, frame: bool = False) -> None:
        """Goes on to a step, the next frame or the end, and calls what is due on the way."""
        self._refuse_a_callback()
        # Whoever comes while it is stopped waits for that.
        if not self._helm.acquire(blocking=self._is_asked_to_stop):
            raise RuntimeError("another thread drives this simulation: use it from one thread at a time; `stop()` asks it to end")
        self._thread = threading.get_ident()
        try:
            self._go_on(step, frame)
        except KeyboardInterrupt:
            # Wherever it came: the files are complete before anyone hears of it.
            if not self._has_ended:
                self._finish()
            raise
        finally:
            self._thread = None
            self._helm.release()

    def _go_on(self, step: int | None, frame: bool) -> None:
        if not self._has_ended:
            self._refuse_what_nobody_drives()
        while not self._has_ended:
            steps = [every.next_step for every in self._every if every.next_step is not None]
            times = [every.next_time for every in self._every if every.next_time is not None]
            if step is not None:
                steps.append(step)
            if self._loads or self._motions:
                # They are asked for each step.
                steps.append(self._step + 1)
                self._drive()
                if self._has_ended:
                    return
            self._turn += 1
            seconds = None if self._bar is None else self._bar.INTERVAL
            try:
                self._take(self._driver.go(step=min(steps, default=None), time=min(times, default=None), frame=frame, seconds=seconds))
            finally:
                self._show()
            if self._has_ended:
                return
            self._call()
            if self._has_ended or (step is not None and self._step >= step) or (frame and self._pending):
                return

    def _ask(self, call: Callback, what: str, read: Callable[[Any], Any] = lambda asked: asked) -> Any:
        """Calls a function of the program, and reads what it returns; `STOP` has ended the run then."""
        self._is_calling = True
        try:
            asked = call(self.state)
            if asked is not STOP:
                return read(asked)
            self._is_calling = False
            self._finish(f"{what} returned sphorge.STOP")
            return STOP
        except BaseException as error:
            # The files are complete before anyone hears of it.
            self._is_calling = False
            self._finish(None if isinstance(error, KeyboardInterrupt) else f"{what} raised {_told(error)}")
            if isinstance(error, (StopIteration, StopAsyncIteration)):
                # It would end the loop over the frames as if the run were over.
                raise RuntimeError(f"{what} raised {_told(error)}") from error
            raise
        finally:
            self._is_calling = False

    def _call(self) -> None:
        """Calls the callbacks that are due."""
        for every in [every for every in self._every if every.is_due(self._step, self._time)]:
            what = f"the callback `{_name(every.call)}`"
            if self._ask(every.call, what, partial(_nothing, what=what)) is STOP:
                return

    def _refuse_what_nobody_drives(self) -> None:
        """A run that a program drove goes on only with all of its functions."""
        loads = [f"the load on `{self._bodies[k]}`" for k, was in enumerate(self._were_loaded) if was and k not in self._loads]
        motions = [f"the velocity of `{self._regions[k]}`" for k, was in enumerate(self._were_moved) if was and k not in self._motions]
        if loads or motions:
            message = f"a program gave loads or velocities to this run, and this one does not give {', '.join(loads + motions)}"
            raise SphorgeError(message, hint="give them by @simulation.load and @simulation.motion before it goes on")

    def _drive(self) -> None:
        """Asks for the loads and velocities of the next step."""
        forces: list[list[float] | None] = [None] * len(self._bodies)
        velocities: list[list[float | None] | None] = [None] * len(self._regions)
        for body, call in self._loads.items():
            what = f"the load on `{self._bodies[body]}`"
            asked = self._ask(call, what, partial(self._vector, what=what, unit=_FORCES[self._dimensions - 1], may_be_free=False))
            if asked is STOP:
                return
            forces[body] = asked
        for region, call in self._motions.items():
            what = f"the velocity of `{self._regions[region]}`"
            asked = self._ask(call, what, partial(self._vector, what=what, unit="m/s", may_be_free=True))
            if asked is STOP:
                return
            velocities[region] = asked
        self._driver.drive(forces, velocities)

    def _vector(self, of: Any, *, what: str, unit: str, may_be_free: bool) -> list[Any]:
        """A vector that a program gives, with three components."""
        count, is_bytes = self._dimensions, isinstance(of, (str, bytes, bytearray, memoryview))
        of = of.tolist() if not is_bytes and callable(getattr(of, "tolist", None)) else of
        if is_bytes or not isinstance(of, Sequence) or not count <= len(of) <= 3:
            raise TypeError(f"{what} is a list of {count} numbers, in {unit}{', None where it is free' if may_be_free else ''}, not {of!r}")
        components: list[Any] = []
        for axis, value in enumerate(of):
            if value is None and may_be_free:
                components.append(None)
                continue
            try:
                number = _sphorge.quantity(value, unit) if isinstance(value, str) else float(value)
            except TypeError as error:
                raise TypeError(f"{what}, {'xyz'[axis]}: {error}") from None
            except (ValueError, OverflowError) as error:
                raise ValueError(f"{what}, {'xyz'[axis]}: {error}") from None
            if isinstance(value, bool) or not math.isfinite(number):
                raise ValueError(f"{what}, {'xyz'[axis]}: {value!r} is not a finite number")
            if axis >= count and number != 0.0:
                raise ValueError(f"{what}, {'xyz'[axis]}: the deck has {count} dimensions")
            components.append(number)
        return components + [None if may_be_free else 0.0] * (3 - len(components))

    def _show(self) -> None:
        """Shows how far it is."""
        if self._bar is not None and not self._concluded:
            self._bar.show(self.progress, f"step {self._step}, {self._time:.4g} s", is_over=self._has_ended)

    def _finish(self, by: str | None = None) -> None:
        """Ends the run where it is, which saves its state; ``by`` is what of the program ends it, if not its user."""
        self._turn += 1
        self._driver.stop(by)
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
        count: int = self._driver.particles
        return count

    def _at(self) -> tuple[int, float]:
        """Steps and time, also while another thread drives it."""
        at: tuple[int, float] = self._driver.at if self._is_elsewhere() else (self._step, self._time)
        return at

    @property
    def time(self) -> float:
        """Time reached, s."""
        return self._at()[1]

    @property
    def steps(self) -> int:
        """Steps done."""
        return self._at()[0]

    @property
    def progress(self) -> float:
        """Share done, from 0 to 1: of the end time, or of the deck's number of steps where that comes first."""
        step, time = self._at()
        shares = [time / self._end] if self._end else []
        shares += [step / self._most_steps] if self._most_steps else []
        return min(max(shares, default=1.0 if self._has_ended else 0.0), 1.0)

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
        try:
            text = self._driver.summary()
        except RunFailed:
            # Which has been raised where it failed; its summary says so, too.
            text = _sphorge.summary(self.folder)
        return None if text is None else json.loads(text)

    def _files(self) -> Run:
        """The run with its files."""
        run = Run(self.folder)
        run._given = self._given
        return run

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
        return self._files()

    def stop(self) -> Run:
        """Ends the run where it is and saves its state, as Ctrl-C does; nothing if it has ended.

        While another thread drives it, this asks the run to end after its step, and does not wait: the other thread goes on when the state is saved.
        """
        self._refuse_a_callback()
        self._is_asked_to_stop = True
        if not self._helm.acquire(blocking=False):
            self._driver.ask_to_stop()
            return self._files()
        try:
            if not self._has_ended:
                self._finish()
        finally:
            self._helm.release()
        self._conclude()
        return self._files()

    def every(self, *given: NoReturn, steps: int | None = None, time: float | str | None = None) -> Callable[[Callback], Callback]:
        """Has a function called with the `State` after every so many steps, or after the first step past every multiple of a time.

        >>> @simulation.every(time="1 us")
        ... def watch(state):
        ...     return sphorge.STOP if state["temperature"].max() > 900 else None

        It returns nothing, or `STOP`; anything else is a ``TypeError``. An exception that it raises ends the run as Ctrl-C does, and is passed on, ``StopIteration``
        as a ``RuntimeError``; ``stopped_by`` of the summary has its text.
        """
        if given or (steps is None) == (time is None):
            raise TypeError("every(): give either steps or time, by name: @simulation.every(steps=100) or @simulation.every(time=\"1 us\")")
        self._refuse_what_is_never_called("every")
        count = None if steps is None else whole(steps, "every(): steps", _MOST_STEPS)
        interval = None if time is None else _seconds(time)
        if interval is not None and not (math.isfinite(interval) and interval > 0):
            raise ValueError(f"every(): time is above zero, not {time!r}")
        if interval is not None and interval < _SHORTEST:
            raise ValueError(f"every(): time is {_SHORTEST:g} s or more, not {time!r}; steps=1 is every step")

        def add(call: Callback) -> Callback:
            _check_call(call, "every()")
            self._every.append(_Every(call, count, interval, self._step, self._time))
            return call

        return add

    def load(self, body: str) -> Callable[[Callback], Callback]:
        """Has a function called with the `State` before every step, for the force on a body in that step, N (N/m in plane strain), spread by mass.

        >>> @simulation.load("bar")
        ... def push(state):
        ...     return [0.0, -1e6 * state.time]

        It is constant within a step, and its work and impulse enter the balances of the run. A resumed run is to be given it again.
        """
        return self._driven_by("load", body, self._bodies, self._loads, "the deck has no body")

    def motion(self, region: str) -> Callable[[Callback], Callback]:
        """Has a function called with the `State` before every step, for the velocity of a region in that step, m/s, along each axis, ``None`` where it is free.

        >>> @simulation.motion("grip")
        ... def pull(state):
        ...     return [None, 10.0 if state["stress"][:, 1].max() < 3e8 else 0.0]

        The region is one that a ``[[motion]]`` of the deck names, whose velocity this takes the place of. It changes at the beginning of a step; the work it takes enters the balances.
        """
        return self._driven_by("motion", region, self._regions, self._motions, "no [[motion]] of the deck has the region")

    def _refuse_what_is_never_called(self, what: str) -> None:
        if self._has_ended:
            raise SphorgeError(f"{what}(): the simulation has ended, so that the function would never be called", hint="give it before the first step")

    def _driven_by(self, what: str, name: str, names: list[str], calls: dict[int, Callback], missing: str) -> Callable[[Callback], Callback]:
        if not self._can_be_driven:
            message = "this simulation takes no loads and velocities from a program"
            raise SphorgeError(message, hint="the engine `cpu` does, in one process, of decks whose bodies can move")
        if not isinstance(name, str):
            how = f": @simulation.{what}(\"{names[0] if names else 'name'}\")" if callable(name) else ""
            raise TypeError(f"{what}(): a name is a text, not {type(name).__name__}{how}")
        self._refuse_what_is_never_called(what)
        if name not in names:
            there = f"there are: {', '.join(names)}" if names else "there are none"
            raise SphorgeError(f"{missing} `{printable(name)}`", hint=did_you_mean(name, names) + there)

        def add(call: Callback) -> Callback:
            _check_call(call, f"{what}()")
            # Of two motions of one region the later in the deck holds.
            at = len(names) - 1 - names[::-1].index(name)
            if at in calls:
                raise SphorgeError(f"{what}(): `{name}` has one already", hint="return the sum of both from one function")
            calls[at] = call
            return call

        return add

    def _repr_html_(self) -> str:
        step, time = self._at()
        rows = {"folder": os.fspath(self._given), "step": str(step), "time": f"{time:.4g} s", "done": f"{100 * self.progress:.0f} %"}
        if self._has_ended:
            rows["status"] = "ended"
        try:
            frames = Run(self.folder).frames
            picture = frames[-1]._repr_png_() if len(frames) else None
            if picture is not None:
                rows["picture"] = f"of the last frame, {frames[-1].time:.4g} s"
        except (SphorgeError, FolderError):
            picture = None
        return _notebook.table(rows) + _notebook.image(picture)

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
            self._finish(None if error is None or isinstance(error, KeyboardInterrupt) else f"the program raised {_told(error)}")
        if error is None:
            self._conclude()

    def __repr__(self) -> str:
        where = "ended" if self._has_ended else "under way"
        step, time = self._at()
        return f"<sphorge.Simulation in {os.fspath(self._given)!r}: {where}, step {step}, {time:g} s>"


#: Flags of the code of functions whose call executes nothing, and what they are.
_DEFERRED = {0x20: "a generator function: a call of it executes nothing; leave out `yield`"}
_DEFERRED |= dict.fromkeys((0x80, 0x100, 0x200), "asynchronous: a call of it executes nothing; leave out `async`")


def _check_call(call: Any, what: str) -> None:
    """Refuses what cannot be called, or whose call executes nothing."""
    if not callable(call):
        raise TypeError(f"{what}: {repr_of(call)} cannot be called")
    within = call
    while isinstance(within, partial):
        within = within.func
    # What an object does when it is called is in its class.
    for function in (within, getattr(type(within), "__call__", None)):
        try:
            flags = getattr(getattr(function, "__func__", function), "__code__").co_flags
        except Exception:  # noqa: BLE001 (nothing that is written in Python)
            continue
        for flag, kind in _DEFERRED.items():
            if isinstance(flags, int) and flags & flag:
                raise TypeError(f"{what}: `{_name(within)}` is {kind}")


def _nothing(asked: Any, what: str) -> None:
    """What a callback returns that does not end the run."""
    if asked is None:
        return
    if isinstance(asked, Coroutine):
        # Nobody will wait for it.
        asked.close()
    raise TypeError(f"{what} returned {repr_of(asked)}: it returns nothing, or sphorge.STOP to end the run")


def _told(error: BaseException) -> str:
    """An exception in a line, whatever its text is made of, or where it has none."""
    try:
        text = printable(" ".join(str(error).split())[:500])
    except Exception:  # noqa: BLE001 (it is told by its type alone)
        text = ""
    name = printable(type(error).__name__)
    return f"{name}: {text}" if text else name


def _name(call: Any) -> str:
    """What a function is called."""
    try:
        name = getattr(call, "__name__", None)
    except Exception:  # noqa: BLE001 (a function without a name)
        name = None
    return printable(name) if isinstance(name, str) else "function"


#: How long the end of the interpreter waits for simulations that other threads drive, s.
_PATIENCE = 60.0

_open: weakref.WeakSet[Simulation] = weakref.WeakSet()
_process = os.getpid()


@atexit.register
def _close() -> None:
    """Saves the states of simulations that were left, before the process takes their threads away."""
    if os.getpid() != _process:
        return
    left = list(_open)
    # All at once: a thread that does not keep the interpreter may wait for one.
    for simulation in left:
        simulation._driver.ask_to_stop()
    until = time.monotonic() + _PATIENCE
    for simulation in left:
        while True:
            try:
                simulation._driver.stop()
            except RuntimeError:
                # Its thread still waits for it.
                if time.monotonic() < until:
                    time.sleep(0.01)
                    continue
            except Exception:  # noqa: BLE001 (there is nobody left to tell)
                pass
            break
