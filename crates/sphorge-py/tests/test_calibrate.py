from __future__ import annotations

import os
import re
import signal
import subprocess
import sys

import numpy as np
import pytest
from conftest import PLATE, raises

import sphorge as sp
from sphorge._calibrate import GaussNewton, _targets

A, B = "material.bar.strength.johnson-cook.A", "material.bar.strength.johnson-cook.B"
#: Of Armco iron.
TRUE = {A: 175e6, B: 380e6}


@pytest.fixture
def bar():
    """A coarse Taylor bar of a material of its own: half of a plate, 60 particles."""
    deck = sp.Deck(PLATE, name="bar")
    body = dict(PLATE["body"][0], material="bar", velocity=["0 m/s", "-200 m/s"])
    material = {"bar": {"base": "armco-iron"}}
    deck = dict(PLATE, body=[body], material=material, time={"end": "40 us"}, particles={"spacing": "2 mm"}, method="total-lagrangian")
    return sp.Deck(deck, name="bar")


def test_two_taylor_bars_give_johnson_cook_a_and_b(here, bar):
    measured = []
    for speed in (-120.0, -250.0):
        own = bar.copy()
        for key, value in {**TRUE, "body.plate.velocity.1": speed}.items():
            own[key] = value
        height = sp.Simulation(own, out=f"true{speed:.0f}", threads=1).run().measures["height"]
        measured.append(sp.Experiment({"height": (height, "0.02 mm")}, set={"body.plate.velocity.1": speed}, name=f"at{-speed:.0f}"))
    params = {A: ("80 MPa", "350 MPa"), B: (100e6, "700 MPa")}
    fit = sp.calibrate(bar, params, measured, out="fit", workers=2)
    assert fit.has_converged and fit.units == {A: "Pa", B: "Pa"}
    for key, true in TRUE.items():
        assert fit.values[key] == pytest.approx(true, rel=0.01)
    assert fit.misfit < 0.1 and len(fit.trials) < 30 and len(fit.studies["at250"]) == len(fit.trials)
    assert all(np.isfinite(error) and error > 0 for error in fit.errors.values())
    asked, got = fit.fitted["at120"]["height"]
    assert got == pytest.approx(asked, abs=1e-5)
    # Once more, from the runs that are there.
    before = {path: path.stat().st_mtime_ns for path in (here / "fit").glob("*/*/summary.json")}
    again = sp.calibrate(bar, params, measured, out="fit", workers=2)
    assert {path: path.stat().st_mtime_ns for path in (here / "fit").glob("*/*/summary.json")} == before and len(before) == 2 * len(fit.trials)
    assert again.values == fit.values and again.trials == fit.trials and A in repr(fit)


def test_a_search_of_ones_own_is_asked_and_told(bar):
    class Three:
        def __init__(self):
            self.told = []

        def ask(self):
            return [] if self.told else [[0.0], [0.5], [1.0]]

        def tell(self, points, deviations):
            self.told = list(zip(points, deviations))

    search = Three()
    bar["time.end"] = "10 us"
    found = sp.calibrate(bar, {"body.plate.velocity.1": ("-100 m/s", "-50 m/s")}, {"height": "23.5 mm"}, out="fit", search=search)
    assert [point for point, _ in search.told] == [[0.0], [0.5], [1.0]] and [row["body.plate.velocity.1"] for row in found.trials] == [-100, -75, -50]
    assert found.errors == {} and found.has_converged and set(found.fitted) == {"experiment-1"}


@pytest.mark.parametrize("seed", range(4))
def test_least_squares_are_found_in_few_points(seed):
    random = np.random.default_rng(seed)
    mixing, true = random.normal(size=(4, 2)), random.uniform(0.1, 0.9, 2)

    def off(point):
        bent = np.array(point) ** 2 + point
        return 100.0 * mixing @ (bent - (true**2 + true))

    search, count = GaussNewton([0.5, 0.5]), 0
    while points := search.ask():
        count += len(points)
        search.tell(points, [off(point) for point in points])
    np.testing.assert_allclose(search.best, true, atol=2e-4)
    assert count < 25


def test_what_is_best_at_a_bound_stays_there_and_what_has_no_effect_is_said(bar):
    search = GaussNewton([0.5, 0.5])
    while points := search.ask():
        search.tell(points, [np.array([10.0 * (point[0] - 1.4), 3.0 * (point[1] - 0.25)]) for point in points])
    np.testing.assert_allclose(search.best, [1.0, 0.25], atol=1e-3)
    bar["time.end"] = "5 us"
    params = {"body.plate.velocity.1": ("-100 m/s", "-50 m/s"), "audit": (100, 200)}
    found = sp.calibrate(bar, params, {"height": "23.7 mm"}, out="fit", most_points=3)
    assert not found.has_converged and "3 points" in found.reason and found.errors["audit"] == float("inf")
    assert "nothing depends on it" in repr(found)
    assert re.search(r"height 0\.\d+ m, measured 0\.0237 m", repr(found)) and found.measure_units == {"height": "m"}


def test_why_nothing_was_measured_is_told(here, deck):
    velocity = "body.plate.velocity.1"
    deck["time.max-steps"] = 3
    own = sp.Deck.from_text(deck.text + '\n[[measure]]\nname = "turns"\nreversal-time = { axis = "y" }\n')
    with raises(sp.SphorgeError, match=r"values to start from: the run \S+fit.experiment-1.\S+ reached its end, and its measure `turns` has no value there"):
        sp.calibrate(own, {velocity: ("-100 m/s", "-50 m/s")}, {"turns": "3 us"}, out="fit")
    with raises(sp.SphorgeError, match="begins with 2 points, and most_points is 1: nothing was run"):
        sp.calibrate(own, {velocity: ("-100 m/s", "-50 m/s")}, {"turns": "3 us"}, out="few", most_points=1)
    assert not (here / "few").exists()
    broken = deck.copy()
    broken["time.fixed-step"], broken["time.max-steps"] = "1 us", 100
    with raises(sp.SphorgeError, match=r"the run \S+failed.experiment-1.\S+ is failed"):
        sp.calibrate(broken, {velocity: ("-100 m/s", "-50 m/s")}, {"height": "20 mm"}, out="failed")


def test_what_one_measure_cannot_tell_apart_has_no_errors_and_what_is_out_of_reach_is_told(bar):
    params = {A: ("80 MPa", "350 MPa"), B: ("100 MPa", "700 MPa")}
    found = sp.calibrate(bar, params, {"height": ("22 mm", "0.1 mm")}, out="fit", workers=2)
    assert found.errors == {A: float("inf"), B: float("inf")} and "makes up for it" in repr(found)
    # Stronger than any within the bounds.
    high = sp.calibrate(bar, {A: params[A]}, {"height": ("25 mm", "0.1 mm")}, out="high", workers=2)
    assert high.values[A] == pytest.approx(350e6) and f"at its bound: {A}" in high.reason


@pytest.mark.parametrize(
    ("error", "change"),
    [
        (TypeError, {"params": {}}),
        (TypeError, {"params": [A]}),
        (TypeError, {"params": {A: "100 MPa"}}),
        (TypeError, {"params": {A: (1e8,)}}),
        (TypeError, {"params": {5: (1, 2)}}),
        (ValueError, {"params": {A: ("100 MPa", "2 mm")}}),
        (ValueError, {"params": {A: (2e8, 1e8)}}),
        (ValueError, {"params": {A: (float("nan"), 1e8)}}),
        (ValueError, {"params": {A: (1e8, 5e8, 2e8)}}),
        (sp.DeckError, {"params": {"material.bar.strength.johnson-cook.Q": (1e8, 2e8)}}),
        (sp.SphorgeError, {"targets": {"heigth": 1.0}}),
        (TypeError, {"targets": {}}),
        (TypeError, {"targets": []}),
        (TypeError, {"targets": [{"height": 1.0}]}),
        (ValueError, {"targets": {"height": "1 MPa"}}),
        (ValueError, {"targets": {"height": float("nan")}}),
        (ValueError, {"targets": {"height": 0.0}}),
        (ValueError, {"targets": {"height": (0.02, -1.0)}}),
        (TypeError, {"targets": {"height": None}}),
        (sp.DeckError, {"targets": sp.Experiment({"height": 0.02}, set={"time.ent": 1.0})}),
        (sp.SphorgeError, {"params": {"body.plate.velocity.1": (-2.0, -1.0), "body.0.velocity.1": (-2.0, -1.0)}}),
        (sp.SphorgeError, {"targets": [sp.Experiment({"height": 0.02}), sp.Experiment({"height": 0.02}, set={"'material'.bar.strength.johnson-cook.B": 1e8})]}),
        (ValueError, {"targets": sp.Experiment({"height": 0.02}, name="../x")}),
        (ValueError, {"targets": sp.Experiment({"height": 0.02}, name="..")}),
        (ValueError, {"most_points": 0}),
        (ValueError, {"workers": 0}),
    ],
)
def test_what_is_wrong_is_told_before_the_first_run(here, bar, error, change):
    given = {"deck": bar, "params": {B: ("100 MPa", "700 MPa")}, "targets": {"height": "20 mm"}, "out": "fit", **change}
    with pytest.raises(error):
        sp.calibrate(**given)
    assert os.listdir(here) == []


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"params": {}}, r"params: what is looked for is a dict of keys and their bounds, and this one is empty: give \{"),
        ({"params": [A]}, "params: .* not list: give"),
        ({"targets": {}}, r"targets are a dict of measures, or experiments, and these are empty: give \[sphorge.Experiment"),
        ({"targets": []}, "and these are empty"),
        ({"targets": [{"height": 1.0}]}, r"and these have \{'height': 1.0\}"),
        ({"targets": 5}, "and these have 5"),
        ({"targets": sp.Experiment({})}, "experiment-1: what was measured is a dict .* and this one is empty"),
        ({"targets": sp.Experiment({"height": 0.02}, set=["time.end"])}, "experiment-1: set is a dict .* not list"),
    ],
)
def test_what_is_empty_or_no_dict_is_told_as_that(here, bar, change, told):
    with raises(TypeError, match=told):
        sp.calibrate(**{"deck": bar, "params": {B: ("100 MPa", "700 MPa")}, "targets": {"height": "20 mm"}, "out": "fit", **change})


def test_an_uncertainty_is_a_difference(bar):
    bar["measure"] = [{"name": "hot", "maximum": {"field": "temperature"}}]
    checked = bar.check()
    assert checked["measure_units"] == {"hot": "K"}

    def target(value):
        return _targets(sp.Experiment({"hot": value}), checked, "a")[0]

    assert (target(("20 degC", "5 degC")).value, target(("20 degC", "5 degC")).uncertainty) == (293.15, 5.0)
    assert target(("20 degC", "0.5 K")).uncertainty == 0.5 and target(("300 K", 2.0)).uncertainty == 2.0
    with raises(ValueError, match="above zero"):
        target(("20 degC", "-1 degC"))


def test_runs_that_are_broken_are_told_once_for_each_check(bar):
    bar["time.end"] = "5 us"
    bar["warnings.compression"] = 1e-9
    params = {"body.plate.velocity.1": ("-200 m/s", "-100 m/s")}
    with pytest.warns(sp.SphorgeWarning) as told:
        found = sp.calibrate(bar, params, {"height": "23.5 mm"}, out="fit", most_points=3)
    assert len(told) == 1 and "compression: in " in str(told[0].message) and told[0].filename == __file__
    runs = found.warnings["compression"]
    assert list(found.warnings) == ["compression"] and len(runs) >= 2 and all(sp.Run(run).status == "completed with warnings" for run in runs)
    assert f"warning compression: in {len(runs)} of the runs" in repr(found)


def test_optuna_samples_where_it_is_installed(bar):
    pytest.importorskip("optuna")
    bar["time.end"] = "5 us"
    search = sp.Optuna(1, points=6, together=3, seed=1)
    found = sp.calibrate(bar, {"body.plate.velocity.1": ("-200 m/s", "-50 m/s")}, {"height": "23.7 mm"}, out="fit", search=search, workers=2)
    assert len(found.trials) == 6 and found.has_converged and found.misfit == min(row["misfit"] for row in found.trials)


@pytest.mark.skipif(os.name == "nt", reason="no such signals")
def test_ctrl_c_stops_a_calibration_and_the_same_call_goes_on(here, bar):
    bar["time.end"] = "100 us"
    bar["output.frames"] = 100
    (here / "bar.toml").write_text(bar.text)
    program = "import sphorge as sp; print(sp.calibrate('bar.toml', {'body.plate.velocity.1': ('-200 m/s', '-100 m/s')}, {'height': '21.5 mm'}, out='fit', most_points=4).values)"
    child = subprocess.Popen([sys.executable, "-c", program], stderr=subprocess.PIPE, text=True)
    while len(list((here / "fit").glob("*/*/fields/000003.vtp"))) < 2:
        assert child.poll() is None
    child.send_signal(signal.SIGINT)
    _, told = child.communicate(timeout=60)
    assert "KeyboardInterrupt" in told
    done = {path: path.stat().st_mtime_ns for path in (here / "fit").glob("*/*/summary.json") if '"completed' in path.read_text()}
    again = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=300)
    assert again.returncode == 0 and "body.plate.velocity.1" in again.stdout, again.stderr
    assert done and all(path.stat().st_mtime_ns == at for path, at in done.items())
    # Made without a break it is the same.
    found = sp.calibrate("bar.toml", {"body.plate.velocity.1": ("-200 m/s", "-100 m/s")}, {"height": "21.5 mm"}, out="whole", workers=2, most_points=4)
    assert again.stdout.strip() == str(found.values)
