"""Finding values of a deck with which its runs measure what experiments did."""

from __future__ import annotations

import math
import os
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from . import _sphorge, _toml
from ._deck import Deck, _as_deck, folder_for
from ._errors import SphorgeError, SphorgeWarning
from ._run import _needs
from ._studies import Study, _making, _program
from ._words import absolute, repr_of, whole

if TYPE_CHECKING:
    from ._arrays import Array

#: Digits that a value of a run is written with: enough for any fit, and the same text, thus the same run, when a fit is made once more.
DIGITS = 7


@dataclass
class Experiment:
    """What was measured in an experiment, and how the deck becomes its model.

    >>> sphorge.Experiment({"height": "22.2 mm"}, set={"body.bar.velocity.1": "-150 m/s"})

    ``measured`` has a value for each measure of the deck that is to be met, or a value and its uncertainty, ``("22.2 mm", "0.1 mm")``; without,
    a hundredth of the value is taken. ``set`` are keys of the deck and their values in this experiment; ``deck`` is one of its own in place of the common one.
    """

    measured: Mapping[str, Any]
    set: Mapping[str, Any] = field(default_factory=dict)
    deck: Deck | str | os.PathLike[str] | Mapping[str, Any] | None = None
    name: str | None = None


class Search(Protocol):
    """What looks for values: it asks for points, and is told how far they are off.

    A point has a number from 0 to 1 for each parameter, its place between the bounds. What it is told is an array of all deviations, each over its uncertainty, or
    ``None`` where a run of the point did not reach its end, or a measure has no value at it. ``ask`` gives no points when the search is over.
    """

    def ask(self) -> list[list[float]]: ...

    def tell(self, points: list[list[float]], deviations: list[Array | None]) -> None: ...


class _NothingMeasured(SphorgeError):
    """Points that a search cannot do without have no deviations; ``points`` are their places in what was asked for."""

    points: list[int]


class GaussNewton:
    """Least squares by the method of Levenberg and Marquardt, with slopes from differences, kept up to date by Broyden's formula.

    K. Levenberg, Quarterly of Applied Mathematics 2 (1944) 164; D. W. Marquardt, SIAM Journal 11 (1963) 431; C. G. Broyden, Mathematics of Computation 19 (1965) 577.
    For a few parameters and measures that depend smoothly on them it needs some ten points.
    """

    def __init__(self, start: Sequence[float], *, tolerance: float = 1e-4, step: float = 0.05) -> None:
        import numpy as np

        #: Best point so far, its deviations and its slopes.
        self.best = np.array(start, dtype=float)
        self.deviations: Array | None = None
        self.slopes: Array | None = None
        #: Why the search is over, if it is.
        self.reason: str | None = None
        self._tolerance = tolerance
        self._step = step
        self._damping = 1e-3
        self._is_fresh = False
        self._pending: tuple[str, list[Any]] = ("start", [])

    def _around(self) -> list[Any]:
        """A point beside the best one for each parameter, towards the middle."""
        points = []
        for k, at in enumerate(self.best):
            point = self.best.copy()
            point[k] = at + (self._step if at < 0.5 else -self._step)
            points.append(point)
        return points

    def _next(self) -> Any | None:
        """Where the slopes point to, within the bounds; nothing if that is where the search is."""
        import numpy as np

        assert self.slopes is not None and self.deviations is not None
        slopes, free = self.slopes, np.ones(len(self.best), dtype=bool)
        step = np.zeros(len(self.best))
        # What would leave the bounds stays at them, and the others are chosen anew.
        for _ in range(len(self.best)):
            own = slopes[:, free]
            if not own.size:
                break
            square = own.T @ own
            scale = np.maximum(np.diag(square), 1e-12 * max(float(np.diag(square).max()), 1e-300))
            step[:] = 0.0
            step[free] = -np.linalg.solve(square + self._damping * np.diag(scale), own.T @ self.deviations)
            reached = self.best + step
            out = free & (((reached < 0.0) & (self.best <= 0.0)) | ((reached > 1.0) & (self.best >= 1.0)))
            if not out.any():
                break
            free &= ~out
            step[out] = 0.0
        point = np.clip(self.best + step, 0.0, 1.0)
        return None if np.abs(point - self.best).max() < self._tolerance else point

    def ask(self) -> list[list[float]]:
        if self.reason is not None:
            return []
        if self.deviations is None:
            # The best point and those around it at once: they do not wait for each other.
            self._pending = ("start", [self.best, *self._around()])
        elif self.slopes is None:
            self._pending = ("slopes", self._around())
        else:
            point = self._next()
            if point is None:
                if self._is_fresh:
                    self.reason = "no step is left that is larger than the tolerance"
                    return []
                self._step = max(0.3 * self._step, 5.0 * self._tolerance)
                self._pending = ("slopes", self._around())
            else:
                self._pending = ("step", [point])
        return [point.tolist() for point in self._pending[1]]

    def tell(self, points: list[list[float]], deviations: list[Array | None]) -> None:
        import numpy as np

        kind, _ = self._pending
        if kind == "start":
            if deviations[0] is None:
                raise _NothingMeasured("nothing could be measured at the values to start from", hint="choose others, or look at the runs", points=[0])
            self.deviations = deviations[0]
            points, deviations = points[1:], deviations[1:]
        assert self.deviations is not None
        if kind != "step":
            columns = []
            for k, (point, told) in enumerate(zip(points, deviations)):
                if told is None:
                    at = k + 1 if kind == "start" else k
                    raise _NothingMeasured("nothing could be measured beside the best values", hint="choose narrower bounds, or look at the runs", points=[at])
                columns.append((told - self.deviations) / (point[k] - self.best[k]))
            self.slopes = np.stack(columns, axis=1)
            self._is_fresh = True
            # One of them may be better itself.
            for point, told in zip(points, deviations):
                if told is not None and told @ told < self.deviations @ self.deviations:
                    self.best, self.deviations = np.array(point), told
            return
        told, reached = deviations[0], np.array(points[0])
        if told is None or told @ told >= self.deviations @ self.deviations:
            if self._is_fresh:
                self._damping = max(10.0 * self._damping, 1e-2)
                if self._damping > 1e6:
                    self.reason = "no step makes the deviations smaller"
            else:
                self._step = max(0.3 * self._step, 5.0 * self._tolerance)
                self.slopes = None
            return
        moved = reached - self.best
        assert self.slopes is not None
        self.slopes = self.slopes + np.outer(told - self.deviations - self.slopes @ moved, moved) / (moved @ moved)
        self.best, self.deviations = reached, told
        self._damping = max(0.1 * self._damping, 1e-9)
        self._is_fresh = False


class Optuna:
    """Sampling by optuna (``pip install optuna``): for measures that jump, or many parameters; it needs some hundred points.

    ``seed`` and ``together`` fix what it asks for, so that a calibration that was stopped finds its runs.
    """

    def __init__(self, count: int, *, points: int = 100, together: int = 1, seed: int = 0) -> None:
        optuna = _needs("optuna")
        optuna.logging.set_verbosity(optuna.logging.WARNING)
        self._study = optuna.create_study(sampler=optuna.samplers.TPESampler(seed=seed))
        self._count, self._left, self._together = count, points, together
        self._trials: list[Any] = []
        self._failed = optuna.trial.TrialState.FAIL
        self.reason: str | None = None

    def ask(self) -> list[list[float]]:
        number = min(self._left, self._together)
        self._left -= number
        if number == 0:
            self.reason = "all points were tried"
        self._trials = [self._study.ask() for _ in range(number)]
        return [[trial.suggest_float(str(k), 0.0, 1.0) for k in range(self._count)] for trial in self._trials]

    def tell(self, points: list[list[float]], deviations: list[Array | None]) -> None:
        for trial, told in zip(self._trials, deviations):
            if told is None:
                self._study.tell(trial, state=self._failed)
            else:
                self._study.tell(trial, float(told @ told))


class Calibration:
    """The values that were found."""

    def __init__(self, keys: list[str], units: list[str]) -> None:
        #: Value of each key, SI.
        self.values: dict[str, float] = {}
        #: SI unit of each.
        self.units = dict(zip(keys, units))
        #: How far each value may move until a deviation grows by its uncertainty, as far as the slopes tell; ``inf`` where nothing depends on it.
        self.errors: dict[str, float] = {}
        #: Root of the mean square of the deviations, each over its uncertainty: below one all is met.
        self.misfit = math.inf
        #: For each experiment and measure what was measured and what the best runs give, SI.
        self.fitted: dict[str, dict[str, tuple[float, float]]] = {}
        #: SI unit of each measure.
        self.measure_units: dict[str, str] = {}
        #: Why the search ended, and whether it was not for want of runs.
        self.reason = ""
        self.has_converged = False
        #: What checks have found broken in runs that reached their end, by the name of the check: the folders of these runs.
        self.warnings: dict[str, list[str]] = {}
        #: Every point that was tried: values of the keys, and the misfit, NaN where one of the measures has no value.
        self.trials: list[dict[str, float]] = []
        #: All runs of each experiment.
        self.studies: dict[str, Study] = {}
        self.folder = Path()

    def to_pandas(self) -> Any:
        """The points that were tried as ``pandas.DataFrame``."""
        frame = _needs("pandas").DataFrame(self.trials)
        frame.attrs["units"] = dict(self.units)
        return frame

    def __repr__(self) -> str:
        lines = [f"{len(self.trials)} points, misfit {self.misfit:.3g} ({self.reason})"]
        for key, value in self.values.items():
            error = self.errors.get(key)
            known = "" if error is None else " (nothing depends on it, or another value makes up for it)" if math.isinf(error) else f" ± {error:.2g}"
            lines.append(f"  {key} = {value:.6g}{known} {self.units[key]}".rstrip())
        for name, measures in self.fitted.items():
            for measure, (asked, got) in measures.items():
                unit = f" {self.measure_units[measure]}" if self.measure_units.get(measure) else ""
                lines.append(f"  {name}: {measure} {got:.5g}{unit}, measured {asked:.5g}{unit}")
        lines += [f"  warning {_warned(check, runs)}" for check, runs in self.warnings.items()]
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        from html import escape

        return f"<pre>{escape(repr(self))}</pre>"


def _warned(check: str, runs: list[str]) -> str:
    """What runs a check has found broken, in a line."""
    some = ", ".join(runs[:3]) + (f" and {len(runs) - 3} more" if len(runs) > 3 else "")
    return f"{check}: in {len(runs)} of the runs: {some}"


@dataclass
class _Target:
    measure: str
    value: float
    uncertainty: float


@dataclass
class _Bench:
    """An experiment that is ready to be run."""

    name: str
    deck: Deck
    folder: Path
    targets: list[_Target]


def _number(of: Any, unit: str, what: str, read: Callable[[str, str], float] = _sphorge.quantity) -> float:
    try:
        number = read(of, unit) if isinstance(of, str) else float(of)
    except TypeError as error:
        raise TypeError(f"{what}: {error}") from None
    except (ValueError, OverflowError) as error:
        raise ValueError(f"{what}: {error}") from None
    if not math.isfinite(number):
        raise ValueError(f"{what}: {of!r} is not a finite number")
    return number


def _targets(experiment: Experiment, checked: dict[str, Any], name: str) -> list[_Target]:
    if not isinstance(experiment.measured, Mapping) or not experiment.measured:
        raise TypeError(f"{name}: what was measured is a dict of measures and their values, {'and this one is empty' if experiment.measured == {} else 'not ' + type(experiment.measured).__name__}")
    targets = []
    for measure, of in experiment.measured.items():
        units: dict[str, str] = checked["measure_units"]
        if measure not in units:
            raise SphorgeError(f"{name}: the deck has no measure `{measure}`", hint=f"it has: {', '.join(units) or 'none'}")
        what = f"{name}: `{measure}`"
        value, error = of if isinstance(of, tuple) and len(of) == 2 else (of, None)
        number = _number(value, units[measure], what)
        uncertainty = 0.01 * abs(number) if error is None else _number(error, units[measure], what, _sphorge.difference)
        if not uncertainty > 0.0:
            raise ValueError(f"{what}: give an uncertainty above zero: (value, uncertainty)")
        targets.append(_Target(measure, number, uncertainty))
    return targets


def _bounds(params: Mapping[str, Any]) -> tuple[list[str], list[str], list[tuple[float, float]], list[float]]:
    """Keys, units, bounds and starting points (from 0 to 1)."""
    if not isinstance(params, Mapping) or not params:
        empty = " and this one is empty:" if isinstance(params, Mapping) else f" not {type(params).__name__}:"
        raise TypeError(f"params: what is looked for is a dict of keys and their bounds,{empty} give {{\"material.iron.strength.johnson-cook.A\": (\"100 MPa\", \"400 MPa\")}}")
    keys, units, bounds, start = [], [], [], []
    for key, of in params.items():
        if not isinstance(key, str):
            raise TypeError(f"keys of a deck are texts, not {type(key).__name__}")
        if isinstance(of, (str, bytes)) or not isinstance(of, Sequence) or len(of) not in (2, 3):
            raise TypeError(f"`{key}`: give its bounds, (low, high), or where to start, too: (low, start, high)")
        read = [_sphorge.quantity_of_key(key, _toml.override(_toml._plain(value), key)) for value in of]
        numbers = [number for number in read if number is not None]
        if len(numbers) < len(of) or any(not math.isfinite(value) for value, _ in numbers):
            raise ValueError(f"`{key}`: its bounds are not all quantities: {of!r}")
        kinds = {unit for value, unit in numbers if unit}
        if len(kinds) > 1:
            raise ValueError(f"`{key}`: its bounds have different units: {of!r}")
        low, high = numbers[0][0], numbers[-1][0]
        middle = numbers[1][0] if len(numbers) == 3 else 0.5 * (low + high)
        if not low < high or not low <= middle <= high:
            raise ValueError(f"`{key}`: bounds come in order: {of!r}")
        keys.append(key)
        units.append(next(iter(kinds), ""))
        bounds.append((low, high))
        start.append((middle - low) / (high - low))
    return keys, units, bounds, start


def _written(point: Sequence[float], bounds: list[tuple[float, float]]) -> list[str]:
    return [f"{low + (high - low) * min(max(at, 0.0), 1.0):.{DIGITS}g}" for at, (low, high) in zip(point, bounds)]


def calibrate(
    deck: Deck | str | os.PathLike[str] | Mapping[str, Any],
    params: Mapping[str, Any],
    targets: Mapping[str, Any] | Experiment | Sequence[Experiment],
    out: str | os.PathLike[str] | None = None,
    *,
    search: Search | None = None,
    most_points: int = 60,
    workers: int = 1,
    threads: int | None = None,
    engine: str = "cpu",
    device: str | None = None,
) -> Calibration:
    """Finds values of keys with which the measures of a deck are those of experiments.

    >>> sphorge.calibrate(
    ...     "bar.toml",
    ...     {"material.iron.strength.johnson-cook.A": ("100 MPa", "400 MPa")},
    ...     [sphorge.Experiment({"height": "20.4 mm"}, set={"body.bar.velocity.1": "-200 m/s"})],
    ... )

    Runs are those of a sweep: each a process with a folder of its own in a folder for each experiment, ``workers`` at once. The same call, once more or after Ctrl-C,
    asks for the same points and finds the runs that are there. ``search`` is what chooses points, `GaussNewton` unless another is given.
    """
    deck = _as_deck(deck)
    keys, units, bounds, start = _bounds(params)
    listed: list[Any] = list(targets) if isinstance(targets, Iterable) and not isinstance(targets, Mapping) else [targets]
    if isinstance(targets, Mapping):
        listed = [Experiment(targets)] if targets else []
    given: list[Experiment] = [one for one in listed if isinstance(one, Experiment)]
    odd = [one for one in listed if not isinstance(one, Experiment)]
    if odd or not given:
        what = f"these have {repr_of(odd[0])}" if odd else "these are empty"
        raise TypeError(f"targets are a dict of measures, or experiments, and {what}: give [sphorge.Experiment({{\"height\": \"20.4 mm\"}}, set={{...}}), ...]")
    making = _making(workers, threads)
    most_points = whole(most_points, "most_points", 10_000)
    folder = absolute(folder_for(deck, "-calibration", out))
    first = _written(start, bounds)
    benches: list[_Bench] = []
    for number, experiment in enumerate(given, 1):
        name = experiment.name or f"experiment-{number}"
        if any(bench.name == name for bench in benches) or name == ".." or Path(name).name != name:
            raise ValueError(f"the name {name!r} is not one of an experiment alone")
        own = (deck if experiment.deck is None else _as_deck(experiment.deck)).copy()
        if not isinstance(experiment.set, Mapping):
            raise TypeError(f"{name}: set is a dict of keys and their values, not {type(experiment.set).__name__}")
        for key, value in experiment.set.items():
            own[key] = value
        # All that can be wrong with it is told before the first run.
        own._deck.refuse_overlapping(keys)
        tried = own.copy()
        for key, text in zip(keys, first):
            tried[key] = text
        benches.append(_Bench(name, own, folder / name, _targets(experiment, tried.check(), name)))
    looking: Any = GaussNewton(start) if search is None else search
    found = Calibration(keys, units)
    found.folder = folder
    points: list[list[str]] = []
    told: dict[tuple[str, ...], Array | None] = {}
    while True:
        asked = looking.ask()
        if not asked:
            found.reason = getattr(looking, "reason", None) or "the search is over"
            found.has_converged = True
            break
        if any(len(point) != len(keys) for point in asked):
            raise ValueError(f"the search asks for points of other than {len(keys)} numbers")
        texts = [_written(point, bounds) for point in asked]
        new = [text for k, text in enumerate(texts) if tuple(text) not in told and text not in texts[:k]]
        if len(points) + len(new) > most_points:
            if not points:
                message = f"the search begins with {len(new)} points, and most_points is {most_points}: nothing was run"
                raise SphorgeError(message, hint=f"give most_points of {len(new)} or more; some ten are needed for two parameters")
            found.reason = f"{most_points} points were not enough"
            break
        if new:
            points += new
            options = dict(**making, engine=engine, device=device, overwrite=False)
            for bench in benches:
                made = _sphorge.points(bench.deck._deck, keys, points, bench.folder, _program(), **options)
                found.studies[bench.name] = Study(bench.folder, made)
            for k in range(len(points) - len(new), len(points)):
                told[tuple(points[k])] = _deviations(benches, found.studies, k)
                _note(found, keys, points[k], told[tuple(points[k])])
        # What was run is told, not what was asked for.
        as_run = [[(float(x) - low) / (high - low) for x, (low, high) in zip(text, bounds)] for text in texts]
        try:
            looking.tell(as_run, [told[tuple(text)] for text in texts])
        except _NothingMeasured as error:
            row = points.index(texts[error.points[0]])
            raise SphorgeError(f"{error.args[0].splitlines()[0]}: {_why_not(benches, found.studies, row)}", hint=error.hint) from None
    _conclude(found, benches, points, told, looking, bounds)
    return found


def _warn(found: Calibration, benches: list[_Bench]) -> None:
    """Tells which runs have reached their end broken, once for each check."""
    for bench in benches:
        table = found.studies[bench.name].table
        for run, status, checks in zip(table["run"], table["status"], table["warnings"]):
            for check in str(checks).split() if status == "completed with warnings" else ():
                found.warnings.setdefault(check, []).append(os.fspath(bench.folder / str(run)))
    for check, runs in found.warnings.items():
        warnings.warn(f"the values that were found rest on runs that are broken: {_warned(check, runs)}", SphorgeWarning, stacklevel=4)


def _deviations(benches: list[_Bench], studies: dict[str, Study], row: int) -> Array | None:
    """All deviations over their uncertainties at a point."""
    import numpy as np

    off = [(_measured(studies[bench.name], of.measure, row) - of.value) / of.uncertainty for bench in benches for of in bench.targets]
    return np.array(off) if all(math.isfinite(x) for x in off) else None


def _measured(study: Study, measure: str, row: int) -> float:
    """What a run has measured, NaN where it has not. A study none of whose runs has begun has no measures."""
    return float(study.table[study._columns[measure]][row]) if measure in study._columns else math.nan


def _why_not(benches: list[_Bench], studies: dict[str, Study], row: int) -> str:
    """Why a point has no deviations."""
    for bench in benches:
        study = studies[bench.name]
        run, status = f"the run {os.fspath(bench.folder / str(study.table['run'][row]))}", str(study.table["status"][row])
        if not status.startswith("completed"):
            told = next((line.strip() for line in (study.told[row] or "").splitlines() if line.strip()), "")
            return f"{run} is {status}{': ' + told if told else ''}"
        for of in bench.targets:
            if not math.isfinite(_measured(study, of.measure, row)):
                return f"{run} reached its end, and its measure `{of.measure}` has no value there"
    return "a measure is too far from what was measured to be computed with"


def _misfit(deviations: Array | None) -> float:
    return math.nan if deviations is None else math.sqrt(float(deviations @ deviations) / len(deviations))


def _note(found: Calibration, keys: list[str], texts: list[str], deviations: Array | None) -> None:
    found.trials.append({**{key: float(text) for key, text in zip(keys, texts)}, "misfit": _misfit(deviations)})


def _conclude(
    found: Calibration,
    benches: list[_Bench],
    points: list[list[str]],
    told: dict[tuple[str, ...], Array | None],
    looking: Any,
    bounds: list[tuple[float, float]],
) -> None:
    import numpy as np

    known = [(_misfit(told[tuple(text)]), k) for k, text in enumerate(points) if told.get(tuple(text)) is not None]
    if not known:
        why = _why_not(benches, found.studies, 0) if points else "no point was asked for"
        raise SphorgeError(f"nothing could be measured at any point of the calibration: {why}", hint="choose other bounds, or look at the runs")
    found.misfit, best = min(known)
    found.values = {key: float(text) for key, text in zip(found.units, points[best])}
    _warn(found, benches)
    for bench in benches:
        study = found.studies[bench.name]
        found.measure_units |= {of.measure: study.units.get(study._columns[of.measure], "") for of in bench.targets}
        found.fitted[bench.name] = {of.measure: (of.value, _measured(study, of.measure, best)) for of in bench.targets}
    slopes = getattr(looking, "slopes", None)
    if slopes is not None:
        _, sizes, directions = np.linalg.svd(slopes, full_matrices=True)
        sizes = np.concatenate([sizes, np.zeros(len(directions) - len(sizes))])
        is_seen = sizes > 1e-6 * max(float(sizes.max()), 1e-300)
        # What moves along a direction that no measure sees can be anything.
        unseen = (directions[~is_seen] ** 2).sum(axis=0)
        squares = ((directions[is_seen] / sizes[is_seen, None]) ** 2).sum(axis=0)
        for k, (key, (low, high)) in enumerate(zip(found.units, bounds)):
            found.errors[key] = math.inf if unseen[k] > 1e-9 else float(math.sqrt(squares[k]) * (high - low))
    at_bound = [
        key for (key, value), (low, high) in zip(found.values.items(), bounds)
        if min(value - low, high - value) <= 1e-6 * (high - low)
    ]
    if at_bound:
        found.reason += f"; at its bound: {', '.join(at_bound)}"
