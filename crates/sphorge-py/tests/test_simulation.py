from __future__ import annotations

import copy
import functools
import gc
import os
import pickle
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
import warnings
import weakref
from pathlib import Path

import numpy as np
import pytest
from conftest import raises

import sphorge as sp
from sphorge import _sphorge


def command_line(*arguments):
    """The command line of the package."""
    return subprocess.run([sys.executable, "-m", "sphorge", *arguments], capture_output=True, text=True, timeout=120)


def history(folder):
    return (folder / "history.csv").read_bytes()


def test_frames_come_as_the_run_writes_them(here, deck):
    simulation = sp.Simulation(deck, out="a", threads=1)
    start = simulation.state["position"]
    assert simulation.particles == 192 and simulation.steps == 0 and not simulation.has_ended
    times, heights = [], []
    for frame in simulation:
        if not times:
            assert (frame.positions == start).all() and (frame["velocity"] == [0.0, -100.0, 0.0]).all()
        times.append(frame.time)
        y = frame.positions[:, 1]
        heights.append(y.max() - y.min())
        assert frame["velocity"].shape == (192, 3) and frame["pressure"].dtype == np.float32
        assert frame.units["pressure"] == "Pa" and frame.bodies == ["plate"] and frame.materials == ["armco-iron"]
    np.testing.assert_allclose(times, [0.0, 0.5e-6, 1e-6, 1.5e-6, 2e-6], rtol=1e-12, atol=0)
    assert heights[-1] < heights[0] and simulation.has_ended
    assert simulation.summary["status"] == "completed"
    # An array is one's own, and outlives the frame.
    pressure = frame["pressure"]
    pressure[:] = 1.0
    assert frame["pressure"].max() != 1.0
    with raises(KeyError, match="it has: .*velocity"):
        frame["presure"]
    assert list(simulation) == []


def test_a_run_is_that_of_the_command_line_to_the_bit(here, deck):
    (here / "plate.toml").write_text(deck.text)
    assert command_line("run", "plate.toml", "-o", "told", "-q").returncode == 0
    seen = []
    simulation = sp.Simulation(deck, out="driven", threads=1)

    @simulation.every(steps=1)
    def watch(state):
        seen.append(state["velocity"].copy())

    list(simulation)
    assert history(here / "told") == history(here / "driven") and len(seen) == simulation.steps
    for name in ("000002.vtp", "000004.vtp"):
        assert (here / "told/fields" / name).read_bytes() == (here / "driven/fields" / name).read_bytes()


def test_steps_are_taken_one_by_one(deck):
    simulation = sp.Simulation(deck, threads=1)
    first = simulation.state
    assert first["position"].shape == (192, 3) and first["speed"].max() == pytest.approx(100.0)
    assert (first["velocity"] == [0.0, -100.0, 0.0]).all() and first["stress"].shape == (192, 6)
    state = simulation.step()
    assert (state.step, simulation.steps) == (1, 1) and state.time == pytest.approx(state.dt) and state.dt > 0
    with raises(sp.SphorgeError, match="this state is gone"):
        first["position"]
    with pytest.raises(ValueError):
        state["position"][0] = 0.0
    with raises(KeyError, match="did you mean"):
        state["presure"]
    assert state["id"].dtype == np.uint32 and (state["id"] == np.arange(192)).all()
    count = 1
    while simulation.step():
        count += 1
    assert simulation.has_ended and simulation.step() is None
    assert simulation.summary["steps"] in (count, count + 1)
    with raises(RuntimeError, match="has ended"):
        simulation.state["position"]
    # Frames that nobody asked for are there.
    assert len(list(simulation)) == 5 and len(sp.Run(simulation.folder).frames) == 5


def test_callbacks_come_at_their_intervals_and_end_the_run(deck):
    simulation = sp.Simulation(deck, threads=1)
    steps, times = [], []

    @simulation.every(steps=5)
    def by_steps(state):
        steps.append(state.step)

    @simulation.every(time="0.3 us")
    def by_time(state):
        times.append(state.time)
        if state.time > 1e-6:
            return sp.STOP

    run = simulation.run()
    assert run.status == "stopped" and simulation.summary["end_reason"] == "program"
    assert simulation.summary["stopped_by"] == "the callback `by_time` returned sphorge.STOP"
    assert steps == list(range(5, steps[-1] + 1, 5))
    assert len(times) == 4 and all(k * 0.3e-6 <= t < k * 0.3e-6 + 0.1e-6 for k, t in enumerate(times, 1))
    # It goes on to where it would have ended, to the bit.
    resumed = sp.Simulation.resume(run.folder, threads=1)
    assert any("continuing from step" in note for note in resumed.notes)
    assert resumed.run().status == "completed"
    whole = sp.Simulation(deck, out="whole", threads=1).run()
    assert history(run.folder) == history(whole.folder)


def test_a_callback_that_raises_ends_the_run_with_whole_files(deck):
    simulation = sp.Simulation(deck, threads=1)

    class Own(Exception):
        pass

    @simulation.every(steps=7)
    def watch(state):
        raise Own("seven")

    with raises(Own, match="seven"):
        list(simulation)
    assert simulation.has_ended and simulation.summary["status"] == "stopped" and simulation.summary["steps"] == 7
    assert simulation.summary["end_reason"] == "program" and simulation.summary["stopped_by"] == "the callback `watch` raised Own: seven"
    run = sp.Run(simulation.folder)
    assert run.frames[-1].step == 7 and run.history["step"][-1] == 7
    assert not [name for name in os.listdir(run.folder) if "unfinished" in name]


def test_callbacks_cannot_drive_the_run_they_are_called_by(deck):
    simulation = sp.Simulation(deck, threads=1)
    raised = []

    @simulation.every(steps=3)
    def watch(state):
        for attempt in (simulation.step, simulation.run, simulation.stop, lambda: next(simulation)):
            with raises(sp.SphorgeError, match="callback"):
                attempt()
            raised.append(1)
        return sp.STOP

    simulation.run()
    assert len(raised) == 4


@pytest.mark.parametrize("kind", ["every", "load", "motion"])
@pytest.mark.parametrize("error", [StopIteration(5), StopAsyncIteration()])
@pytest.mark.parametrize("go", [list, sp.Simulation.run, sp.Simulation.step])
def test_a_callback_out_of_values_does_not_pass_for_the_end(deck, kind, error, go):
    text = deck.text + '\n[[region]]\nname = "grip"\nshape = { box = { min = ["-4 mm", "20 mm"], max = ["4 mm", "24 mm"] } }\n[[motion]]\nregion = "grip"\nvelocity = ["free", "0 m/s"]\n'
    simulation = sp.Simulation(sp.Deck.from_text(text), out="a", threads=1)

    def watch(state):
        raise error

    {"every": lambda: simulation.every(steps=1), "load": lambda: simulation.load("plate"), "motion": lambda: simulation.motion("grip")}[kind]()(watch)
    with raises(RuntimeError, match=f"{'`watch`' if kind == 'every' else '`plate`|`grip`'} raised {type(error).__name__}") as told:
        go(simulation)
    assert told.value.__cause__ is error and simulation.summary["end_reason"] == "program"
    assert type(error).__name__ in simulation.summary["stopped_by"]


def test_what_a_callback_returns_is_nothing_or_stop(deck):
    async def later(state):
        return None

    for number, (returned, shown) in enumerate([("stop", "'stop'"), (False, "False"), (0.0, "0.0"), ([], r"\[\]"), (sp.STOP.__class__, "_Stop"), (later, "coroutine")]):
        simulation = sp.Simulation(deck, out=f"{number}", threads=1)

        @simulation.every(steps=2)
        def watch(state, returned=returned):
            return returned(state) if returned is later else returned

        with raises(TypeError, match=f"the callback `watch` returned .*{shown}.*: it returns nothing, or sphorge.STOP"):
            simulation.run()
        assert simulation.has_ended and simulation.steps == 2


class Awaited:
    async def __call__(self, state):
        return None


class Given:
    def each(self, state):
        yield [0.0, 0.0]


def yielding(state):
    yield sp.STOP


async def awaited(state):
    return sp.STOP


async def both(state):
    yield sp.STOP


@pytest.mark.parametrize("call", [yielding, awaited, both, Awaited(), Given().each, functools.partial(awaited), functools.partial(functools.partial(yielding))])
def test_a_function_whose_call_executes_nothing_is_refused(deck, call):
    simulation = sp.Simulation(deck, threads=1)
    for what, register in (("every", simulation.every(steps=1)), ("load", simulation.load("plate"))):
        with raises(TypeError, match=rf"{what}\(\): `\w+` is (a generator function|asynchronous): a call of it executes nothing"):
            register(call)
    # Nothing of it was taken, and what calls them in its own way is.
    simulation.every(steps=1)(functools.wraps(yielding)(lambda state: None))
    assert simulation.run().status == "completed"


@pytest.mark.parametrize(
    "interval", [{"steps": 10**30}, {"time": 1e-320}, {"time": 10**400}, {"steps": np.int64(0)}, {"steps": np.float64(2)}, {}, {"steps": 1, "time": 1.0}, {"steps": 0}, {"steps": -1}, {"steps": 1.5}, {"steps": True}, {"time": 0}, {"time": float("nan")}, {"time": "1 mm"}, {"time": "soon"}]
)
def test_intervals_that_are_none_are_told(deck, interval):
    simulation = sp.Simulation(deck)
    with pytest.raises((ValueError, TypeError)):
        simulation.every(**interval)
    with pytest.raises(TypeError):
        simulation.every(steps=1)(None)
    called = []
    simulation.every(steps=np.int64(3))(lambda state: called.append(state.step))
    simulation.run()
    assert called[:2] == [3, 6]
    for late in (lambda: simulation.every(steps=1), lambda: simulation.load("plate")):
        with raises(sp.SphorgeError, match="the simulation has ended"):
            late()


def test_stop_is_the_same_wherever_it_comes_from():
    for again in (pickle.loads(pickle.dumps(sp.STOP)), copy.copy(sp.STOP), copy.deepcopy([sp.STOP])[0]):
        assert again is sp.STOP


def test_two_simulations_in_one_process_do_not_meet(here, deck):
    other = deck.copy()
    other["body.plate.velocity.1"] = "-50 m/s"
    first, second = sp.Simulation(deck, out="first", threads=1), sp.Simulation(other, out="second", threads=2)
    for one, two in zip(first, second, strict=True):
        assert one.time == pytest.approx(two.time)
    assert first.summary["measures"]["height"] < second.summary["measures"]["height"]
    alone = sp.Simulation(other, out="alone", threads=1).run()
    assert history(alone.folder) == history(here / "second")


def test_each_thread_can_drive_its_own(here, deck):
    ended = {}

    def drive(name):
        simulation = sp.Simulation(deck, out=name, threads=1)
        simulation.every(steps=1)(lambda state: print(state["velocity"].sum() * 0))
        ended[name] = simulation.run().status

    workers = [threading.Thread(target=drive, args=(name,)) for name in "abcd"]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert ended == dict.fromkeys("abcd", "completed")
    assert len({history(here / name) for name in "abcd"}) == 1


def test_a_simulation_that_its_own_callback_refers_to_is_let_go(long_deck):
    simulation = sp.Simulation(long_deck, out="a", threads=1)
    simulation.every(steps=2)(lambda state: print(simulation.steps))
    simulation.step()
    alive = weakref.ref(simulation)
    del simulation
    gc.collect()
    assert alive() is None and sp.Run("a").status == "stopped"


def test_a_deck_that_is_changed_during_its_run_changes_nothing(here, deck):
    simulation = sp.Simulation(deck, out="a", threads=1)
    next(simulation)
    deck["body.plate.velocity.1"] = "-10 m/s"
    deck["time.end"] = "1 us"
    assert simulation.run().history["time"][-1] == pytest.approx(2e-6)


def test_folders_in_the_way_are_told(here, deck):
    sp.Simulation(deck, out="a").run()
    with raises(sp.FolderError, match="exists already") as there:
        sp.Simulation(deck, out="a")
    assert "overwrite" in there.value.hint and isinstance(there.value, OSError)
    assert sp.Simulation(deck, out="a", overwrite=True).run().status == "completed"
    (here / "file").write_text("mine")
    for place in ("file", "file/run", "nul\0"):
        with pytest.raises((sp.FolderError, ValueError)):
            sp.Simulation(deck, out=place, overwrite=True)
    assert (here / "file").read_text() == "mine"
    busy = sp.Simulation(deck, out="busy")
    with raises(sp.FolderError, match="another run writes"):
        sp.Simulation(deck, out="busy", overwrite=True)
    assert busy.run().status == "completed"


def test_a_simulation_that_takes_no_step_is_in_nobodys_way(here, deck):
    for leave in (lambda simulation: simulation.stop(), lambda simulation: next(simulation), lambda simulation: None):
        simulation = sp.Simulation(deck, out="a", threads=1)
        leave(simulation)
        del simulation
        gc.collect()
        assert sp.Run("a").status == "stopped"
        with raises(sp.SphorgeError, match="has taken no step") as told:
            sp.Simulation.resume("a")
        assert "run the deck again" in told.value.hint
    # While it is there, it has the folder.
    begun = sp.Simulation(deck, out="a", threads=1)
    with raises(sp.FolderError, match="exists already"):
        sp.Simulation(deck, out="a")
    begun.step()
    begun.stop()
    # What has taken a step is not lost.
    with raises(sp.FolderError, match="exists already"):
        sp.Simulation(deck, out="a")
    assert sp.Simulation.resume("a", threads=1).run().status == "completed"


def test_the_summary_of_a_run_that_failed_is_there(deck):
    simulation = sp.Simulation(deck, out="a", threads=1)
    simulation.load("plate")(lambda state: [1e308, 0.0])
    with pytest.raises(sp.RunFailed):
        simulation.run()
    assert simulation.summary == sp.Run("a").summary and simulation.summary["status"] == "failed"


def test_a_program_may_go_to_another_folder(here, deck, monkeypatch):
    (here / "elsewhere").mkdir()
    deck["output.frames"] = 20
    simulation = sp.Simulation(deck, out="a", threads=1)
    frame = next(simulation)
    run = sp.Run("a")
    monkeypatch.chdir(here / "elsewhere")
    assert frame["velocity"].shape == (192, 3) and frame.plot("velocity").data
    assert len(run.frames) == 1 and run.status == "unfinished"
    # Half of it from here, and the rest after it was stopped.
    for _ in range(10):
        next(simulation)
    assert simulation.stop().folder == here / "a" == simulation.folder == run.folder
    monkeypatch.chdir(here)
    resumed = sp.Simulation.resume("a", threads=1)
    monkeypatch.chdir(here / "elsewhere")
    assert [frame.step for frame in resumed] and resumed.summary["status"] == "completed" == run.status
    assert len(run.frames) == 21 and os.listdir(here / "elsewhere") == []
    assert repr(resumed).startswith("<sphorge.Simulation in 'a': ended") and repr(run) == "<sphorge.Run 'a': completed>"
    study = sp.sweep(deck, {"time.end": ["0.2 us"]}, out="s")
    monkeypatch.chdir(here)
    assert [run.status for run in study.runs] == ["completed"] and study.folder == here / "elsewhere/s"


@pytest.mark.skipif(os.name == "nt", reason="a folder that is worked in stays")
def test_a_folder_to_work_in_that_is_gone_is_told(here, deck, monkeypatch):
    (here / "gone").mkdir()
    monkeypatch.chdir(here / "gone")
    (here / "gone").rmdir()
    for make in (lambda: sp.Simulation(deck, out="a"), lambda: sp.Run("a"), lambda: sp.Simulation.resume("a"), lambda: sp.sweep(deck, {"time.end": ["1 us"]})):
        with raises(sp.FolderError, match="works in is gone"):
            make()
    monkeypatch.chdir(here)


def test_a_folder_that_vanishes_is_an_exception_and_no_more(here, deck):
    simulation = sp.Simulation(deck, out="a", threads=1)
    frame = next(simulation)
    shutil.rmtree(here / "a")
    with pytest.raises(sp.FolderError):
        list(simulation)
    with pytest.raises(sp.FolderError):
        frame["pressure"]
    with pytest.raises(sp.FolderError):
        sp.Run("a")
    assert simulation.has_ended and list(simulation) == []


def test_a_run_that_breaks_down_says_where(deck):
    deck["time.fixed-step"] = "1 us"
    with raises(sp.RunFailed, match="fixed-step") as failed:
        sp.Simulation(deck, out="a").run()
    assert failed.value.step == 1 and failed.value.time == 0.0
    assert sp.Run("a").status == "failed"


def test_who_ended_a_run_is_told(deck):
    with pytest.raises(KeyError):
        with sp.Simulation(deck, out="a", threads=1) as simulation:
            simulation.step()
            {}["mine"]
    assert simulation.summary["end_reason"] == "program" and simulation.summary["stopped_by"] == "the program raised KeyError: 'mine'"
    with sp.Simulation(deck, out="b", threads=1) as simulation:
        simulation.step()
    assert simulation.summary["end_reason"] == "user" and "stopped_by" not in simulation.summary
    simulation = sp.Simulation(deck, out="c", threads=1)

    @simulation.every(steps=2)
    def interrupted(state):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        simulation.run()
    assert simulation.summary["end_reason"] == "user" and "stopped_by" not in simulation.summary
    resumed = sp.Simulation.resume("c", threads=1).run()
    assert resumed.summary["end_reason"] == "end-time" and "stopped_by" not in resumed.summary


def test_checks_of_the_run_are_warnings(deck):
    # Too coarse for its wall.
    deck["particles.spacing"] = "4 mm"
    simulation = sp.Simulation(deck, threads=1)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        run = simulation.run()
    assert any(issubclass(of.category, sp.SphorgeWarning) and "wall-energy" in str(of.message) for of in told)
    assert [name for name, _ in simulation.warnings] == [of["name"] for of in run.warnings] == ["wall-energy"]


def test_notes_of_the_deck_are_warnings_when_the_simulation_is_made(here, deck):
    deck["particles.spacing"] = "7 mm"
    with pytest.warns(sp.SphorgeNote, match="mass than its shape") as told:
        simulation = sp.Simulation(deck, out="a", threads=1)
    assert [str(of.message) for of in told] == simulation.notes == deck.check()["notes"]
    assert {of.filename for of in told} == {__file__} and issubclass(sp.SphorgeNote, sp.SphorgeWarning)
    simulation.step()
    simulation.stop()
    # They are told once.
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        sp.Simulation.resume("a", threads=1)


@pytest.mark.parametrize(
    "wrong", [{"threads": 0}, {"threads": -1}, {"threads": 1.5}, {"threads": "2"}, {"threads": True}, {"engine": "quantum"}, {"device": "nvidia"}, {"engine": None}, {"checkpoint_minutes": -1}, {"checkpoint_minutes": float("nan")}, {"out": 5}, {"overwrite": "yes"}]
)
def test_wrong_arguments_are_told_before_anything_is_written(here, deck, wrong):
    with pytest.raises((ValueError, TypeError, sp.SphorgeError)):
        sp.Simulation(deck, **{"out": "a", **wrong})
    assert os.listdir(here) == []


def test_a_simulation_that_is_left_saves_its_state(here, long_deck):
    for frame in sp.Simulation(long_deck, out="dropped", threads=1):
        if frame.step > 0:
            break
    assert sp.Run("dropped").status == "stopped"
    with sp.Simulation(long_deck, out="closed", threads=1) as simulation:
        next(simulation)
        next(simulation)
    assert sp.Run("closed").status == "stopped" and simulation.stop().status == "stopped"
    with pytest.raises(ZeroDivisionError):
        with sp.Simulation(long_deck, out="raised", threads=1) as simulation:
            simulation.step()
            1 / 0
    for name in ("dropped", "closed", "raised"):
        assert sp.Run(name).status == "stopped" and list((here / name).glob("checkpoint-*.zip"))
    # At the end of the interpreter, though it never lets go of it.
    program = (
        "import ctypes, sphorge as sp, sys; s = sp.Simulation(sys.argv[1], out='exit', threads=1); next(s); next(s);"
        "ctypes.pythonapi.Py_IncRef(ctypes.py_object(s._driver))"
    )
    (here / "long.toml").write_text(long_deck.text)
    assert subprocess.run([sys.executable, "-c", program, "long.toml"], timeout=60).returncode == 0
    assert sp.Run("exit").status == "stopped"


@pytest.mark.skipif(os.name == "nt", reason="no such signals")
@pytest.mark.parametrize("body", ["for frame in s: pass", "s.run()", "s.every(steps=1)(lambda state: None); s.run()", "while s.step(): pass"])
def test_ctrl_c_saves(here, long_deck, body):
    (here / "long.toml").write_text(long_deck.text)
    program = f"import sphorge as sp\ns = sp.Simulation('long.toml', out='a', threads=1)\n{body}\n"
    child = subprocess.Popen([sys.executable, "-c", program], stderr=subprocess.PIPE, text=True)
    while not (here / "a/fields/000002.vtp").exists():
        assert child.poll() is None
    child.send_signal(signal.SIGINT)
    _, told = child.communicate(timeout=60)
    assert "KeyboardInterrupt" in told and "panicked" not in told
    run = sp.Run("a")
    assert run.status == "stopped" and list((here / "a").glob("checkpoint-*.zip"))


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no forks")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_a_fork_is_told_that_the_simulation_is_not_its_own(deck):
    simulation = sp.Simulation(deck, threads=2)
    next(simulation)
    child = os.fork()
    if child == 0:
        code = 1
        try:
            simulation.step()
        except RuntimeError as error:
            code = 0 if "fork" in str(error) else 2
        # A run of its own goes on in the child all the same.
        if code == 0 and sp.Simulation(deck, out="child", threads=2).run().status != "completed":
            code = 3
        os._exit(code)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    assert simulation.run().status == "completed"


def test_one_thread_at_a_time_drives(long_deck):
    simulation = sp.Simulation(long_deck, threads=1)
    started = threading.Event()
    simulation.every(steps=1)(lambda state: started.set())
    worker = threading.Thread(target=lambda: [simulation.step() for _ in range(300)])
    worker.start()
    started.wait()
    refused = 0
    while worker.is_alive():
        try:
            simulation._driver.news()
        except RuntimeError as error:
            assert "another thread" in str(error)
            refused += 1
    worker.join()
    assert refused > 0
    simulation.stop()


def wait_for(condition):
    for _ in range(6000):
        if condition():
            return
        time.sleep(0.01)
    pytest.fail("it did not come in a minute")


@pytest.mark.parametrize("drive", [sp.Simulation.run, list, lambda simulation: [state for state in iter(simulation.step, None)]])
def test_another_thread_asks_a_run_to_end_and_sees_how_far_it_is(here, long_deck, drive):
    simulation = sp.Simulation(long_deck, out="a", threads=1)
    failed = []

    def work():
        try:
            drive(simulation)
        except BaseException as error:
            failed.append(error)

    worker = threading.Thread(target=work)
    worker.start()
    seen = []
    wait_for(lambda: simulation.steps > 20)
    for _ in range(3):
        seen.append((simulation.steps, simulation.time, simulation.progress))
        wait_for(lambda: simulation.steps > seen[-1][0])
    assert all(0 < step and 0.0 < at and share == pytest.approx(at / 50e-3, rel=0.5) for step, at, share in seen)
    assert sorted(seen) == seen and simulation.particles == 192 and "step 0," not in repr(simulation)
    assert simulation.stop().folder == here / "a"
    worker.join(60)
    assert not worker.is_alive() and failed == []
    assert simulation.has_ended and simulation.summary["status"] == "stopped" and simulation.summary["end_reason"] == "user"
    assert list((here / "a").glob("checkpoint-*.zip")) and simulation.stop().status == "stopped"


def test_a_thread_may_stop_what_another_one_is_between_two_frames_of(here, long_deck):
    for number in range(5):
        simulation = sp.Simulation(long_deck, out=f"{number}", threads=1)
        ended, at_work = [], threading.Event()

        def work(simulation=simulation, ended=ended, at_work=at_work):
            try:
                for frame in simulation:
                    at_work.set()
                ended.append("over")
            except BaseException as error:
                ended.append(error)

        worker = threading.Thread(target=work)
        worker.start()
        at_work.wait()
        time.sleep(0.001 * number)
        simulation.stop()
        worker.join(60)
        assert ended == ["over"] and simulation.summary["status"] == "stopped"


def test_the_end_of_the_interpreter_saves_what_a_daemon_thread_drives(here, long_deck):
    (here / "long.toml").write_text(long_deck.text)
    program = (
        "import sphorge as sp, threading, time\n"
        "s = sp.Simulation('long.toml', out='a', threads=1)\n"
        "threading.Thread(target={}, daemon=True).start()\n"
        "while s.steps < 20: time.sleep(0.01)\n"
    )
    for work in ("s.run", "lambda: list(s)"):
        made = subprocess.run([sys.executable, "-c", program.format(work)], capture_output=True, text=True, timeout=60)
        assert (made.returncode, made.stderr) == (0, "")
        assert sp.Run("a").status == "stopped" and list((here / "a").glob("checkpoint-*.zip"))
        shutil.rmtree(here / "a")


@pytest.mark.skipif(os.name == "nt", reason="no such signals")
@pytest.mark.parametrize(("body", "ended"), [("s.run()", "KeyboardInterrupt"), ("for frame in s: time.sleep(0.01)", "KeyboardInterrupt")])
def test_the_lines_of_the_documentation_save_at_sigterm(here, long_deck, body, ended):
    page = Path(__file__).parents[3] / "docs/python.md"
    if not page.exists():
        pytest.skip("only in the repository")
    lines = re.search(r"import signal\nsignal\.signal\(signal\.SIGTERM.*", page.read_text(encoding="utf-8")).group()
    (here / "long.toml").write_text(long_deck.text)
    program = f"import time\nimport sphorge as sp\n{lines}\ns = sp.Simulation('long.toml', out='a', threads=1)\n{body}\n"
    child = subprocess.Popen([sys.executable, "-c", program], stderr=subprocess.PIPE, text=True)
    wait_for(lambda: (here / "a/fields/000002.vtp").exists() or child.poll() is not None)
    child.terminate()
    _, told = child.communicate(timeout=60)
    assert ended in told and sp.Run("a").status == "stopped" and list((here / "a").glob("checkpoint-*.zip"))


def test_other_threads_run_while_steps_are_taken(deck):
    deck["particles.spacing"] = "0.2 mm"
    simulation = sp.Simulation(deck, threads=1)
    beats, done = [0], threading.Event()

    def beat():
        while not done.wait(0.001):
            beats[0] += 1

    worker = threading.Thread(target=beat)
    worker.start()
    _advanced = next(simulation), next(simulation)
    seen = beats[0]
    done.set()
    worker.join()
    simulation.stop()
    # A lock that is held for a frame would let none through.
    assert seen > 5, seen


@pytest.mark.parametrize("on_a_pool", [False, True])
def test_a_panic_becomes_an_exception(on_a_pool, capfd):
    with raises(sp.InternalError, match="this is a bug in Sphorge: a panic for tests"):
        _sphorge.panic_for_tests(on_a_pool)
    assert issubclass(sp.InternalError, Exception)


def test_what_is_given_in_a_wrong_way_is_told_with_the_right_one(here, deck):
    simulation = sp.Simulation(deck, out="a", threads=1)
    for register, how in ((simulation.every, r"@simulation.every\(steps=100\)"), (simulation.load, r'@simulation.load\("plate"\)'), (simulation.motion, "@simulation.motion")):
        with raises(TypeError, match=how):
            register(print)
    with raises(TypeError, match="by name"):
        simulation.every(5)
    simulation.step()
    simulation.stop()
    for wrong in ([("time.end", "3 us")], "time.end", {"time.end"}):
        with raises(TypeError, match="set is a dict of keys and their values, not (list|str|set)"):
            sp.Simulation.resume("a", wrong)


def test_a_resumed_run_takes_what_may_change_alone(here, deck):
    with raises(sp.SphorgeError, match="no-such|cannot read"):
        sp.Simulation.resume("no-such")
    sp.Simulation(deck, out="a", checkpoint_at_end=True, threads=1).run()
    with raises(sp.SphorgeError, match="has ended"):
        sp.Simulation.resume("a")
    with raises(sp.SphorgeError, match="particles.spacing"):
        sp.Simulation.resume("a", {"particles.spacing": "2 mm"})
    longer = sp.Simulation.resume("a", {"time.end": "3 us"}, threads=1)
    assert longer.time == pytest.approx(2e-6)
    assert longer.run().history["time"][-1] == pytest.approx(3e-6)
