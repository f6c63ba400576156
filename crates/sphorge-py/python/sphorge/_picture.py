"""Pictures, drawn as ``sphorge plot`` draws them."""

from __future__ import annotations

import io
import os
import shutil
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from . import _sphorge
from ._deck import Deck
from ._errors import SphorgeError
from ._run import _needs
from ._words import there_is_no

#: Fields of which a picture shows the first that a frame has, when none is named.
FIELDS = ("plastic_strain", "von_mises_stress", "pressure", "temperature", "velocity", "damage", "integrity")


def usual_fields(run: Path) -> tuple[str, ...]:
    """The same for the run in a folder: where bodies do not move only the temperature is not zero."""
    try:
        moves = Deck(run / "deck.toml")["thermal.mechanics"]
    except (KeyError, OSError, SphorgeError):
        return FIELDS
    return FIELDS if moves else ("temperature",)


#: Options that say how something is drawn, by the option that says what.
_NEEDED = {"column": ("x", "scale", "from_start")}


class Picture:
    """A picture. A notebook shows it; ``picture.save("height.png")`` writes it to a file."""

    def __init__(self, data: bytes, ending: str) -> None:
        #: The file, a PNG, an SVG or a WebP.
        self.data = data
        self._ending = ending

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Writes it to a file, which has the ending of its format, or ``.webp``, by Pillow: of an animation less than half of the size.

        A picture that takes a while is better asked for with ``format="webp"``: whether Pillow is there is looked at before it is drawn.
        """
        to = Path(path)
        if to.suffix == ".webp" and self._ending == ".png":
            to.write_bytes(_webp(self.data))
            return to
        if to.suffix != self._ending:
            raise ValueError(f"{os.fspath(to)!r} does not end in {self._ending}, as the picture does")
        to.write_bytes(self.data)
        return to

    def _repr_png_(self) -> bytes | None:
        return self.data if self._ending == ".png" else None

    def _repr_svg_(self) -> str | None:
        return self.data.decode() if self._ending == ".svg" else None

    def _repr_html_(self) -> str | None:
        import base64

        return f"<img src='data:image/webp;base64,{base64.b64encode(self.data).decode()}'/>" if self._ending == ".webp" else None

    def __repr__(self) -> str:
        return f"<sphorge.Picture: {len(self.data)} bytes, {self._ending[1:].upper()}>"


def _webp(data: bytes) -> bytes:
    """A PNG, with all its frames, as WebP."""
    image = _needs("PIL.Image", "pillow").open(io.BytesIO(data))
    frames, spans = [], []
    for k in range(getattr(image, "n_frames", 1)):
        image.seek(k)
        frames.append(image.convert("RGB"))
        spans.append(round(image.info.get("duration", 100.0)))
    animation = {"save_all": True, "append_images": frames[1:], "duration": spans, "loop": 0} if len(frames) > 1 else {}
    out = io.BytesIO()
    frames[0].save(out, "WEBP", quality=80, method=4, **animation)
    return out.getvalue()


def _check(options: Mapping[str, Any]) -> None:
    """Refuses options that there are not."""
    known = [name.replace("-", "_") for name in _sphorge.plot_options()]
    for option in options:
        if option not in known:
            raise TypeError(there_is_no("plot() has no option", option, known))
    # What the parts of a picture need, and nothing is where a list is empty.
    given = [option for option, value in options.items() if value is not None and value is not False]
    for option in given:
        value = options[option]
        if isinstance(value, (Mapping, Sequence)) and not value:
            raise ValueError(f"plot(): `{option}` is empty")
        for needed, dependent in _NEEDED.items():
            if option in dependent and needed not in given:
                raise TypeError(f"plot(): `{option}` goes with `{needed}`, which is not given")


def _words(option: str, value: Any) -> list[str]:
    """An option as the command line has it."""
    flag = "--" + option.replace("_", "-")
    if value is None or value is False:
        return []
    if value is True:
        return [flag]
    if not isinstance(value, (Mapping, Sequence)):
        value = _number(value)
    if isinstance(value, Mapping):
        return [word for key, one in value.items() for word in (f"{flag}={key}={one}",)]
    repeated = option in ("field", "column", "body", "where", "from_start")
    if isinstance(value, Sequence) and not isinstance(value, (str, bytes)):
        return [f"{flag}={one}" for one in value] if repeated else [flag + "=" + ",".join(str(one) for one in value)]
    return [f"{flag}={value}"]


def _number(value: Any) -> Any:
    """A whole number as one, whatever its type: counts are read as such."""
    try:
        return int(value) if float(value).is_integer() and abs(float(value)) < 2**53 else value
    except (TypeError, ValueError, OverflowError):
        return value


def draw(folders: Sequence[str | os.PathLike[str]], ending: str = ".png", **options: Any) -> Picture:
    """A picture of runs; options are those of ``sphorge plot`` with ``_`` for ``-``."""
    _check(options)
    if ending == ".webp":
        _needs("PIL.Image", "pillow")
        return Picture(_webp(draw(folders, **options).data), ending)
    own = Path(tempfile.mkdtemp(prefix="sphorge-"))
    try:
        file = own / f"picture{ending}"
        words = [word for option, value in options.items() for word in _words(option, value)]
        _sphorge.draw([*words, "-o", os.fspath(file), "--", *(os.fspath(folder) for folder in folders)])
        return Picture(file.read_bytes(), ending)
    finally:
        shutil.rmtree(own, ignore_errors=True)
