"""Decks."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from . import _sphorge, _toml
from ._errors import SphorgeError
from ._words import absolute, printable, there_is_no, told

#: Names and titles of the shipped decks.
decks: dict[str, str] = dict(_sphorge.decks())


class Catalogue(dict[str, dict[str, Any]]):
    """Materials by name."""

    def __missing__(self, name: object) -> dict[str, Any]:
        raise KeyError(there_is_no("the catalogue has no material", name, self))


class Deck:
    """A deck: the path of a file, the name of a shipped one, or a ``dict``. `from_text` takes the text of one.

    >>> deck = sphorge.Deck("iron-plate")
    >>> deck["particles.spacing"] = "0.6 mm"

    ``name`` is that of a deck which has no file: that of the output folder, unless another is given.
    """

    def __init__(self, source: str | os.PathLike[str] | Mapping[str, Any], *, name: str | None = None) -> None:
        if isinstance(source, Mapping):
            self._deck = _sphorge.Deck.of_text(_named("deck" if name is None else name), _toml.document(source))
        elif isinstance(source, (str, os.PathLike)):
            text = os.fspath(source)
            if not isinstance(text, str):
                raise TypeError("the path of a deck is a text")
            if ("\n" in text or ("=" in text and not text.endswith(".toml"))) and not os.path.exists(text):
                raise SphorgeError("this is a text, not the path of a deck or the name of a shipped one", hint="sphorge.Deck.from_text(text) takes the text of a deck")
            is_bare = isinstance(source, str) and Path(text).name == text
            if is_bare and not os.path.exists(text) and not text.endswith(".toml"):
                self._deck = _sphorge.Deck.shipped(text)
            else:
                read = _sphorge.Deck.of_file(text)
                # Tables that it names are beside it, wherever the program goes.
                self._deck = _sphorge.Deck.of_parts(read.name, absolute(text), *read.source()[1:])
        else:
            raise TypeError(f"a deck is a path, a name or a dict, not {type(source).__name__}")

    @classmethod
    def from_text(cls, text: str, *, name: str = "deck") -> Deck:
        """A deck of a text in TOML."""
        deck = cls.__new__(cls)
        if not isinstance(text, str):
            raise TypeError(f"from_text(): the text of a deck is a text, not {type(text).__name__}")
        deck._deck = _sphorge.Deck.of_text(_named(name), told(text, "the text of the deck"))
        return deck

    @property
    def name(self) -> str:
        """Name that the output folder has unless another is given."""
        return self._deck.name

    @property
    def text(self) -> str:
        """The deck in TOML, with everything that was set."""
        return self._deck.text

    def copy(self) -> Deck:
        """A deck of its own with the same text and changes."""
        deck = Deck.__new__(Deck)
        deck._deck = self._deck.copy()
        return deck

    def __copy__(self) -> Deck:
        return self.copy()

    def __deepcopy__(self, memo: Any) -> Deck:
        return self.copy()

    def __reduce__(self) -> tuple[Any, ...]:
        # With the text that it was made of, whatever its file has become.
        return _of_parts, (self._deck.name, *self._deck.source())

    def __getitem__(self, key: str) -> Any:
        """What the deck says at a key, such as ``deck["body.bar.velocity.1"]``; ``KeyError`` where it says nothing."""
        return json.loads(self._deck.get(key))

    def __setitem__(self, key: str, value: Any) -> None:
        """Sets a key, as ``--set`` does: ``deck["particles.spacing"] = "0.6 mm"``."""
        if not isinstance(key, str):
            raise TypeError(f"keys of a deck are texts, not {type(key).__name__}")
        self._deck.set(told(key, "the key"), _toml.override(value, key))

    def __contains__(self, key: object) -> bool:
        try:
            self._deck.get(key)  # type: ignore[arg-type]
        except (KeyError, TypeError):
            return False
        return True

    def check(self) -> dict[str, Any]:
        """Reads and fills the deck: ``particles``, ``bodies`` with their masses, ``measures``, ``notes``."""
        return self._deck.check()

    def __repr__(self) -> str:
        return f"<sphorge.Deck {self.name!r}>"


def _of_parts(name: str, path: Path | None, text: str, overrides: list[tuple[str, str]]) -> Deck:
    deck = Deck.__new__(Deck)
    deck._deck = _sphorge.Deck.of_parts(name, path, text, overrides)
    return deck


def _named(name: Any) -> str:
    """A name of a deck, if it is one of a folder alone."""
    if not isinstance(name, str):
        raise TypeError(f"the name of a deck is a text, not {type(name).__name__}")
    told(name, "the name of the deck")
    if name in ("", ".", "..") or any(c in "/\\" or not c.isprintable() for c in name):
        raise ValueError(f"`{printable(name)}` is no name of a deck: its output folder is called so; leave out slashes, and choose the folder by `out`")
    return name


def folder_for(deck: Deck, ending: str, out: str | os.PathLike[str] | None) -> Path:
    """A folder that was given, or that of a deck."""
    if out is not None:
        return Path(out)
    # A file can be called what no folder is.
    name = deck.name
    if name in ("", ".", "..") or "/" in name or "\\" in name:
        raise SphorgeError(f"`{printable(name)}` is no name of a folder", hint="give another one: out=...")
    return Path("out") / f"{name}{ending}"


def _as_deck(deck: Deck | str | os.PathLike[str] | Mapping[str, Any]) -> Deck:
    return deck if isinstance(deck, Deck) else Deck(deck)
