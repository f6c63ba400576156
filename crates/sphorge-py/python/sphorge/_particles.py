"""Arrays as the particles of a body."""

from __future__ import annotations

import hashlib
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ._arrays import Array


def _column(values: Any, name: str, count: int | None, *, is_positive: bool = False) -> Array:
    """An array of finite numbers with the rows that it must have."""
    import numpy as np

    if values is None:
        raise TypeError(f"{name}: an array of numbers is needed")
    # What numpy would leave out of a number, or read into one, is refused.
    if isinstance(values, np.ma.MaskedArray) and np.ma.is_masked(values):
        row = int(np.argwhere(np.atleast_1d(np.ma.getmaskarray(values)))[0][0])
        raise ValueError(f"{name}: particle {row} is masked; leave its row out of all arrays")
    try:
        given = np.asarray(values)
        if given.dtype.kind not in "biufO":
            raise TypeError("they are complex" if given.dtype.kind == "c" else f"their type is {given.dtype}")
        array = np.array(given, dtype=np.float64)
    except OverflowError:
        raise ValueError(f"{name}: a number is too large") from None
    except (TypeError, ValueError) as error:
        raise TypeError(f"{name}: these are not numbers: {error}") from None
    if array.ndim == 0 and count is not None and is_positive:
        array = np.full(count, float(array))
    if count is not None and (array.ndim == 0 or len(array) != count):
        raise ValueError(f"{name}: there are {count} particles, and the array has the shape {array.shape}")
    wrong = ~np.isfinite(array)
    if wrong.any():
        row = int(np.argwhere(np.atleast_1d(wrong))[0][0])
        raise ValueError(f"{name}: the number of particle {row} is not finite")
    if is_positive:
        if array.ndim != 1:
            raise ValueError(f"{name}: one number for each particle, and the array has the shape {array.shape}")
        if (array <= 0.0).any():
            raise ValueError(f"{name}: that of particle {int(np.argmax(array <= 0.0))} is not above zero")
    return array


def particles(
    positions: Any,
    *,
    volumes: Any = None,
    masses: Any = None,
    velocities: Any = None,
    folder: str | os.PathLike[str] = "out/particles",
) -> dict[str, Any]:
    """A shape of a body that is made of particles at given places.

    >>> deck = {..., "body": [{"name": "bar", "material": "armco-iron", "shape": sphorge.particles(positions, volumes=1e-9)}]}

    Positions are (particles, dimensions), m; velocities likewise, m/s, added to that of the body. Volumes are m³, in plane strain areas, m², in one dimension lengths, m: one
    for each particle or one for all; or masses, kg, kg/m, kg/m². Without either, each particle has a cell of the spacing. They are written to a table in ``folder``,
    named by what is in it, which the deck refers to and a resumed run reads again.
    """
    import numpy as np

    places = _column(positions, "positions", None)
    if places.ndim != 2 or places.shape[1] not in (1, 2, 3):
        raise ValueError(f"positions: an array of (particles, 1 to 3) is needed, and this one has the shape {places.shape}")
    count, dimensions = places.shape
    if count == 0:
        raise ValueError("positions: there are no particles")
    unique, first = np.unique(places, axis=0, return_index=True)
    if len(unique) < count:
        twin = int(np.setdiff1d(np.arange(count), first)[0])
        raise ValueError(f"positions: particle {twin} is where another one is")
    if volumes is not None and masses is not None:
        raise ValueError("volumes and masses: one determines the other, give one")
    names, columns = list("xyz"[:dimensions]), [places]
    if velocities is not None:
        speeds = _column(velocities, "velocities", count)
        if speeds.shape != places.shape:
            raise ValueError(f"velocities: positions have the shape {places.shape}, and these {speeds.shape}")
        names += ["vx", "vy", "vz"][:dimensions]
        columns.append(speeds)
    for name, values in (("volume", volumes), ("mass", masses)):
        if values is not None:
            names.append(name)
            columns.append(_column(values, f"{name}s" if name == "volume" else "masses", count, is_positive=True)[:, None])
    table = np.concatenate(columns, axis=1)
    # The shortest text that is the same number.
    text = "\n".join([",".join(names), *(",".join(map(repr, row)) for row in table.tolist()), ""])
    place = Path(folder)
    place.mkdir(parents=True, exist_ok=True)
    file = (place / f"{hashlib.sha256(text.encode()).hexdigest()[:16]}.csv").absolute()
    if not file.exists():
        own = file.with_suffix(f".{os.getpid()}.tmp")
        own.write_text(text, encoding="ascii")
        os.replace(own, file)
    return {"table": {"file": os.fspath(file)}}
