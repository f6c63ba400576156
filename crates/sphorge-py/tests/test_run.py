from __future__ import annotations

import json
import pickle
import subprocess
import sys

import numpy as np
import pytest
from conftest import raises

import sphorge as sp


@pytest.fixture
def run(deck):
    return sp.Simulation(deck, out="a", threads=1).run()


def test_a_run_is_read_with_units(run):
    assert run.status == "completed" and run.measures["height"] == pytest.approx(0.0238, rel=0.01)
    assert run.measure_units == {"height": "m"} and run.warnings == [] and "armco-iron" in run.deck
    history = run.history
    assert history.units["kinetic_energy"] == "J/m" and history.meanings["time"]
    assert history["height"][-1] == run.measures["height"] and (np.diff(history["time"]) > 0).all()
    with raises(KeyError, match="did you mean `height`.*it has: .*height"):
        history["heigt"]
    for numbers in (run.measures, run.measure_units):
        with raises(KeyError, match="there is no measure `hight`; did you mean `height`"):
            numbers["hight"]
        assert pickle.loads(pickle.dumps(numbers)) == numbers == dict(numbers)
    with raises(KeyError, match="did you mean `plastic_strain`"):
        run.frames[-1]["plastic_strian"]
    frames = run.frames
    assert len(frames) == 5 and frames.times[2] == frames[2].time and frames[-1].step == run.summary["steps"]
    assert frames[0].spacings == [pytest.approx(1e-3)] and frames[0].bodies == ["plate"]
    assert frames.nearest("1.1 us").time == pytest.approx(1e-6) and len(frames[1:3]) == 2
    for index in (5, -6):
        with raises(IndexError, match=f"no frame {index}: its frames are from 0 to 4, or from -5 to -1"):
            frames[index]
    for time in (float("nan"), float("inf"), 10**400):
        with raises(ValueError, match="nearest|too large"):
            frames.nearest(time)
    with raises(IndexError, match="no frames"):
        frames[5:].nearest(0.0)
    with raises(IndexError, match="none yet"):
        frames[5:][0]
    # What limited steps is a text.
    reasons = history["dt_reason"]
    assert reasons.dtype.kind == "U" and len(reasons) == len(history["time"]) and set(reasons) <= {"sound-speed", "acceleration", "contact", "output"}
    stress = frames[-1]["stress"]
    assert stress.shape == (192, 6) and frames[-1].components("stress")[3] == "xy"
    assert frames[-1]["body"].dtype.kind == "u" and set(frames[-1]["body"]) == {0}


def test_a_run_that_is_printed_says_what_the_terminal_does(run):
    told = str(run).splitlines()
    assert told[0] == repr(run) == "<sphorge.Run 'a': completed>"
    for name, text in (("run", "reached its end time at 2 us"), ("work", "192 particles x"), ("energy drift", "%"), ("height", "mm"), ("memory", "as the engine counts it")):
        assert any(line.startswith(f"{name}  ") and text in line for line in told), (name, told)
    terminal = subprocess.run([sys.executable, "-m", "sphorge", "run", "a/deck.toml", "-o", "b", "--threads", "1"], capture_output=True, text=True).stdout
    drift = next(line for line in told if line.startswith("energy drift"))
    assert drift in terminal.splitlines()


def test_a_run_under_way_is_read(deck):
    simulation = sp.Simulation(deck, out="a", threads=1)
    next(simulation), next(simulation)
    run = sp.Run("a")
    assert run.status == "unfinished" and run.measures == {} and run.summary is None
    # The list of frames is written anew now and then; those that it does not have yet are there.
    assert len(run.frames) == 2 and len(run.history["time"]) >= 1
    assert str(run) == "<sphorge.Run 'a': unfinished>"
    simulation.run()
    assert run.status == "completed" and len(run.frames) == 5


def test_what_is_no_run_or_damaged_is_told(here, run):
    (here / "empty").mkdir()
    for place in ("none", "empty", "a/deck.toml"):
        with pytest.raises(sp.FolderError):
            sp.Run(place)
    with pytest.raises(TypeError):
        sp.Run(5)
    frame = run.frames[1]
    (run.folder / "fields/000001.vtp").write_bytes(b"<VTKFile>")
    with pytest.raises(sp.FolderError):
        frame["pressure"]
    with raises(sp.FolderError, match="000001.vtp"):
        run.frames[1]
    (run.folder / "history.csv").write_text("time,step\n1,2,3\n")
    with raises(sp.FolderError, match="history.csv"):
        run.history
    (run.folder / "history.csv").write_text("")
    with raises(sp.FolderError, match="history.csv.*empty"):
        run.history
    (run.folder / "deck.toml").write_bytes(b"\xff\x00")
    with raises(sp.FolderError, match="deck.toml is damaged"):
        run.deck
    (run.folder / "deck.toml").unlink()
    with raises(sp.FolderError, match="deck.toml"):
        run.deck
    (run.folder / "summary.json").write_text("{")
    with raises(sp.FolderError, match="summary.json"):
        run.status


def test_tables_are_those_of_other_packages(run):
    pandas = pytest.importorskip("pandas")
    frame = run.history.to_pandas()
    assert isinstance(frame, pandas.DataFrame) and frame.attrs["units"]["height"] == "m"
    assert frame["height"].iloc[-1] == run.measures["height"] and isinstance(frame["dt_reason"].iloc[-1], str)


def test_tables_are_those_of_polars(run):
    pytest.importorskip("polars")
    frame = run.history.to_polars()
    assert frame["height"][-1] == run.measures["height"] and frame["dt_reason"][-1] == run.history["dt_reason"][-1]


def test_particles_are_those_of_pyvista(run):
    pyvista = pytest.importorskip("pyvista")
    points = run.frames[-1].to_pyvista()
    assert points.n_points == 192 and points["stress"].shape == (192, 6)
    # In VTK's newer format, by VTK itself.
    points.save("last.vtkhdf")
    read = pyvista.read("last.vtkhdf")
    assert (read["stress"] == run.frames[-1]["stress"]).all() and (read.points == points.points).all()


def test_frames_are_a_dataset_of_xarray(run):
    pytest.importorskip("xarray")
    data = run.to_xarray(["pressure", "stress"])
    assert data["pressure"].dims == ("time", "particle") and data["pressure"].attrs["units"] == "Pa"
    assert data["stress"].sel(stress_component="xy").shape == (5, 192)


def test_runs_are_written_for_rerun(here, run):
    pytest.importorskip("rerun")
    file = run.to_rerun("a.rrd", "pressure")
    told = subprocess.run([sys.executable, "-m", "rerun", "rrd", "print", str(file)], capture_output=True, text=True, timeout=120)
    assert told.returncode == 0 and "/bodies/plate" in told.stdout and "/measures/height" in told.stdout, told.stderr
    with raises(KeyError, match="no field `presure`"):
        run.to_rerun("b.rrd", "presure")


def test_a_package_that_is_missing_is_named(run, monkeypatch):
    monkeypatch.setitem(sys.modules, "polars", None)
    with raises(ImportError, match="pip install polars"):
        run.history.to_polars()


def test_the_command_line_comes_with_the_package(here):
    def call(*arguments):
        return subprocess.run([sys.executable, "-m", "sphorge", *arguments], capture_output=True, text=True, timeout=120)

    assert call("--version").stdout.strip() == f"sphorge {sp.__version__}"
    done = call("run", "iron-plate", "--set", "particles.spacing=2.4 mm", "--set", "time.max-steps=20", "-o", "a")
    assert done.returncode == 0 and "20 steps" in done.stdout, done.stderr
    assert json.loads((here / "a/summary.json").read_text())["steps"] == 20
    assert call("plot", "a").returncode == 0 and list((here / "a/plots").glob("*.png"))
    wrong = call("run", "iron-plat")
    assert wrong.returncode == 2 and "did you mean" in wrong.stderr
    assert call("compare").returncode == 2
    swept = call("sweep", "iron-plate", "--vary", "particles.spacing=2.4 mm,3 mm", "--set", "time.max-steps=20", "-o", "s", "-j", "2")
    assert swept.returncode == 0 and (here / "s/sweep.csv").exists(), swept.stderr


def test_importing_takes_no_time():
    program = "import time; t = time.process_time(); import sphorge; print(time.process_time() - t)"
    fastest = min(float(subprocess.run([sys.executable, "-c", program], capture_output=True, text=True).stdout) for _ in range(3))
    assert fastest < 0.2, fastest


@pytest.mark.filterwarnings("ignore:the updated Lagrangian methods do not know")
def test_fragments_of_a_frame(deck):
    run = sp.Simulation(deck, out="a", threads=1).run()
    with pytest.warns(sp.SphorgeWarning, match="do not know the deformation"):
        fragments = run.frames[-1].fragments()
    assert fragments.count == 1 and list(fragments["body"]) == ["plate"] and list(fragments["particles"]) == [192]
    assert fragments["mass"][0] == pytest.approx(192e-6 * 7890.0, rel=1e-6) and fragments.units["mass"] == "kg/m"
    assert fragments["velocity"].shape == (1, 3) and -100.0 < fragments["velocity"][0, 1] < -50.0
    assert fragments["size"][0] == pytest.approx([24e-3, 8e-3, 0.0], rel=0.02) and fragments.loose == {"plate": 0.0}
    assert run.frames[0].fragments(least=193).count == 0 and run.frames[0].fragments(least=193).loose["plate"] > 1.0
    with raises(sp.SphorgeError, match="no body `plaet`") as slip:
        run.frames[0].fragments("plaet")
    assert "did you mean `plate`" in slip.value.hint
    with raises(sp.SphorgeError, match="a link of 0 spacings"):
        run.frames[0].fragments(link=0)
    with raises(TypeError, match="integer"):
        run.frames[0].fragments(least=1.5)
    with raises(OverflowError, match="negative"):
        run.frames[0].fragments(least=-1)
    with raises(KeyError, match="fragments have no `mas`"):
        fragments["mas"]
    frame = pytest.importorskip("pandas") and fragments.to_pandas()
    assert frame.attrs["units"]["spin_z"] == "rad/s" and frame["size_1"][0] == fragments["size"][0, 0]


def test_formats_that_there_are_not_are_told_with_those_that_there_are(deck):
    run = sp.Simulation(deck, out="a", threads=1).run()
    for given in ({"format": "mp4"}, {"format": "mp4", "column": ["height"]}, {"format": "PNG"}, {"format": 5}):
        with raises(sp.SphorgeError, match="there is no format `.*there are: png, svg, webp.*video of an animated PNG"):
            run.plot(None if "column" in given else "pressure", **given)
    for form in ("svg", "gif"):
        with raises(sp.SphorgeError, match=f"an animation has no format `{form}`; .*there are: png, webp"):
            run.plot("pressure", animate=True, format=form)
    # An animation may be asked for by the format that it has.
    assert run.plot("pressure", animate=True, format="png", frames=[0, 1]).data.count(b"fcTL") == 2
    assert run.plot("pressure", format="svg").data.startswith(b"<svg")


def test_the_picture_of_a_frame_of_heat_alone_is_of_the_temperature(deck):
    assert b"plastic strain" in sp.Simulation(deck, out="a", threads=1).run().frames[-1].plot(format="svg").data
    for k, key in enumerate(["mechanics", '"mechanics"']):
        text = f"""
            dimensions = "plane-strain"
            particles = {{ spacing = "1 mm" }}
            time = {{ end = "0.1 ms" }}
            thermal = {{ {key} = false }}
            [material.ofhc-copper]
            conductivity = 400
            [[body]]
            name = "plate"
            material = "ofhc-copper"
            shape = {{ box = {{ min = [0, 0], max = ["4 mm", "4 mm"] }} }}
        """
        picture = sp.Simulation(sp.Deck.from_text(text), out=f"heat{k}", threads=1).run().frames[-1].plot(format="svg").data
        assert b"temperature" in picture and b"plastic strain" not in picture
