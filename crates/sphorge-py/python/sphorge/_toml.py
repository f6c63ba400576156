"""Python values as TOML."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from ._words import printable, told


def _plain(value: Any) -> Any:
    """Arrays and numbers of numpy as those of Python."""
    tolist = getattr(value, "tolist", None)
    return tolist() if callable(tolist) else value


def _text(value: str, where: str) -> str:
    told(value, f"`{where}`")
    # TOML knows the escape sequences of JSON; U+007F it wants escaped, too.
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def _key(name: Any) -> str:
    if not isinstance(name, str):
        raise TypeError(f"keys of a deck are texts, not {type(name).__name__}: {name!r}")
    bare = name and all(c.isascii() and (c.isalnum() or c in "-_") for c in name)
    return name if bare else _text(name, printable(name))


def value(of: Any, where: str) -> str:
    """A value in one line; ``where`` is the path of its key."""
    of = _plain(of)
    if isinstance(of, bool):
        return "true" if of else "false"
    if isinstance(of, str):
        return _text(of, where)
    if isinstance(of, int):
        return str(of)
    if isinstance(of, float):
        # `nan` and `inf` are numbers of TOML; a deck refuses them by name.
        return repr(of)
    if isinstance(of, Mapping):
        return "{ " + ", ".join(f"{_key(k)} = {value(v, f'{where}.{k}')}" for k, v in of.items()) + " }"
    if isinstance(of, Sequence) and not isinstance(of, (bytes, bytearray)):
        return "[" + ", ".join(value(entry, f"{where}.{k}") for k, entry in enumerate(of)) + "]"
    raise TypeError(f"`{where}` cannot be {type(of).__name__}: decks hold texts, numbers, lists and dicts")


def override(of: Any, where: str) -> str:
    """A value as ``--set`` takes it: texts without quotation marks are read as what they are."""
    return told(of, f"`{where}`") if isinstance(of, str) else value(of, where)


def document(deck: Mapping[str, Any]) -> str:
    """A whole deck, a table or entry of a list under its own heading."""
    top: list[str] = []
    tables: list[str] = []
    for name, entry in deck.items():
        key = _key(name)
        entry = _plain(entry)
        entries = entry if isinstance(entry, Sequence) and not isinstance(entry, (str, bytes, bytearray)) else []
        if isinstance(entry, Mapping):
            tables.append(f"[{key}]")
            tables += [f"{_key(k)} = {value(v, f'{name}.{k}')}" for k, v in entry.items()] + [""]
        elif entries and all(isinstance(one, Mapping) for one in entries):
            for n, one in enumerate(entries):
                tables.append(f"[[{key}]]")
                tables += [f"{_key(k)} = {value(v, f'{name}.{n}.{k}')}" for k, v in one.items()] + [""]
        else:
            top.append(f"{key} = {value(entry, str(name))}")
    return "\n".join([*top, "", *tables])
