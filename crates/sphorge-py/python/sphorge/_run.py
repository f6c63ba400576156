"""Runs on the disk: finished, stopped or under way."""

from __future__ import annotations

import json
import math
import operator
import os
import warnings
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

from . import _notebook, _sphorge
from ._arrays import array
from ._errors import FolderError, SphorgeError, SphorgeWarning
from ._words import Named, absolute, printable, there_is_no

if TYPE_CHECKING:
    from ._arrays import Array


class Frame(Mapping[str, "Array"]):
    """All particles at one time, read from the disk when it is asked for. Particles are in the order of their ids.

    >>> pressure = frame["pressure"]            # an array of its own, in the unit frame.units["pressure"]
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        #: Its file, absolute.
        self.path = absolute(path)
        self._frame = _sphorge.Frame(self.path)
        self._fields = {name: (unit, components) for name, unit, components in self._frame.fields}

    @property
    def time(self) -> float:
        """Time, s."""
        return self._frame.time

    @property
    def step(self) -> int:
        """Steps done."""
        return self._frame.step

    @property
    def dimensions(self) -> int:
        """Number of space dimensions."""
        return self._frame.dimensions

    @property
    def count(self) -> int:
        """Number of particles."""
        return self._frame.count

    @property
    def bodies(self) -> list[str]:
        """Names of the bodies: what the numbers of the field ``body`` stand for."""
        return [name for name, _ in self._frame.bodies]

    @property
    def materials(self) -> list[str]:
        """Names of their materials."""
        return [material for _, material in self._frame.bodies]

    @property
    def spacings(self) -> list[float]:
        """Particle spacing of each body, m."""
        return self._frame.spacings

    @property
    def positions(self) -> Array:
        """Positions of the particles, (particles, 3), m, in double precision."""
        return array(self._frame.positions())

    @property
    def units(self) -> dict[str, str]:
        """SI unit of each field, empty for pure numbers."""
        return {name: unit for name, (unit, _) in self._fields.items()}

    def components(self, field: str) -> list[str]:
        """Names of the components of a field: of ``stress`` they are xx, yy, zz, xy, yz, xz. Empty for a scalar."""
        return [component.lower() for component in self._known(field)[1]]

    def _known(self, field: str) -> tuple[str, list[str]]:
        try:
            return self._fields[field]
        except KeyError:
            raise KeyError(there_is_no("the frame has no field", field, self._fields, "it has")) from None

    def __getitem__(self, field: str) -> Array:
        self._known(field)
        return array(self._frame.column(field))

    def __iter__(self) -> Iterator[str]:
        return iter(self._fields)

    def __len__(self) -> int:
        return len(self._fields)

    def to_pyvista(self) -> Any:
        """The particles as ``pyvista.PolyData`` with all fields. Draw them with ``style="points_gaussian"`` or ``render_points_as_spheres=True``."""
        pyvista = _needs("pyvista")
        points = pyvista.PolyData(self.positions)
        for field in self:
            points.point_data[field] = self[field]
        return points

    def plot(self, field: str | None = None, **options: Any) -> Any:
        """A `Picture` of a field: options are those of ``sphorge plot``, such as ``section=True`` or ``view="xz"``."""
        from ._picture import usual_fields

        run, number = self._of_run("that can be drawn")
        name = field or next((name for name in usual_fields(run) if name in self._fields), None) or next(iter(self._fields))
        return _draw([run], {"field": name, "frames": number, **options})

    def fragments(self, bodies: str | Sequence[str] | None = None, link: float = 1.5, least: int = 10) -> Fragments:
        """What hangs together of the particles of all bodies, or of some, that have some integrity, up to ``link`` spacings of their body.

        >>> fragments = run.frames[-1].fragments("plate", least=20)
        >>> fragments["mass"][:2], fragments["velocity"][0], fragments.loose["plate"]
        """
        names = [bodies] if isinstance(bodies, str) else list(bodies or [])
        run, number = self._of_run("whose fragments can be found")
        found = Fragments(json.loads(_sphorge.fragments(run, number, names, float(link), operator.index(least))))
        for note in found.notes:
            warnings.warn(note, SphorgeWarning, stacklevel=2)
        return found

    def _of_run(self, what: str) -> tuple[Path, int]:
        run = self.path.parent.parent
        listed = [os.path.basename(path) for _, path in _sphorge.frames(run)]
        if self.path.name not in listed:
            raise SphorgeError(f"{self.path} is no frame of a run {what}", hint="a run that has ended has the frames that it lists")
        return run, listed.index(self.path.name)

    def _repr_png_(self) -> bytes | None:
        try:
            picture: bytes | None = self.plot(dpi=70).data
        except SphorgeError:
            return None
        return picture

    def __repr__(self) -> str:
        return f"<sphorge.Frame at {self.time:g} s, {self.count} particles>"


class Fragments(Mapping[str, "Array"]):
    """Fragments in a frame, heaviest first: ``body``, ``particles``, ``mass``, ``position``, ``velocity``, ``spin`` and ``size``, each an array with a row
    for each fragment, in SI, with ``units``. ``loose`` is the mass of each body that is part of none, ``loose_velocity`` the velocity of its centre of mass, and
    ``notes`` say what the frame does not have; they are also warnings.
    """

    def __init__(self, table: dict[str, Any]) -> None:
        import numpy as np

        #: Time of the frame, s.
        self.time: float = table["time"]
        self.loose: dict[str, float] = {of["body"]: of["mass"] for of in table["loose"]}
        self.loose_velocity: dict[str, Array] = {of["body"]: np.array(of["velocity"]) for of in table["loose"]}
        self.notes: list[str] = table["notes"]
        mass = table["mass_unit"]
        self.units: dict[str, str] = {"body": "", "particles": "", "mass": mass, "position": "m", "velocity": "m/s", "spin": "rad/s", "size": "m"}
        rows = table["fragments"]
        shapes = {"body": (str, ()), "particles": (np.int64, ()), "mass": (np.float64, ())}
        self._columns: dict[str, Array] = {}
        for name in self.units:
            kind, width = shapes.get(name, (np.float64, (3,)))
            self._columns[name] = np.array([row[name] for row in rows], dtype=kind).reshape(len(rows), *width)

    def __getitem__(self, column: str) -> Array:
        try:
            return self._columns[column]
        except KeyError:
            raise KeyError(there_is_no("fragments have no", column, self._columns, "they have")) from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    @property
    def count(self) -> int:
        """Number of fragments."""
        return len(self._columns["mass"])

    def to_pandas(self) -> Any:
        """A ``pandas.DataFrame`` with a row for each fragment; ``attrs["units"]`` has the units."""
        flat: dict[str, Any] = {}
        units: dict[str, str] = {}
        for name, values in self._columns.items():
            ends = [""] if values.ndim == 1 else ["_1", "_2", "_3"] if name == "size" else ["_x", "_y", "_z"]
            for k, end in enumerate(ends):
                flat[name + end] = values if values.ndim == 1 else values[:, k]
                units[name + end] = self.units[name]
        frame = _needs("pandas").DataFrame(flat)
        frame.attrs["units"] = units
        return frame

    def __repr__(self) -> str:
        return f"<sphorge.Fragments at {self.time:g} s: {self.count}>"


class Frames(Sequence[Frame]):
    """The frames of a run, each opened when it is asked for."""

    def __init__(self, listed: list[tuple[float, str]]) -> None:
        self._listed = listed

    @property
    def times(self) -> list[float]:
        """Times of the frames, s."""
        return [time for time, _ in self._listed]

    def nearest(self, time: float | str) -> Frame:
        """The frame nearest to a time, in s or a text such as ``"12 us"``."""
        at = _seconds(time)
        if not math.isfinite(at):
            raise ValueError(f"nearest(): a finite time is needed, not {time!r}")
        if not self._listed:
            raise IndexError("the run has no frames yet")
        return Frame(min(self._listed, key=lambda frame: abs(frame[0] - at))[1])

    @overload
    def __getitem__(self, index: int) -> Frame: ...
    @overload
    def __getitem__(self, index: slice) -> Frames: ...
    def __getitem__(self, index: int | slice) -> Frame | Frames:
        if isinstance(index, slice):
            return Frames(self._listed[index])
        try:
            return Frame(self._listed[index][1])
        except IndexError:
            there = f"from 0 to {len(self) - 1}, or from -{len(self)} to -1" if self._listed else "none yet"
            raise IndexError(f"there is no frame {index}: its frames are {there}") from None

    def __len__(self) -> int:
        return len(self._listed)

    def __repr__(self) -> str:
        return f"<sphorge.Frames: {len(self)}>"


class History(Mapping[str, "Array"]):
    """The history of a run: an array for each column, in SI, with ``units`` and ``meanings``. What limited the steps, ``dt_reason``, is texts."""

    def __init__(self, columns: list[tuple[str, str, str, bytearray, list[str] | None]]) -> None:
        self._columns = {name: array((values, "f8", 1)) if words is None else _texts(words) for name, _, _, values, words in columns}
        self.units: dict[str, str] = {name: unit for name, unit, *_ in columns}
        self.meanings: dict[str, str] = {name: meaning for name, _, meaning, *_ in columns}

    def __getitem__(self, column: str) -> Array:
        try:
            return self._columns[column]
        except KeyError:
            raise KeyError(there_is_no("the history has no column", column, self._columns, "it has")) from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def to_pandas(self) -> Any:
        """A ``pandas.DataFrame``; ``attrs["units"]`` has the units."""
        frame = _needs("pandas").DataFrame(self._columns)
        frame.attrs["units"] = dict(self.units)
        return frame

    def to_polars(self) -> Any:
        """A ``polars.DataFrame``."""
        return _needs("polars").DataFrame(self._columns)

    def __repr__(self) -> str:
        rows = len(next(iter(self._columns.values()), []))
        return f"<sphorge.History: {rows} rows of {', '.join(self._columns)}>"


def _texts(words: list[str]) -> Array:
    import numpy as np

    return np.array(words, dtype=str)


class Run:
    """The folder of a run, whoever has made it; what has not been read yet is read when it is asked for.

    >>> run = sphorge.Run("out/iron-plate")
    >>> run.measures["height"], run.frames[-1]["plastic_strain"].max()
    """

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self._given = Path(folder)
        #: Its folder, absolute.
        self.folder = absolute(folder)
        # What is no folder of a run is told at once.
        _sphorge.summary(self.folder)

    @property
    def summary(self) -> dict[str, Any] | None:
        """All of ``summary.json``; ``None`` while the run has not ended."""
        text = _sphorge.summary(self.folder)
        return None if text is None else json.loads(text)

    def _ended(self) -> dict[str, Any]:
        return self.summary or {}

    @property
    def status(self) -> str:
        """``completed``, ``completed with warnings``, ``stopped``, ``failed``, or ``unfinished``: it runs, or was killed."""
        status: str = self._ended().get("status", "unfinished")
        return status

    @property
    def measures(self) -> dict[str, float | None]:
        """Measures at the end, SI; ``measure_units`` has the units. Empty while the run has not ended: the history has them."""
        return Named("measure", self._ended().get("measures", {}))

    @property
    def measure_units(self) -> dict[str, str]:
        """SI units of the measures."""
        return Named("measure", self._ended().get("measure_units", {}))

    @property
    def warnings(self) -> list[dict[str, Any]]:
        """What checks have found broken."""
        warnings: list[dict[str, Any]] = self._ended().get("warnings", [])
        return warnings

    @property
    def driven(self) -> dict[str, list[str]] | None:
        """Bodies with ``loads`` and regions with ``motions`` that a program gave, if it did: the deck alone is then another run."""
        driven: dict[str, list[str]] | None = self._ended().get("driven")
        return driven

    @property
    def history(self) -> History:
        """The history up to now."""
        return History(_sphorge.history(self.folder))

    @property
    def frames(self) -> Frames:
        """The frames up to now."""
        return Frames([(time, os.fspath(path)) for time, path in _sphorge.frames(self.folder)])

    @property
    def deck(self) -> str:
        """Text of the deck as it was run."""
        path = self.folder / "deck.toml"
        try:
            return path.read_text(encoding="utf-8")
        except UnicodeDecodeError as error:
            raise FolderError(f"{os.fspath(path)} is damaged: byte {error.start} is part of no text", hint="run the deck again") from None
        except OSError as error:
            raise FolderError(f"{os.fspath(path)} cannot be read: {error.strerror or error}") from error

    def plot(self, field: str | Sequence[str] | None = None, **options: Any) -> Any:
        """A `Picture`: of a field in the last frame or those of ``frames``, or of columns of the history over time.

        >>> run.plot("plastic_strain", section=True, frames=["first", "last"])
        >>> run.plot(column=["height", "width"])

        Options are those of ``sphorge plot`` with ``_`` for ``-``; ``format="svg"`` draws lines that scale, ``format="webp"`` needs Pillow, and
        ``animate=True`` makes an animated PNG or WebP.
        """
        if field is None and "column" not in options:
            return self.frames[-1].plot(**options)
        return _draw([self.folder], options if field is None else {"field": field, **options})

    def _repr_html_(self) -> str:
        rows = {"folder": os.fspath(self._given), "status": self.status}
        units = self.measure_units
        rows |= {name: _notebook.quantity(value, units.get(name, "")) for name, value in self.measures.items()}
        rows |= {"driven": self._driven()} if self.driven else {}
        rows |= {"warnings": ", ".join(str(of.get("name", "")) for of in self.warnings)} if self.warnings else {}
        frames = self.frames
        return _notebook.table(rows) + _notebook.image(frames[-1]._repr_png_() if len(frames) else None)

    def to_xarray(self, fields: Sequence[str] | None = None) -> Any:
        """All frames as an ``xarray.Dataset`` over ``time`` and ``particle``, with units in ``attrs``; of some fields, if they are named."""
        import numpy as np

        xarray = _needs("xarray")
        frames = list(self.frames)
        names = list(frames[0]) if fields is None else list(fields)
        axis = np.array(["x", "y", "z"])
        stacked = np.stack([frame.positions for frame in frames])
        variables: dict[str, Any] = {"positions": (("time", "particle", "axis"), stacked, {"units": "m"})}
        coordinates: dict[str, Any] = {"time": ("time", [frame.time for frame in frames], {"units": "s"}), "axis": axis}
        for name in names:
            values = np.stack([frame[name] for frame in frames])
            components = frames[0].components(name)
            dimensions = ("time", "particle") + ((f"{name}_component",) if components else ())
            if components:
                coordinates[f"{name}_component"] = components
            variables[name] = (dimensions, values, {"units": frames[0].units[name]})
        return xarray.Dataset(variables, coordinates)

    def to_rerun(self, path: str | os.PathLike[str], field: str = "velocity") -> Path:
        """Writes all frames, coloured by a field, and the measures to a file of rerun (``pip install rerun-sdk``), which ``rerun FILE`` shows."""
        from ._rerun import write

        return write(self, path, field)

    def _driven(self) -> str:
        driven = self.driven or {}
        what = {"loads": "load on", "motions": "velocity of"}
        named = [f"{what[kind]} {', '.join(f'`{name}`' for name in names)}" for kind, names in driven.items() if names and kind in what]
        return f"by a program: {'; '.join(named)}"

    def __str__(self) -> str:
        told = _sphorge.report(self.folder)
        return f"{self!r}\n{told}".rstrip() if told else repr(self)

    def __repr__(self) -> str:
        driven = ", driven by a program" if self.driven else ""
        return f"<sphorge.Run {os.fspath(self._given)!r}: {self.status}{driven}>"


def _draw(folders: list[Path], options: dict[str, Any]) -> Any:
    from ._picture import draw

    formats = ["png", "webp"] if options.get("animate") else ["png", "svg", "webp"]
    form = options.get("format")
    if form is not None and form not in formats:
        message = there_is_no("plot(): an animation has no format" if options.get("animate") else "plot(): there is no format", form, formats)
        raise SphorgeError(message, hint="a program such as `ffmpeg` makes a video of an animated PNG")
    # The ending says it.
    return draw(folders, f".{form or 'png'}", **{name: value for name, value in options.items() if name != "format"})


def _needs(module: str, package: str | None = None) -> Any:
    import importlib

    try:
        return importlib.import_module(module)
    except ImportError as error:
        name = package or module
        raise ImportError(f"this needs the package {name}: pip install {name}") from error


def _seconds(time: float | str) -> float:
    try:
        return _sphorge.quantity(time, "s") if isinstance(time, str) else float(time)
    except OverflowError:
        raise ValueError(f"{printable(repr(time))[:40]} is too large for a time") from None
