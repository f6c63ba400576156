"""Studies: one deck with other values."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Mapping
from html import escape
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from . import _sphorge, _toml
from ._deck import Deck, _as_deck, folder_for
from ._errors import SphorgeError
from ._run import Run, _needs
from ._words import absolute, check_threads, there_is_no, whole

if TYPE_CHECKING:
    from ._arrays import Array


#: Most runs of a study.
_MOST_RUNS = 10_000


class Study:
    """The runs of a sweep. ``table`` has a list or array for each column: run, varied keys, status, warnings, measures, simulated and wall seconds, steps, particles
    and energy drift, all in SI. A measure that is called like another column has ``measure.`` before its name.
    """

    def __init__(self, folder: Path, told: dict[str, Any]) -> None:
        import numpy as np

        #: Folder that the folders of the runs are in, absolute; ``sweep.csv`` there is the same table.
        self.folder = folder
        #: Columns by name.
        self.table: dict[str, Array | list[str]] = {
            name: np.array(values) if values and isinstance(values[0], (float, int)) else values for name, values in told["columns"].items()
        }
        #: SI unit of each column that has numbers.
        self.units: dict[str, str] = told["units"]
        #: Keys that were varied.
        self.keys: list[str] = told["keys"]
        #: Names of the measures.
        self.measures: list[str] = told["measures"]
        #: What the program told of each run that it could not make.
        self.told: list[str | None] = [line and _sphorge.words(line) for line in told["told"]]
        #: What there was to note of each run before it was made, by its name: that its spacing does not fit a body, and with it the mass differs.
        self.notes: dict[str, list[str]] = {run: notes for run, notes in zip(told["columns"]["run"], told["notes"]) if notes}
        # Columns of the measures.
        self._columns: dict[str, str] = told["measure_columns"]
        self._text: str = told["text"]
        self._parquet: bytes = told["parquet"]

    @property
    def runs(self) -> list[Run]:
        """The runs in the order of the table, as far as their folders are there."""
        return [Run(self.folder / name) for name in self.table["run"] if (self.folder / name).is_dir()]

    @property
    def is_complete(self) -> bool:
        """Whether all runs have reached their end."""
        return all(status.startswith("completed") for status in self.table["status"])

    def to_pandas(self) -> Any:
        """The table as ``pandas.DataFrame``; ``attrs["units"]`` has the units."""
        frame = _needs("pandas").DataFrame(self.table)
        frame.attrs["units"] = dict(self.units)
        return frame

    def to_polars(self) -> Any:
        """The table as ``polars.DataFrame``."""
        return _needs("polars").DataFrame(self.table)

    def to_parquet(self, path: str | os.PathLike[str]) -> Path:
        """Writes the columns of ``sweep.csv`` as Parquet; units are in the metadata of the file, as text in JSON under ``units``."""
        to = Path(path)
        to.write_bytes(self._parquet)
        return to

    def _repr_html_(self) -> str:
        heads = "".join(f"<th>{escape(name)}{' / ' + escape(self.units[name]) if self.units.get(name) else ''}</th>" for name in self.table)

        def cell(value: Any) -> str:
            return f"{value:.5g}" if isinstance(value, float) else escape(str(value))

        lines = "".join("<tr>" + "".join(f"<td>{cell(value)}</td>" for value in line) + "</tr>" for line in zip(*self.table.values()))
        return f"<table><tr>{heads}</tr>{lines}</table>"

    def __len__(self) -> int:
        return len(self.table["run"])

    def __repr__(self) -> str:
        first: dict[str, str] = {}
        for run, notes in self.notes.items():
            for note in notes:
                first[note] = f"{first[note]}, {run}" if note in first else run
        return "\n".join([self._text.rstrip("\n"), *(f"note: {runs}: {note}" for note, runs in first.items())])


class MeasureConvergence(NamedTuple):
    """A measure over spacings. ``order`` and ``limit`` are ``None`` where ``why_not`` says why."""

    unit: str
    values: Array
    order: float | None
    limit: float | None
    why_not: str | None


class Convergence(Study):
    """Runs at several spacings, coarse to fine, with the order and limit of each measure: ``convergence["height"].limit``."""

    def __init__(self, folder: Path, told: dict[str, Any]) -> None:
        import numpy as np

        super().__init__(folder, told)
        self._measures = {
            name: MeasureConvergence(**{**of, "values": np.array(of["values"])}) for name, of in told["convergence"].items()
        }

    def __getitem__(self, measure: str) -> MeasureConvergence:
        try:
            return self._measures[measure]
        except KeyError:
            raise KeyError(there_is_no("there is no measure", measure, self._measures)) from None


class Bracket(NamedTuple):
    """The fastest impact velocity that was stopped and the slowest that got through, m/s."""

    stopped: float
    through: float


class RechtIpson(NamedTuple):
    """The curve ``v_r = a (v_i^p - limit^p)^(1/p)`` through what got through: ``off_by`` is the root of the mean square of the ``runs``, m/s."""

    a: float
    p: float
    limit: float
    off_by: float
    runs: int

    def residual(self, speed: float) -> float:
        """Residual velocity at an impact velocity, m/s."""
        if speed <= self.limit:
            return 0.0
        share: float = (1.0 - (self.limit / speed) ** self.p) ** (1.0 / self.p)
        return self.a * speed * share


class BallisticLimit(Study):
    """Runs at several impact speeds, slow to fast; ``table`` has ``impact_velocity``, ``residual_velocity`` and ``outcome``, too.

    An outcome is ``"through"``, ``"stopped"``, ``"open"`` of a run that does not tell, or ``"failed"``.
    """

    def __init__(self, folder: Path, told: dict[str, Any]) -> None:
        import numpy as np

        super().__init__(folder, told)
        of = told["ballistic"]
        first: dict[str, Array | list[str]] = {name: np.array(of[name]) for name in ("impact_velocity", "residual_velocity")}
        self.table = {**first, "outcome": of["outcome"], **self.table}
        self.units |= {"impact_velocity": "m/s", "residual_velocity": "m/s"}
        #: The fastest that was stopped and the slowest that got through, or None.
        self.bracket: Bracket | None = of["bracket"] and Bracket(*of["bracket"])
        #: The curve, or None: ``why_no_curve`` says why.
        self.curve: RechtIpson | None = of["curve"] and RechtIpson(*of["curve"])
        self.why_no_curve: str | None = of["why_no_curve"]
        #: Whether the bracket is as narrow as was asked for.
        self.is_found: bool = of["is_found"]
        #: What there is to say of the search and of single runs.
        self.remarks: list[str] = of["remarks"]
        self._pictures: dict[str, bytes | None] = {name: of[name] for name in ("png", "svg")}

    @property
    def limit(self) -> float | None:
        """Middle of the bracket, m/s."""
        return None if self.bracket is None else 0.5 * (self.bracket.stopped + self.bracket.through)

    def plot(self, format: str = "png") -> Any:
        """A `Picture` of residual over impact velocity with the curve and the bracket."""
        from ._picture import Picture

        if format not in self._pictures:
            raise ValueError(there_is_no("there is no format", format, self._pictures))
        data = self._pictures[format]
        if data is None:
            raise SphorgeError("no run has a residual velocity to draw")
        return Picture(data, f".{format}")


def _values(key: Any, values: Any) -> tuple[str, list[str]]:
    if not isinstance(key, str):
        raise TypeError(f"keys of a deck are texts, not {type(key).__name__}")
    if isinstance(values, (str, bytes, Mapping)) or not isinstance(values, Iterable):
        raise TypeError(f"the values of `{key}` are a list, not {type(values).__name__}")
    # Before any of them is read: there may be no end of them.
    listed = list(islice(values, _MOST_RUNS + 1))
    if len(listed) > _MOST_RUNS:
        raise ValueError(f"`{key}` has more than {_MOST_RUNS} values, which are more runs than a study has")
    return key, [_toml.override(_toml._plain(value), key) for value in listed]


def _making(workers: int, threads: int | None) -> dict[str, Any]:
    return {"jobs": whole(workers, "workers", 4096), "threads": check_threads(threads)}


def _program() -> list[str]:
    """The command that is the program ``sphorge``."""
    if not sys.executable:
        raise SphorgeError("this Python does not know its own executable, which the runs of a study are started by")
    return [sys.executable, "-m", "sphorge"]


def sweep(
    deck: Deck | str | os.PathLike[str] | Mapping[str, Any],
    varied: Mapping[str, Iterable[Any]],
    out: str | os.PathLike[str] | None = None,
    *,
    workers: int = 1,
    threads: int | None = None,
    engine: str = "cpu",
    device: str | None = None,
    overwrite: bool = False,
) -> Study:
    """Runs a deck with every combination of values, each in a process and a folder of its own, ``workers`` at once; what is there is not run again.

    >>> study = sphorge.sweep("iron-plate", {"body.bar.velocity.1": ["-150 m/s", "-200 m/s"]}, workers=2)
    >>> study.table["height"]
    """
    deck = _as_deck(deck)
    if not isinstance(varied, Mapping):
        raise TypeError(f"what is varied is a dict of keys and their values, not {type(varied).__name__}")
    folder = absolute(folder_for(deck, "-sweep", out))
    values = [_values(key, of) for key, of in varied.items()]
    making = _making(workers, threads)
    told = _sphorge.sweep(deck._deck, values, folder, _program(), **making, engine=engine, device=device, overwrite=overwrite)
    return Study(folder, told)


def convergence(
    deck: Deck | str | os.PathLike[str] | Mapping[str, Any],
    spacings: Iterable[Any],
    out: str | os.PathLike[str] | None = None,
    *,
    workers: int = 1,
    threads: int | None = None,
    engine: str = "cpu",
    device: str | None = None,
    overwrite: bool = False,
) -> Convergence:
    """Runs a deck at several spacings: observed order and Richardson's limit of every measure.

    >>> sphorge.convergence("iron-plate", ["1.2 mm", "0.6 mm", "0.3 mm"])["height"].limit
    """
    deck = _as_deck(deck)
    folder = absolute(folder_for(deck, "-convergence", out))
    _, values = _values("particles.spacing", spacings)
    making = _making(workers, threads)
    told = _sphorge.convergence(deck._deck, values, folder, _program(), **making, engine=engine, device=device, overwrite=overwrite)
    return Convergence(folder, told)


def ballistic_limit(
    deck: Deck | str | os.PathLike[str] | Mapping[str, Any],
    between: tuple[Any, Any] | None = None,
    out: str | os.PathLike[str] | None = None,
    *,
    body: str | Iterable[str] = (),
    residual: str | None = None,
    within: Any = None,
    at: Iterable[Any] = (),
    runs: int = 20,
    exponent: float | None = None,
    through: Any = None,
    workers: int = 1,
    threads: int | None = None,
    engine: str = "cpu",
    device: str | None = None,
    overwrite: bool = False,
) -> BallisticLimit:
    """Runs a deck at several impact speeds until the fastest that is stopped and the slowest that gets through are ``within`` of each other.

    >>> limit = sphorge.ballistic_limit("perforation", ("200 m/s", "303.5 m/s"), within="20 m/s")
    >>> limit.limit, limit.bracket, limit.curve
    """
    deck = _as_deck(deck)
    folder = absolute(folder_for(deck, "-ballistic-limit", out))
    ends = (None, None) if between is None else between
    if isinstance(ends, (str, bytes)) or not isinstance(ends, Iterable):
        raise TypeError(f"between: two speeds are needed, not {type(ends).__name__}")
    low, high, *more = [*islice(ends, 3), None, None]
    if len(more) != 2:
        raise ValueError("between: two speeds are needed, either of which can be None")
    if isinstance(at, (str, bytes, Mapping)) or not isinstance(at, Iterable):
        raise TypeError(f"at: a list of speeds is needed, not {type(at).__name__}")
    bodies = [body] if isinstance(body, str) else list(body)
    if not all(isinstance(name, str) for name in bodies):
        raise TypeError("body: a name or a list of names is needed")
    if residual is not None and not isinstance(residual, str):
        raise TypeError(f"residual: the name of a measure is needed, not {type(residual).__name__}")
    told = _sphorge.ballistic_limit(
        deck._deck,
        bodies,
        residual,
        (_speed(low, "between"), _speed(high, "between")),
        _speed(within, "within"),
        [text for speed in islice(at, 1001) if (text := _speed(speed, "at")) is not None],
        whole(runs, "runs", 1000),
        None if exponent is None else float(exponent),
        _speed(through, "through"),
        folder,
        _program(),
        **_making(workers, threads),
        engine=engine,
        device=device,
        overwrite=overwrite,
    )
    return BallisticLimit(folder, told)


def _speed(value: Any, name: str) -> str | None:
    """A speed as text, in m/s where it is a number."""
    if value is None or isinstance(value, str):
        return value
    try:
        return repr(float(value))
    except (TypeError, ValueError):
        raise TypeError(f"{name}: a speed is a number or a text such as \"150 m/s\", not {type(value).__name__}") from None
