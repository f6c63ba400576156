"""What exceptions say is for who writes Python: options of the command line are keywords, and hints are where a traceback shows them."""

from __future__ import annotations

import re
import subprocess
import sys

import pytest
from conftest import text_of

import sphorge as sp

#: An option of the command line.
OPTION = re.compile(r"(^|[\\s`(])--?[a-z]")


def test_no_message_speaks_of_options_of_the_command_line(here, deck):
    run = sp.Simulation(deck, out="a", threads=1).run()
    deck["output.frames"] = 2
    (here / "other").mkdir()
    (here / "other/mine.txt").write_text("mine")
    other = sp.sweep(deck, {"time.end": ["1 us"]}, out="s").folder
    deck["particles.smoothing"] = 1.25
    with sp.Simulation(deck, out="b", threads=1) as stopped:
        stopped.step()
    held = sp.Simulation(deck, out="held", threads=1)
    cases = {
        "overwrite=True": lambda: sp.Simulation(deck, out="a"),
        "out=...": lambda: sp.Simulation(deck, out="other"),
        "overwrite=True`": lambda: sp.sweep(deck, {"time.end": ["1 us"]}, out=other),
        "`out=...`": lambda: sp.sweep(deck, {"time.end": ["1 us"]}, out="a"),
        '`{"particles.spacing": ["0.6 mm", "0.3 mm"]}`': lambda: sp.sweep(deck, {}, out="t"),
        'device': lambda: sp.Simulation(deck, out="d", device="any"),
        "what was set": lambda: sp.Simulation(changed(deck, "time.end", "1 mm"), out="d"),
        "unknown key": lambda: deck.__setitem__("time.ent", 1),
        "checkpoint_at_end=True": lambda: sp.Simulation.resume("a"),
        "time.end": lambda: sp.Simulation.resume("a", {"particles.spacing": "1 mm"}),
        "section=True": lambda: run.plot("pressure", section="x at 900 mm"),
        "frames": lambda: run.plot("pressure", frames=["all", 2]),
        "format": lambda: run.plot("pressure", format="tiff"),
        "sphorge.materials": lambda: changed(deck, "body.plate.material", "armko-iron").check(),
        "engine": lambda: sp.Simulation(deck, out="d", engine="gpu"),
        "`.sphorge-lock`": lambda: sp.Simulation(deck, out="held", overwrite=True),
        "package": lambda: sp.Simulation(deck, out="d", engine="gpu"),
        "`column` is empty": lambda: run.plot(column=[]),
        "`scale` goes with `column`": lambda: run.plot("pressure", scale={"height": 2}),
        "engines": lambda: sp.Simulation(deck, out="d", engine="quantum"),
    }
    for told, make in cases.items():
        with pytest.raises(Exception) as raised:
            make()
        text = text_of(raised.value)
        # Nor of what is where in the library.
        assert "::" not in text and "cargo" not in text, text
        assert not OPTION.search(text), text
        hint = getattr(raised.value, "hint", None)
        if hint is not None:
            assert not OPTION.search(hint), hint
            assert "".join(hint.split()) in "".join(text.split()), (hint, text)
        if told.strip("`") not in ("engines", "frames", "format", "device"):
            assert told in text, (told, text)
    held.stop()
    # Whole numbers of any type.
    assert run.plot(column="height", dpi=100.0).data == run.plot(column="height", dpi=100).data


def changed(deck, key, value):
    own = deck.copy()
    own[key] = value
    return own


def test_a_traceback_has_the_hint(here):
    program = "import sphorge as sp; sp.Simulation('iron-plate').load('bat')"
    told = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True).stderr
    assert "no body `bat`" in told and "help: did you mean `bar`? there are: bar" in told, told
    told = subprocess.run([sys.executable, "-c", "import sphorge as sp; sp.Deck('iron-plat')"], capture_output=True, text=True).stderr
    assert "help: did you mean `iron-plate`?" in told, told
    # Once, where the text has it already.
    error = sp.SphorgeError("this and that: do it", hint="do it")
    assert str(error) == "this and that: do it" and str(sp.FolderError("a", hint="b")) == "a\n  help: b"
