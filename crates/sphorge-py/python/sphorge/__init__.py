"""Sphorge: smoothed-particle hydrodynamics for metals that yield, flow and break.

>>> import sphorge as sp
>>> deck = sp.Deck("iron-plate")
>>> deck["particles.spacing"] = "0.6 mm"
>>> for frame in sp.Simulation(deck, out="out/a"):
...     print(frame.time, frame["pressure"].max())
>>> sp.Run("out/a").measures["height"]

All numbers are in SI units. Errors are exceptions with the text of the command line.
"""

from __future__ import annotations

from typing import Any

from . import _sphorge
from ._calibrate import Calibration, Experiment, GaussNewton, Optuna, calibrate
from ._deck import Catalogue, Deck, decks
from ._errors import DeckError, FolderError, InternalError, Problem, RunFailed, SphorgeError, SphorgeNote, SphorgeWarning
from ._particles import particles
from ._picture import Picture
from ._run import Fragments, Frame, Frames, History, Run
from ._simulation import STOP, Simulation, State, fields
from ._studies import BallisticLimit, Bracket, Convergence, MeasureConvergence, RechtIpson, Study, ballistic_limit, convergence, sweep

__version__: str = _sphorge.__version__

__all__ = [
    "STOP",
    "BallisticLimit",
    "Bracket",
    "Calibration",
    "Convergence",
    "Deck",
    "DeckError",
    "Experiment",
    "FolderError",
    "Fragments",
    "Frame",
    "Frames",
    "GaussNewton",
    "History",
    "InternalError",
    "MeasureConvergence",
    "Optuna",
    "Picture",
    "Problem",
    "RechtIpson",
    "Run",
    "RunFailed",
    "Simulation",
    "SphorgeError",
    "SphorgeNote",
    "SphorgeWarning",
    "State",
    "Study",
    "ballistic_limit",
    "calibrate",
    "convergence",
    "decks",
    "fields",
    "materials",
    "particles",
    "sweep",
]


def __getattr__(name: str) -> Any:
    # The catalogue takes a moment to read.
    if name == "materials":
        catalogue = Catalogue(_sphorge.materials())
        globals()["materials"] = catalogue
        return catalogue
    raise AttributeError(f"module 'sphorge' has no attribute {name!r}")
