"""What notebooks show: tables, pictures, and how far a simulation is."""

from __future__ import annotations

import base64
import importlib
import sys
from collections.abc import Mapping
from html import escape
from typing import Any


def quantity(value: float | None, unit: str) -> str:
    """A number with its unit."""
    return "–" if value is None else f"{value:.5g} {unit}".rstrip()


def table(rows: Mapping[str, str]) -> str:
    """A table of two columns."""
    cells = "".join(f"<tr><th style='text-align:left'>{escape(name)}</th><td>{escape(text)}</td></tr>" for name, text in rows.items())
    return f"<table>{cells}</table>"


def image(data: bytes | None) -> str:
    """A picture in a page; nothing where there is none."""
    return "" if data is None else f"<img alt='last frame' src='data:image/png;base64,{base64.b64encode(data).decode()}'/>"


def is_notebook() -> bool:
    """Whether what is displayed comes to a page, as in Jupyter."""
    # Not imported where nobody else has.
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    return type(shell).__name__ == "ZMQInteractiveShell"


class Bar:
    """How far a simulation is, in a notebook or on a terminal."""

    #: Seconds between two looks.
    INTERVAL = 0.25

    def __init__(self, name: str) -> None:
        self._name = name
        self._handle: Any = None
        self._is_page = is_notebook()
        self._last = ""

    def show(self, fraction: float, text: str, *, is_over: bool) -> None:
        """Shows a share, 0 to 1, and what else there is to say."""
        if not self._is_page:
            if sys.stderr.isatty() or is_over:
                filled = round(30 * fraction)
                line = f"\r{self._name} [{'#' * filled}{'.' * (30 - filled)}] {100 * fraction:3.0f} %  {text}"
                sys.stderr.write(line + " " * max(0, len(self._last) - len(line)) + ("\n" if is_over else ""))
                sys.stderr.flush()
                self._last = line
            return
        shows: Any = importlib.import_module("IPython.display")
        page = shows.HTML(f"{escape(self._name)} <progress value='{fraction:.4f}' max='1' style='width:20em'></progress> {100 * fraction:.0f} % {escape(text)}")
        if self._handle is None:
            self._handle = shows.display(page, display_id=True)
        else:
            self._handle.update(page)
