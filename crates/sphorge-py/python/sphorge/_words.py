"""Words and numbers that a program gives, and how they are told."""

from __future__ import annotations

import operator
import os
import reprlib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, Generic, TypeVar

from . import _sphorge
from ._errors import FolderError

Value = TypeVar("Value")


def printable(text: str) -> str:
    """A text as a terminal and a file can show it: escaped where it is no text, as names of files may be."""
    return "".join(c if c.isprintable() else repr(c)[1:-1] for c in text)


def repr_of(value: Any) -> str:
    """A value as a message shows it: in short, whatever it is."""
    return printable(reprlib.repr(value))


def told(text: str, what: str) -> str:
    """A text that can be written to a file, or why it cannot."""
    try:
        text.encode()
    except UnicodeEncodeError as error:
        raise ValueError(f"{what}: character {error.start} of {ascii(text[:60])} is half of a pair of surrogates, which no text has") from None
    return text


def did_you_mean(name: object, names: Iterable[str]) -> str:
    """``did you mean ...? ``, if there is a name that may be meant."""
    return _sphorge.did_you_mean(printable(name), list(names)) if isinstance(name, str) else ""


def there_is_no(what: str, name: object, names: Iterable[str], has: str = "there are") -> str:
    """That a name is none of these, which may be meant, and what there is."""
    known = list(names)
    return f"{what} `{printable(str(name))}`; {did_you_mean(name, known)}{has}: {', '.join(known) or 'none'}"


def absolute(folder: str | os.PathLike[str]) -> Path:
    """A folder as it is called wherever the program goes next."""
    place = Path(folder)
    try:
        return place.absolute()
    except OSError as error:
        raise FolderError(f"the folder that this program works in is gone: {error.strerror or error}", hint="os.chdir() to one that there is") from None


def whole(of: Any, what: str, most: int, least: int = 1) -> int:
    """A whole number of Python or numpy."""
    try:
        number = None if isinstance(of, bool) else operator.index(of)
    except TypeError:
        number = None
    if number is None or not least <= number <= most:
        raise ValueError(f"{what} is a whole number from {least} to {most}, not {of!r}")
    return number


def check_threads(threads: Any, name: str = "threads") -> int | None:
    return None if threads is None else whole(threads, name, 4096)


class Named(dict[str, Value], Generic[Value]):
    """Values by name, which say what there is where a name is none."""

    def __init__(self, what: str, of: Mapping[str, Value]) -> None:
        super().__init__(of)
        self._what = what

    def __reduce__(self) -> tuple[Any, ...]:
        return Named, (self._what, dict(self))

    def __missing__(self, name: object) -> Value:
        raise KeyError(there_is_no(f"there is no {self._what}", name, self))
