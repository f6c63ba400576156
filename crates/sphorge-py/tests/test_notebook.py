"""Pictures, and what notebooks show."""

from __future__ import annotations

import base64
import os
import subprocess
import sys
import types
from pathlib import Path

import pytest
from conftest import raises

import sphorge as sp
from sphorge import _notebook

PNG = b"\x89PNG\r\n\x1a\n"
ROOT = Path(__file__).parents[3]


@pytest.fixture
def run(deck):
    return sp.Simulation(deck, out="a", threads=1).run()


def test_pictures_are_those_of_the_command_line(here, run):
    from test_simulation import command_line

    assert command_line("plot", "a", "--field", "pressure", "--frames", "first,last", "-o", "told.png").returncode == 0
    picture = run.plot("pressure", frames=["first", "last"])
    assert picture.data == (here / "told.png").read_bytes() == picture._repr_png_() and picture._repr_svg_() is None
    lines = run.plot(column=["height", "kinetic_energy"], format="svg")
    assert lines.data.startswith((b"<svg", b"<?xml")) and lines._repr_svg_() and lines._repr_png_() is None
    assert picture.save("own.png").read_bytes() == picture.data
    with raises(ValueError, match="does not end in .png"):
        picture.save("own.svg")
    # What was drawn for it is gone.
    assert {path.name for path in here.iterdir()} == {"a", "told.png", "own.png"}
    several = run.plot(where=["pressure > 0 Pa", "plastic_strain > 0.001"], field="pressure", section=False, range="0,1 GPa")
    assert several.data.startswith(PNG)


def test_the_usual_fields_end_with_those_of_what_breaks(here):
    from sphorge._picture import usual_fields

    assert usual_fields(here) == ("plastic_strain", "von_mises_stress", "pressure", "temperature", "velocity", "damage", "integrity")


def test_animations_are_png_or_webp(here, run):
    animation = run.plot("pressure", animate=True, width="300 px", duration="1 s")
    assert b"acTL" in animation.data[:200]
    image = pytest.importorskip("PIL.Image")
    with image.open(animation.save("a.webp")) as read:
        assert read.n_frames == 5 and read.format == "WEBP"
    assert (here / "a.webp").stat().st_size < len(animation.data)
    with image.open(run.plot("pressure").save("one.webp")) as read:
        assert getattr(read, "n_frames", 1) == 1
    whole = run.plot("pressure", animate=True, width="300 px", duration="1 s", format="webp")
    assert whole.save("b.webp").read_bytes() == (here / "a.webp").read_bytes() and "image/webp" in whole._repr_html_()
    with raises(ValueError, match="does not end in .webp"):
        whole.save("b.png")


def test_whether_there_is_pillow_is_looked_at_before_anything_is_drawn(run, monkeypatch):
    from sphorge import _sphorge

    monkeypatch.setitem(sys.modules, "PIL.Image", None)
    monkeypatch.setattr(_sphorge, "draw", lambda *_: pytest.fail("it was drawn"))
    with raises(ImportError, match="pip install pillow"):
        run.plot("pressure", animate=True, format="webp")


def test_keywords_that_there_are_not_are_named(run):
    with raises(TypeError, match="plot\\(\\) has no option `fieldd`; did you mean `field`\\? there are: .*section"):
        run.plot(fieldd="pressure")
    for wrong in ("output", "help", "quiett", "no-lock"):
        with raises(TypeError, match="has no option"):
            run.frames[-1].plot(**{wrong: 1})


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"field": "presure"}, "no field `presure`"),
        ({"field": "pressure", "view": "ab"}, "view"),
        ({"field": "pressure", "frames": 99}, "frames 0 to 4"),
        ({"column": "heigth"}, "no column `heigth`"),
        ({"field": "pressure", "dpi": "many"}, "`dpi` cannot be `many`"),
        ({"field": "pressure", "frames": ["all", "first"]}, "`frames=\"all\"` alone"),
        ({"field": "pressure", "dpi": 5}, "50"),
        ({"field": "pressure", "format": "pdf"}, "pdf"),
    ],
)
def test_what_cannot_be_drawn_is_told_as_by_a_terminal(here, run, options, told):
    with raises(sp.SphorgeError, match=told) as error:
        run.plot(**options)
    assert "\x1b" not in str(error.value)
    assert {path.name for path in here.iterdir()} == {"a"}


def embedded(page):
    return base64.b64decode(page.split("base64,")[1].split("'")[0])


def test_runs_frames_and_simulations_show_themselves(here, deck, run):
    page = run._repr_html_()
    assert "completed" in page and "height" in page and "0.02" in page and embedded(page) == run.frames[-1]._repr_png_()
    assert run.frames[0]._repr_png_().startswith(PNG) and run.frames[0]._repr_png_() != run.frames[-1]._repr_png_()
    deck["title"] = "<b>"
    simulation = sp.Simulation(deck, out="<b>", threads=1)
    next(simulation), next(simulation), next(simulation)
    page = simulation._repr_html_()
    assert "&lt;b&gt;" in page and "<b>" not in page and embedded(page).startswith(PNG)
    assert 0.4 < simulation.progress < 0.8
    # Also of a frame that the list of a run under way does not have yet.
    series = here / "<b>/fields.pvd"
    series.write_text("".join(line for line in series.read_text().splitlines(keepends=True) if "000001" not in line and "000002" not in line))
    frames = sp.Run("<b>").frames
    page = simulation._repr_html_()
    assert len(frames) == 3 and frames[-1].time == simulation.time and f"of the last frame, {simulation.time:.4g} s" in page
    assert embedded(page) == frames[-1]._repr_png_() != frames[0]._repr_png_()
    # Between two frames the table says which one it shows.
    time = simulation.time
    simulation.step()
    assert simulation.time > time and f"of the last frame, {time:.4g} s" in simulation._repr_html_()
    simulation.run()
    assert simulation.progress == 1.0 and "ended" in simulation._repr_html_()
    (here / "a/fields/000001.vtp").unlink()
    with pytest.raises(sp.FolderError):
        sp.Frame(here / "a/fields/000001.vtp")
    study = sp.sweep(deck, {"time.end": ["1 us"]}, out="s") if "time.end" not in deck else None
    assert study is None


def test_studies_show_their_table(deck):
    text = "\n".join(line for line in deck.text.splitlines() if not line.startswith("title"))
    study = sp.sweep(sp.Deck.from_text(text), {"body.plate.velocity.1": ["-50 m/s", "-60 m/s"]}, out="s")
    page = study._repr_html_()
    assert page.count("<tr>") == 3 and "height / m" in page and "completed" in page


class Shell:
    """Stands in for the kernel of a notebook."""

    shown: list[str]


def test_a_bar_shows_how_far_a_simulation_is_in_a_notebook(deck, monkeypatch):
    shown = []

    class ZMQInteractiveShell:
        pass

    class HTML:
        def __init__(self, data):
            self.data = data

    class Handle:
        def update(self, page):
            shown.append(page.data)

    def display(page, display_id):
        assert display_id is True
        shown.append(page.data)
        return Handle()

    notebook = types.ModuleType("IPython")
    notebook.get_ipython = ZMQInteractiveShell
    notebook.display = types.ModuleType("IPython.display")
    notebook.display.HTML, notebook.display.display = HTML, display
    monkeypatch.setitem(sys.modules, "IPython", notebook)
    monkeypatch.setitem(sys.modules, "IPython.display", notebook.display)
    assert _notebook.is_notebook()
    # Looked at after every step.
    monkeypatch.setattr(_notebook.Bar, "INTERVAL", 0.0)
    simulation = sp.Simulation(deck, out="a", threads=1)
    plain = sp.Simulation(deck, out="b", threads=1, progress=False)
    list(simulation), list(plain)
    assert len(shown) >= simulation.steps and "value='1.0000'" in shown[-1]
    assert (sp.Run("a").folder / "history.csv").read_bytes() == (sp.Run("b").folder / "history.csv").read_bytes()


def test_a_bar_on_a_terminal_is_one_line_at_its_end(deck, capsys):
    assert not _notebook.is_notebook()
    sp.Simulation(deck, out="a", threads=1).run()
    assert capsys.readouterr().err == ""
    sp.Simulation(deck, out="b", threads=1, progress=True).run()
    assert "100 %" in capsys.readouterr().err


def test_tables_are_written_as_parquet(here, deck):
    study = sp.sweep(deck, {"body.plate.velocity.1": [-50.0, -100.0], "search": ["skin", "every-step"]}, out="s", workers=2)
    file = study.to_parquet("s.parquet")
    assert file.read_bytes()[:4] == b"PAR1"
    command = [sys.executable, "-m", "sphorge", "sweep", f"s/{study.table['run'][0]}.toml", "--vary", "particles.spacing=2 mm,3 mm", "-o", "t", "--parquet", "t.parquet"]
    told = subprocess.run(command, capture_output=True, text=True)
    assert told.returncode == 0 and (here / "t.parquet").read_bytes()[:4] == b"PAR1", told.stderr
    polars = pytest.importorskip("polars")
    read = polars.read_parquet(file)
    assert read["height"].to_list() == study.table["height"].tolist() and read["status"].to_list() == study.table["status"]
    assert read["body.plate.velocity.1"].to_list() == [-50.0, -50.0, -100.0, -100.0] and read["search"].to_list() == ["skin", "every-step"] * 2
    assert read["steps"].to_list() == [run.summary["steps"] for run in study.runs] and read["run"].to_list() == study.table["run"]
    assert '"height":"m"' in polars.read_parquet_metadata(file)["units"]
    assert polars.read_parquet("t.parquet")["particles.spacing"].to_list() == [2e-3, 3e-3]
    # As others read it.
    pyarrow = pytest.importorskip("pyarrow.parquet")
    assert pyarrow.read_table(file).to_pydict() == read.to_dict(as_series=False)


def test_a_run_on_ranks_needs_a_package_with_mpi(here, deck):
    with raises(sp.SphorgeError, match="built without MPI") as error:
        sp.Simulation(deck, out="a", ranks=2)
    assert "threads" in error.value.hint
    for wrong in (0, -1, 1.5, "2", True):
        with raises(ValueError, match="ranks"):
            sp.Simulation(deck, out="a", ranks=wrong)
    assert os.listdir(here) == []


@pytest.fixture
def stand_in(here, monkeypatch):
    """Starts one process in place of many."""
    from sphorge import _sphorge

    folder = here / "bin"
    folder.mkdir()
    (folder / "mpirun").write_text('#!/bin/sh\n[ "$1" = -n ] && [ "$2" = 3 ] || exit 9\nshift 2\ntrap "kill -TERM $!" USR2\nexec "$@"\n')
    (folder / "mpirun").chmod(0o755)
    monkeypatch.setenv("PATH", f"{folder}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.setattr(_sphorge, "has_mpi", True)


@pytest.mark.skipif(os.name == "nt", reason="no such scripts")
def test_a_run_on_ranks_is_looked_at_frame_by_frame(here, deck, stand_in):
    from test_simulation import history

    simulation = sp.Simulation(deck, out="a", ranks=3, threads=1)
    with raises(sp.SphorgeError, match="a program of its own"):
        simulation.step()
    with raises(sp.SphorgeError, match="takes no loads"):
        simulation.load("plate")
    frames = list(simulation)
    assert [frame.step for frame in frames][0] == 0 and len(frames) == 5 and simulation.has_ended
    sp.Simulation(deck, out="b", threads=1).run()
    assert history(here / "a") == history(here / "b") and simulation.summary["status"] == "completed"
    deck["time.fixed-step"] = "1 us"
    with raises(sp.SphorgeError, match="fixed-step"):
        sp.Simulation(deck, out="c", ranks=3).run()
    with raises(sp.SphorgeError, match="overwrite=True"):
        sp.Simulation(deck, out="c", ranks=3).run()
    with pytest.raises(sp.DeckError):
        sp.Simulation(sp.Deck.from_text(deck.text.replace("armco", "armko")), out="d", ranks=3)


@pytest.mark.skipif(not (ROOT / "docs/notebooks").exists(), reason="only in the repository")
def test_notebooks_are_those_of_their_scripts():
    from test_simulation import subprocess

    assert subprocess.run([sys.executable, ROOT / "scripts/notebooks.py", "--check"]).returncode == 0
