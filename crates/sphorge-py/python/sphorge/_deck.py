"""Decks."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from . import _sphorge, _toml

#: Names and titles of the shipped decks.
decks: dict[str, str] = dict(_sphorge.decks())


class Catalogue(dict[str, dict[str, Any]]):
    """Materials by name."""

    def __missing__(self, name: object) -> dict[str, Any]:
        raise KeyError(f"there is no material `{name}` in the catalogue; there are: {', '.join(self)}")


class Deck:
    """A deck: a file, a shipped one by its name, a ``dict``, or the text of one.

    >>> deck = sphorge.Deck("iron-plate")
    >>> deck["particles.spacing"] = "0.6 mm"
    """

    def __init__(self, source: str | os.PathLike[str] | Mapping[str, Any], *, name: str | None = None) -> None:
        if isinstance(source, Mapping):
            self._deck = _sphorge.Deck.of_text(name or "deck", _toml.document(source))
        elif isinstance(source, (str, os.PathLike)):
            text = os.fspath(source)
            if not isinstance(text, str):
                raise TypeError("the path of a deck is a text")
            is_bare = isinstance(source, str) and Path(text).name == text
            if is_bare and not os.path.exists(text) and not text.endswith(".toml"):
                self._deck = _sphorge.Deck.shipped(text)
            else:
                self._deck = _sphorge.Deck.of_file(text)
        else:
            raise TypeError(f"a deck is a path, a name or a dict, not {type(source).__name__}")

    @classmethod
    def from_text(cls, text: str, *, name: str = "deck") -> Deck:
        """A deck of a text in TOML."""
        deck = cls.__new__(cls)
        deck._deck = _sphorge.Deck.of_text(name, text)
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

    def __getitem__(self, key: str) -> Any:
        """What the deck says at a key, such as ``deck["body.bar.velocity.1"]``; ``KeyError`` where it says nothing."""
        return json.loads(self._deck.get(key))

    def __setitem__(self, key: str, value: Any) -> None:
        """Sets a key, as ``--set`` does: ``deck["particles.spacing"] = "0.6 mm"``."""
        self._deck.set(key, _toml.override(value, key))

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


def _as_deck(deck: Deck | str | os.PathLike[str] | Mapping[str, Any]) -> Deck:
    return deck if isinstance(deck, Deck) else Deck(deck)
