"""Exceptions, each with the text that a terminal would show."""

from __future__ import annotations

from typing import NamedTuple


class SphorgeError(Exception):
    """Something that Sphorge cannot do, and what to do about it.

    ``str(error)`` is what the command line prints, with the remedy, in the words of Python; ``hint`` is the remedy alone.
    """

    hint: str | None = None

    def __init__(self, text: str = "", *, hint: str | None = None, **details: object) -> None:
        super().__init__(_with_hint(text, hint))
        self.hint = hint or None
        for name, value in details.items():
            setattr(self, name, value)


def _with_hint(text: str, hint: str | None) -> str:
    """What a traceback shows: a text that does not say its hint, in whatever lines, with it."""
    words = "".join(c for c in text if c.isalnum())
    return text if not hint or "".join(c for c in hint if c.isalnum()) in words else f"{text}\n  help: {hint}"


class Problem(NamedTuple):
    """A fault of a deck."""

    message: str
    line: int | None
    hint: str | None
    code: str


class DeckError(SphorgeError, ValueError):
    """A deck that cannot be used. ``problems`` has all of its faults; ``line`` and ``hint`` are those of the first one."""

    def __init__(self, text: str = "", *, problems: list[tuple[str, int | None, str | None, str]] | None = None) -> None:
        self.problems: list[Problem] = [Problem(*problem) for problem in problems or []]
        first = self.problems[0] if self.problems else None
        super().__init__(text, hint=first.hint if first else None)
        self.line: int | None = first.line if first else None


class FolderError(SphorgeError, OSError):
    """A folder or file that cannot be read, written or replaced."""

    def __str__(self) -> str:
        return str(self.args[0]) if self.args else ""


class RunFailed(SphorgeError):
    """A run whose solution broke down. What it has written up to then is complete."""

    step: int = 0
    time: float = 0.0
    field: str | None = None
    particle: int | None = None
    body: str | None = None
    position: list[float] | None = None


class InternalError(SphorgeError):
    """A fault of Sphorge itself."""


class SphorgeWarning(UserWarning):
    """A check has found a run broken, or what is computed of it."""


class SphorgeNote(SphorgeWarning):
    """What there is to note of a deck before it is run: it may not be what was meant."""
