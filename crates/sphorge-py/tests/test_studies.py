from __future__ import annotations

import itertools
import os
import re
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from conftest import raises

import sphorge as sp


def written(folder):
    return {path: path.stat().st_mtime_ns for path in folder.glob("*/summary.json")}


def test_a_sweep_is_made_once(here, deck):
    varied = {"body.plate.velocity.1": ["-50 m/s", -100.0], "particles.spacing": ["2 mm", np.float64(0.0015)]}
    study = sp.sweep(deck, varied, out="s", workers=2)
    assert len(study) == 4 and study.is_complete and study.keys == list(varied) and study.measures == ["height"]
    np.testing.assert_allclose(study.table["body.plate.velocity.1"], [-50, -50, -100, -100])
    np.testing.assert_allclose(study.table["particles.spacing"], [2e-3, 1.5e-3, 2e-3, 1.5e-3])
    assert study.units["body.plate.velocity.1"] == "m/s" and study.units["height"] == "m"
    own = deck.copy()
    own["body.plate.velocity.1"], own["particles.spacing"] = -100.0, 0.0015
    alone = sp.Simulation(own, out="alone").run()
    assert study.table["height"][3] == alone.measures["height"] == study.runs[3].measures["height"]
    before = written(here / "s")
    again = sp.sweep(deck, varied, out="s")
    assert written(here / "s") == before and (again.table["height"] == study.table["height"]).all()
    assert "completed" in repr(again)
    sp.sweep(deck, {**varied, "particles.spacing": ["2 mm", 0.0015, "3 mm"]}, out="s")
    after = written(here / "s")
    assert len(after) == 6 and all(after[path] == at for path, at in before.items())


def test_what_is_wrong_is_told_before_the_first_run(here, deck):
    for error, varied in [
        (sp.DeckError, {"time.ent": ["1 us"]}),
        (sp.DeckError, {"time.end": ["1 us", "2 mm"]}),
        (sp.DeckError, {"time.end": [float("nan")]}),
        (sp.SphorgeError, {"time.end": ["1 us", "1000 ns"]}),
        (sp.SphorgeError, {"time.end": []}),
        (sp.SphorgeError, {}),
        (TypeError, {"time.end": "1 us"}),
        (TypeError, {"time.end": 5}),
        (TypeError, {"time.end": [None]}),
        (TypeError, {5: ["1 us"]}),
        (TypeError, ["time.end"]),
    ]:
        with pytest.raises(error):
            sp.sweep(deck, varied, out="s")
    with pytest.raises(sp.DeckError) as second:
        sp.sweep(deck, {"time.end": ["1 us", "2 mm"]}, out="s")
    assert "run 2 of 2" in str(second.value) and "length" in second.value.problems[0].message
    for wrong in ({"workers": 0}, {"workers": "2"}, {"threads": 0}, {"engine": "quantum"}):
        with pytest.raises((ValueError, sp.SphorgeError)):
            sp.sweep(deck, {"time.end": ["1 us"]}, out="s", **wrong)
    for keys in (("body.plate.velocity.1", "body.0.velocity.1"), ("body.plate.velocity", "body.plate.velocity.1"), ('"time"."end"', "time.end")):
        values = {"body.plate.velocity": [[0.0, -1.0]]}
        with raises(sp.SphorgeError, match="set the same") as both:
            sp.sweep(deck, {key: values.get(key, ["1 us"] if "time" in key else [-2.0]) for key in keys}, out="s")
        assert all(f"`{key}`" in str(both.value) for key in keys)
    deck["time.end"] = "1 us"
    with raises(sp.SphorgeError, match='`time.end` is set, and `"time".end`'):
        sp.sweep(deck, {'"time".end': ["1 us"]}, out="s")
    with raises(sp.SphorgeError, match="set and varied"):
        sp.sweep(deck, {"time.end": ["1 us"]}, out="s")
    assert os.listdir(here) == []


def test_the_table_is_that_of_the_file(here, deck):
    study = sp.sweep(deck, {"particles.spacing": ["2 mm", "3 mm"]}, out="s")
    head, *lines = [line.split(",") for line in (here / "s/sweep.csv").read_text().splitlines()]
    assert [f"{name} ({study.units[name]})" if study.units.get(name) else name for name in study.table] == head
    for column, name in enumerate(study.table):
        for line, value in zip(lines, study.table[name]):
            assert line[column] == value if isinstance(value, str) else float(line[column]) == value, name
    summaries = [run.summary for run in study.runs]
    assert study.table["steps"].dtype.kind == study.table["particles"].dtype.kind == "i"
    assert study.table["steps"].tolist() == [of["steps"] for of in summaries] and min(study.table["steps"]) > 0
    assert study.table["particles"].tolist() == [of["particles"] for of in summaries]
    np.testing.assert_allclose(study.table["simulated_time"], 2e-6, rtol=1e-12)
    # What has not run has no numbers, and a measure may be called like a column.
    deck["time.fixed-step"] = "300 ns"
    height = deck["measure"][0]
    deck["measure"] = [{**height, "name": name} for name in ("status", "steps", "height")]
    study = sp.sweep(deck, {"particles.spacing": ["0.5 mm", "2 mm"]}, out="t")
    assert study.table["status"] == ["failed", "completed"] and "measure.status" in study.table
    assert study.table["measure.status"][1] == study.table["steps"][1] == study.table["height"][1] > 0.01
    assert study.table["measure.steps"][1] == study.runs[1].summary["steps"]


def test_a_convergence_of_nothing_is_refused_before_the_first_run(here, deck):
    deck["measure"] = []
    with raises(sp.SphorgeError, match="the deck has no measure, so that there is nothing whose order"):
        sp.convergence(deck, ["3 mm", "2 mm"], out="c")
    assert os.listdir(here) == []


def test_a_run_that_fails_is_a_row(deck):
    deck["time.fixed-step"] = "300 ns"
    study = sp.sweep(deck, {"particles.spacing": ["0.5 mm", "2 mm"]}, out="s")
    assert study.table["status"] == ["failed", "completed"] and not study.is_complete
    assert np.isnan(study.table["height"][0]) and "fixed-step" in study.told[0] and study.told[1] is None


def test_measures_have_order_and_limit(deck):
    found = sp.convergence(deck, ["1 mm", "4 mm", "2 mm"], out="c", workers=2)
    height = found["height"]
    assert height.unit == "m" and list(height.values) == list(found.table["height"]) and len(height.values) == 3
    assert (height.order is None) == (height.limit is None) == (height.why_not is not None)
    with raises(KeyError, match="did you mean `height`"):
        found["heigt"]
    with raises(sp.SphorgeError, match="one spacing"):
        sp.convergence(deck, ["1 mm"], out="d")
    with pytest.raises(TypeError):
        sp.convergence(deck, "1 mm", out="d")


def test_what_there_is_to_note_of_runs_is_told_with_the_study(deck):
    deck["time.max-steps"] = 2
    found = sp.convergence(deck, ["1 mm", "3 mm", "7 mm"], out="c")
    assert set(found.notes) == {"particles.spacing=3mm", "particles.spacing=7mm"} and "mass than its shape" in found.notes["particles.spacing=7mm"][0]
    # What was set has moved the lines of the deck.
    assert repr(found).count("mass than its shape") == 2 and "note: particles.spacing=7mm: body `plate`" in repr(found)
    told = subprocess.run([sys.executable, "-m", "sphorge", "convergence", "c/particles.spacing=1mm.toml", "--spacing", "1 mm,7 mm", "-o", "d"], capture_output=True, text=True)
    assert told.returncode == 0 and re.search(r"note: particles\.spacing=7mm: line \d+: body `plate`", told.stderr), told.stderr


def test_too_many_runs_are_counted_and_not_made_ready(here, deck):
    many = [f"{k} ns" for k in range(1, 100_001)]
    begun = time.monotonic()
    for make in (
        lambda: sp.sweep(deck, {"time.end": many}, out="s"),
        lambda: sp.sweep(deck, {"time.end": (f"{k} ns" for k in itertools.count(1))}, out="s"),
        lambda: sp.sweep(deck, {"time.end": many[:1000], "time.max-steps": range(1, 1001)}, out="s"),
        lambda: sp.convergence(deck, np.linspace(1e-3, 2e-3, 20_000), out="s"),
    ):
        with raises((sp.SphorgeError, ValueError), match="more than 10000"):
            make()
    assert time.monotonic() - begun < 20.0 and os.listdir(here) == []


@pytest.mark.skipif(os.name == "nt", reason="no such signals")
def test_ctrl_c_is_heard_while_a_sweep_is_made_ready(here, deck):
    (here / "plate.toml").write_text(deck.text)
    program = "import sphorge as sp; print('go', flush=True); sp.sweep('plate.toml', {'time.end': [f'{k} ns' for k in range(1, 9001)]}, out='s')"
    child = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    child.stdout.readline()
    time.sleep(1.0)
    begun = time.monotonic()
    child.send_signal(signal.SIGINT)
    _, told = child.communicate(timeout=120)
    assert "KeyboardInterrupt" in told and time.monotonic() - begun < 5.0 and not (here / "s").exists()


def test_two_studies_do_not_make_the_same_runs(here, long_deck):
    long_deck["output.frames"] = 100
    (here / "long.toml").write_text(long_deck.text)
    program = "import sphorge as sp; sp.sweep('long.toml', {'particles.spacing': ['0.5 mm']}, out='s')"
    child = subprocess.Popen([sys.executable, "-c", program], stderr=subprocess.PIPE, text=True)
    while not (here / "s/particles.spacing=0.5mm/history.csv").exists():
        assert child.poll() is None
        time.sleep(0.05)
    with raises(sp.FolderError, match=r"another study makes runs in \S+: process") as told:
        sp.sweep("long.toml", {"particles.spacing": ["0.5 mm", "2 mm"]}, out="s")
    assert "overwrite" not in str(told.value) and not (here / "s/particles.spacing=2mm").exists()
    child.send_signal(signal.SIGINT)
    child.communicate(timeout=60)
    assert sp.Run("s/particles.spacing=0.5mm").status == "stopped"
    # The folder is free again.
    assert sp.sweep("long.toml", {"time.max-steps": [2]}, out="s").is_complete


def test_titles_are_shown_as_they_are(deck):
    study = sp.sweep(deck, {"title": ["it's, \"x\"", "b"], "time.max-steps": [1]}, out="s")
    assert "it's, \"x\" " in repr(study) and study.table["title"][0] == "it's, \"x\""


@pytest.mark.skipif(os.name == "nt", reason="no such signals")
def test_ctrl_c_stops_the_runs_of_a_sweep_and_the_next_one_goes_on(here, long_deck):
    long_deck["time.end"] = "100 us"
    long_deck["output.frames"] = 100
    (here / "long.toml").write_text(long_deck.text)
    program = "import sphorge as sp; sp.sweep('long.toml', {'particles.spacing': ['0.5 mm', '0.51 mm']}, out='s')"
    child = subprocess.Popen([sys.executable, "-c", program], stderr=subprocess.PIPE, text=True)
    while not (here / "s/particles.spacing=0.5mm/fields/000002.vtp").exists():
        assert child.poll() is None
    child.send_signal(signal.SIGINT)
    _, told = child.communicate(timeout=60)
    assert "KeyboardInterrupt" in told and sp.Run("s/particles.spacing=0.5mm").status == "stopped"
    assert not (here / "s/particles.spacing=0.51mm").exists()


#: A punch through a strip that breaks early, held at its ends: 228 particles, some 1500 steps.
STRIP = {
    "title": "A punch through a strip",
    "dimensions": "plane-strain",
    "particles": {"spacing": "1 mm"},
    "time": {"end": "80 us"},
    "output": {"frames": 1, "history-interval": "1 us"},
    "material": {"brittle": {"base": "weldox-460-e", "damage": {"failure-strain": {"strain": 0.1}}}},
    "body": [
        {"name": "strip", "material": "brittle", "shape": {"box": {"min": ["-24 mm", "-4 mm"], "max": ["24 mm", "0 mm"]}}},
        {
            "name": "punch",
            "material": "armco-iron",
            "shape": {"box": {"min": ["-3 mm", "0 mm"], "max": ["3 mm", "6 mm"]}},
            "velocity": ["0 m/s", "-150 m/s"],
        },
    ],
    "region": [
        {"name": "left", "shape": {"box": {"min": ["-25 mm", "-5 mm"], "max": ["-20 mm", "0 mm"]}}},
        {"name": "right", "shape": {"box": {"min": ["20 mm", "-5 mm"], "max": ["25 mm", "0 mm"]}}},
    ],
    "motion": [{"region": "left", "velocity": [0.0, 0.0]}, {"region": "right", "velocity": [0.0, 0.0]}],
    "measure": [{"name": "residual", "mean": {"body": "punch", "field": "velocity", "component": "y"}}],
}


def test_a_ballistic_limit_is_bracketed(here):
    strip = sp.Deck(STRIP, name="strip")
    search = {"within": 100.0, "at": [300.0, "350 m/s"], "exponent": 2, "out": "b", "workers": 2}
    found = sp.ballistic_limit(strip, ("100 m/s", 400.0), **search)
    low, high = found.bracket
    assert found.is_found and found.is_complete and found.limit == 0.5 * (low + high) and high - low <= 100.0
    speeds = found.table["impact_velocity"]
    assert list(speeds) == sorted(speeds) and {100.0, 300.0, 350.0, 400.0} <= set(speeds)
    np.testing.assert_array_equal(found.table["body.punch.velocity.1"], -speeds)
    np.testing.assert_array_equal(found.table["residual_velocity"], -found.table["residual"])
    assert found.table["outcome"] == ["through" if speed >= high else "stopped" for speed in speeds]
    curve = found.curve
    assert low <= curve.limit <= high and curve.p == 2.0 and curve.residual(low) == 0.0
    assert curve.runs == found.table["outcome"].count("through") > 2
    assert curve.residual(400.0) == pytest.approx(curve.a * (400.0**2 - curve.limit**2) ** 0.5)
    assert found.plot().data.startswith(b"\x89PNG") and b"impact velocity" in found.plot("svg").data
    assert "through" in repr(found) and (here / "b/ballistic-limit.csv").exists()
    before = written(here / "b")
    assert sp.ballistic_limit(strip, ("100 m/s", 400.0), **search).bracket == found.bracket and written(here / "b") == before
    slow = sp.ballistic_limit(strip, (20.0, 40.0), out="slow")
    assert not slow.is_found and slow.limit is None and slow.curve is None and "got through" in slow.why_no_curve
    assert "`between`" in slow.remarks[0] and "--" not in repr(slow)


def test_what_is_wrong_with_a_ballistic_limit_is_told_before_the_first_run(here, deck):
    strip = sp.Deck(STRIP, name="strip")
    for error, told, wrong in [
        (sp.SphorgeError, "not above zero", {"between": (-3.0, None)}),
        (sp.SphorgeError, "goes from 300 m/s to 200 m/s", {"between": (300.0, 200.0)}),
        (sp.SphorgeError, "a length", {"within": "3 mm"}),
        (sp.SphorgeError, "no body `punsh`", {"body": "punsh"}),
        (sp.SphorgeError, "has no velocity", {"body": ["strip"]}),
        (sp.SphorgeError, "no measure `residaul`", {"residual": "residaul"}),
        (sp.SphorgeError, "exponent", {"exponent": float("nan")}),
        (TypeError, "two speeds", {"between": "100 m/s"}),
        (ValueError, "two speeds", {"between": (1.0, 2.0, 3.0)}),
        (TypeError, "a list of speeds", {"at": "100 m/s"}),
        (TypeError, "a speed is a number", {"within": [3]}),
        (ValueError, "runs", {"runs": 0}),
    ]:
        with pytest.raises(error, match=told):
            sp.ballistic_limit(strip, out="b", **wrong)
    with pytest.raises(sp.SphorgeError, match="no measure of the velocity along y"):
        sp.ballistic_limit(deck, out="b")
    assert os.listdir(here) == []
