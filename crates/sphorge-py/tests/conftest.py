"""What the tests share: a small deck, and a folder to work in."""

from __future__ import annotations

import contextlib
import re
import signal

import pytest

import sphorge as sp

# A shell lets its jobs in the background ignore Ctrl-C, and so would what the tests start and interrupt.
signal.signal(signal.SIGINT, signal.default_int_handler)

#: A plate on a wall: 190 particles, some thirty steps.
PLATE = {
    "title": "Small plate on a wall",
    "dimensions": "plane-strain",
    "method": "updated-lagrangian",
    "particles": {"spacing": "1 mm"},
    "time": {"end": "2 us"},
    "output": {"frames": 4},
    "body": [
        {
            "name": "plate",
            "material": "armco-iron",
            "shape": {"box": {"min": ["-4 mm", "0 mm"], "max": ["4 mm", "24 mm"]}},
            "velocity": ["0 m/s", "-100 m/s"],
        }
    ],
    "wall": [{"name": "anvil", "plane": {"point": ["0 mm", "0 mm"], "normal": [0, 1]}}],
    "measure": [{"name": "height", "extent": {"body": "plate", "axis": "y"}}],
}


def text_of(error):
    """What an error says, on one line: where its lines are broken depends on the names of folders in it."""
    return " ".join(str(error).replace("│", " ").split())


@contextlib.contextmanager
def raises(kind, match):
    """The block raises such an error, and what it says matches the pattern."""
    with pytest.raises(kind) as told:
        yield told
    assert re.search(match, text_of(told.value)), text_of(told.value)


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    """Each test works in a folder of its own."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def deck():
    return sp.Deck(PLATE, name="plate")


@pytest.fixture
def long_deck(deck):
    """One that runs for minutes, with frames often."""
    deck["time.end"] = "50 ms"
    deck["output.frames"] = 50000
    deck["body.plate.velocity"] = ["0 m/s", "0 m/s"]
    return deck
