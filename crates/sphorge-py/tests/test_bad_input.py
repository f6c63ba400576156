"""Whatever is given, what comes back is an exception that names it: never an abort, a panic, or a fault that is called ours."""

from __future__ import annotations

import itertools
import os
import random
import shutil
import signal
import subprocess
import sys
import threading
import types

import numpy as np
import pytest
from conftest import raises

import sphorge as sp
from sphorge import _sphorge

ODD = [
    None, True, -1, 0, 1, 2**70, -(2**63), 1.5, float("nan"), float("inf"), "", "a", "\0", "\ud800", "1 mm", "a.b.c", "x" * 5000, b"bytes", [], [1, 2], [None], ["a", 5],
    {}, {"a": 1}, {1: 2}, (), object(), int, np.zeros(3), np.array([np.nan]), np.array("a"), 1j, lambda *_: None,
]  # fmt: skip

#: What would draw, run or end more than a test should; each has tests of its own.
LEFT_OUT = {"main", "panic_for_tests", "STOP"}


def calls(function, random_numbers, count):
    """Calls with odd arguments, all of one, some of more; what they raised."""
    single = [((value,), {}) for value in ODD] + [((), {})]
    several = [(tuple(random_numbers.choices(ODD, k=random_numbers.randint(2, 10))), {}) for _ in range(count)]
    for arguments, named in itertools.chain(single, several):
        try:
            function(*arguments, **named)
        except Exception as error:  # noqa: BLE001 (which is what is looked at)
            assert type(error).__name__ != "PanicException" and not isinstance(error, (sp.InternalError, SystemError)), (function, arguments, error)
            assert str(error), (function, arguments)
        except BaseException as error:
            pytest.fail(f"{function} of {arguments!r} raised {type(error).__name__}: {error}")


@pytest.mark.filterwarnings("ignore")
def test_no_argument_makes_the_extension_module_panic(here):
    numbers = random.Random(1)
    for name in sorted(set(dir(_sphorge)) - LEFT_OUT):
        of = getattr(_sphorge, name)
        if callable(of) and not name.startswith("__"):
            calls(of, numbers, 40)
            for method in dir(of):
                if isinstance(of, type) and not method.startswith("__") and callable(getattr(of, method)):
                    calls(getattr(of, method), numbers, 10)


@pytest.mark.filterwarnings("ignore")
def test_no_argument_of_the_package_is_taken_for_what_it_is_not(here, deck):
    numbers = random.Random(2)
    for name in sorted(set(sp.__all__) - LEFT_OUT):
        of = getattr(sp, name)
        if isinstance(of, (type, types.FunctionType)) and not (isinstance(of, type) and issubclass(of, BaseException)):
            calls(of, numbers, 20)
    simulation = sp.Simulation(deck, out="mine", threads=1)
    run = sp.Run("mine")
    for of in (simulation.every, simulation.load, simulation.motion, simulation.state.__getitem__, run.plot, run.to_xarray, run.frames.nearest, deck.__setitem__, deck.copy().__getitem__):
        calls(of, numbers, 5)
    # None of it has touched the run.
    assert simulation.run().status == "completed"


def test_every_method_of_a_driver_refuses_odd_arguments(here, deck):
    simulation = sp.Simulation(deck, out="a", threads=1)
    numbers = random.Random(3)
    for method in ("read", "drive"):
        calls(getattr(simulation._driver, method), numbers, 30)
    # A drive of a wrong size is refused by the engine, which ends the run.
    simulation._driver.drive([[0.0, 0.0, 0.0]] * 7, [])
    with raises(sp.RunFailed, match="does not take"):
        simulation.run()
    assert sp.Run("a").status == "failed"


def test_a_table_of_particles_that_vanishes_is_named(here):
    shape = sp.particles([[0.5e-3, 0.5e-3], [1.5e-3, 0.5e-3]])
    body = {"name": "b", "material": "armco-iron", "shape": shape, "velocity": [1.0, 0.0]}
    deck = sp.Deck({"dimensions": "plane-strain", "particles": {"spacing": "1 mm"}, "time": {"end": "1 ns"}, "body": [body]})
    deck.check()
    shutil.rmtree(here / "out/particles")
    with raises(sp.DeckError, match="cannot be read"):
        deck.check()


def test_a_folder_that_vanishes_in_a_callback_is_an_exception(here, deck):
    simulation = sp.Simulation(deck, out="a", threads=1)

    @simulation.every(steps=3)
    def remove(state):
        shutil.rmtree(here / "a", ignore_errors=True)

    with pytest.raises(sp.FolderError):
        simulation.run()
    assert simulation.has_ended and not (here / "a").exists()


def test_a_folder_that_vanishes_under_a_study_is_told(here, deck):
    study = sp.sweep(deck, {"body.plate.velocity.1": [-50.0]}, out="s")
    run = study.runs[0]
    shutil.rmtree(here / "s")
    assert study.runs == [] and len(study) == 1
    for use in (lambda: run.history, lambda: run.frames, lambda: run.status, lambda: run.plot("pressure")):
        with pytest.raises(sp.SphorgeError):
            use()
    # Made again.
    assert sp.sweep(deck, {"body.plate.velocity.1": [-50.0]}, out="s").runs[0].status == "completed"


def failing(deck, kind, error, step):
    """A simulation of which a function raises from a step on."""
    text = deck.text + '\n[[region]]\nname = "grip"\nshape = { box = { min = ["-4 mm", "20 mm"], max = ["4 mm", "24 mm"] } }\n[[motion]]\nregion = "grip"\nvelocity = ["free", "0 m/s"]\n'
    simulation = sp.Simulation(sp.Deck.from_text(text), out="a", threads=1)

    def fail(state):
        if state.step >= step:
            raise error
        return None if kind == "every" else [0.0, 0.0]

    register = {"every": lambda: simulation.every(steps=1), "load": lambda: simulation.load("plate"), "motion": lambda: simulation.motion("grip")}
    register[kind]()(fail)
    return simulation


@pytest.mark.parametrize("error", [ValueError("mine"), KeyboardInterrupt(), SystemExit(3), GeneratorExit(), MemoryError()])
@pytest.mark.parametrize("kind", ["every", "load", "motion"])
def test_whatever_a_callback_raises_is_passed_on_and_the_files_are_whole(here, deck, kind, error):
    simulation = failing(deck, kind, error, 4)
    with pytest.raises(type(error)) as raised:
        simulation.run()
    assert raised.value is error
    run = sp.Run("a")
    assert run.status == "stopped" and run.summary["steps"] == 4 and list((here / "a").glob("checkpoint-*.zip"))
    assert len(run.history["time"]) >= 2 and run.frames[-1]["velocity"].shape == (192, 3)
    assert simulation.has_ended and simulation.step() is None


class Mute(Exception):
    """An exception that does not say what it is."""

    def __str__(self):
        raise RuntimeError("in str")


class Nameless:
    """A function whose name is none."""

    def __init__(self, name):
        self.name = name

    @property
    def __name__(self):
        if self.name is None:
            raise RuntimeError("no name")
        return self.name

    def __call__(self, state):
        raise ValueError("mine")


@pytest.mark.parametrize("kind", ["every", "load", "motion"])
@pytest.mark.parametrize(
    ("error", "told"),
    [(ValueError(os.fsdecode(b"r\xff.csv")), "ValueError: r\\udcff.csv"), (Mute(), "Mute"), (ValueError("\x1b[2J\0a"), "ValueError: \\x1b[2J\\x00a")],
)
def test_an_exception_that_cannot_be_told_ends_the_run_all_the_same(here, deck, kind, error, told):
    simulation = failing(deck, kind, error, 3)
    with pytest.raises(type(error)) as raised:
        simulation.run()
    assert raised.value is error and simulation.has_ended
    run = sp.Run("a")
    assert run.status == "stopped" and run.summary["stopped_by"].endswith(f"raised {told}"), run.summary["stopped_by"]
    assert sp.Simulation.resume("a", threads=1).steps == 3


@pytest.mark.parametrize("name", [None, "\udcff", 5])
def test_a_callback_whose_name_is_none_is_told_as_a_function(here, deck, name):
    simulation = sp.Simulation(deck, out="a", threads=1)
    simulation.every(steps=2)(Nameless(name))
    with raises(ValueError, match="mine"):
        simulation.run()
    assert "the callback `" in sp.Run("a").summary["stopped_by"]
    with pytest.raises(Mute), sp.Simulation(deck, out="b", threads=1) as left:
        left.step()
        raise Mute
    assert sp.Run("b").summary["stopped_by"] == "the program raised Mute"


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no forks")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_a_fork_with_loads_callbacks_and_studies_is_told(here, deck):
    simulation = sp.Simulation(deck, out="a", threads=2)
    simulation.load("plate")(lambda state: [0.0, 0.0])
    simulation.step()
    child = os.fork()
    if child == 0:
        code = 9
        try:
            for use in (simulation.step, simulation.run, simulation.stop, lambda: simulation.state["pressure"], lambda: next(simulation)):
                try:
                    use()
                except RuntimeError as error:
                    code = 0 if "fork" in str(error) else 2
                if code:
                    break
            # Pictures and studies of its own go on in the child all the same.
            if code == 0 and not sp.sweep(deck, {"body.plate.velocity.1": [-50.0]}, out="s").is_complete:
                code = 3
            if code == 0 and not sp.Run("s/body.plate.velocity.1=-50.0").plot("pressure").data:
                code = 4
        finally:
            os._exit(code)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    assert simulation.run().status == "completed"


def test_nothing_a_program_does_wrong_aborts_it(here, deck):
    (here / "plate.toml").write_text(deck.text)
    program = """
import sphorge as sp, threading, sys
s = sp.Simulation("plate.toml", out="a", threads=1)
s.every(steps=1)(lambda state: state["no such field"])
try: s.run()
except KeyError as error: print("told:", error)
t = sp.Simulation("plate.toml", out="b", threads=1)
keep = []
t.every(steps=1)(lambda state: keep.append(state))
t.run()
for state in keep[:2]:
    try: state["pressure"]
    except sp.SphorgeError as error: print("gone:", error)
del s, t
u = sp.Simulation("plate.toml", out="c", threads=1)
u.step()
threading.Thread(target=lambda: u.step(), daemon=True).start()
sys.exit(7)
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=120)
    assert done.returncode == 7 and "panicked" not in done.stderr and done.stdout.count("told:") == 1 and done.stdout.count("gone: this state") == 2, done


@pytest.fixture
def interruptible():
    """Ctrl-C is an exception, also where the tests run in the background of a shell."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("interruptible")
@pytest.mark.parametrize("how", ["step", "callback", "load"])
def test_ctrl_c_ends_a_run_wherever_it_comes(here, long_deck, how):
    for k in range(5):
        simulation = sp.Simulation(long_deck, out=f"{how}{k}", threads=1, progress=False)
        if how == "callback":
            simulation.every(steps=1)(lambda state: state["velocity"].sum() and None)
        elif how == "load":
            simulation.load("plate")(lambda state: [1.0, 0.0])
        press = threading.Timer(0.05 + 0.013 * k, os.kill, (os.getpid(), signal.SIGINT))
        press.start()
        with pytest.raises(KeyboardInterrupt):
            while how == "step":
                simulation.step()
            simulation.run()
        press.join()
        assert sp.Run(f"{how}{k}").status == "stopped"
