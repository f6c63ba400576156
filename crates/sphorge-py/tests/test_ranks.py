"""Runs on ranks, by MPI itself: `scripts/wheel.sh --mpi` builds a package with it."""

from __future__ import annotations

import os
import shutil

import pytest
from conftest import raises
from test_simulation import history

import sphorge as sp
from sphorge import _sphorge

pytestmark = [
    pytest.mark.skipif(not _sphorge.has_mpi, reason="this package was built without MPI"),
    pytest.mark.skipif(shutil.which("mpirun") is None, reason="there is no mpirun here"),
]


@pytest.fixture(autouse=True)
def as_root(monkeypatch):
    """Containers run as root, which Open MPI has to be told."""
    if hasattr(os, "getuid") and os.getuid() == 0:
        for name in ("OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM"):
            monkeypatch.setenv(name, "1")


def test_a_run_on_two_ranks_is_that_of_one_process(here, deck):
    deck["particles.spacing"] = "0.8 mm"
    simulation = sp.Simulation(deck, out="two", ranks=2, threads=1)
    frames = [(frame.step, frame["velocity"].copy()) for frame in simulation]
    run = sp.Run("two")
    assert run.summary["ranks"] == 2 and run.status == "completed" and simulation.summary == run.summary
    alone = sp.Simulation(deck, out="one", threads=1).run()
    assert history(here / "two") == history(here / "one") and alone.summary["ranks"] == 1
    assert [step for step, _ in frames] == [frame.step for frame in alone.frames]
    for (_, velocity), frame in zip(frames, alone.frames):
        assert (velocity == frame["velocity"]).all()
    # Each rank has written its own.
    assert (here / "two/fields/000001/0001.vtp").exists()


def test_a_run_on_two_ranks_that_is_stopped_goes_on_in_one_process(here, deck):
    deck["particles.spacing"] = "0.5 mm"
    deck["output.frames"] = 40
    whole = sp.Simulation(deck, out="whole", threads=1).run()
    simulation = sp.Simulation(deck, out="two", ranks=2, threads=1)
    next(simulation), next(simulation)
    stopped = simulation.stop()
    assert stopped.status == "stopped" and 0 < stopped.summary["steps"] < whole.summary["steps"]
    resumed = sp.Simulation.resume("two", threads=1).run()
    assert resumed.status == "completed" and resumed.summary["steps"] == whole.summary["steps"]
    assert resumed.measures == whole.measures


def test_a_run_on_two_ranks_that_fails_says_so(deck):
    deck["time.fixed-step"] = "1 us"
    with raises(sp.SphorgeError, match="fixed-step"):
        sp.Simulation(deck, out="a", ranks=2, threads=1).run()
    assert sp.Run("a").status == "failed"
