"""Loads, velocities and particles that a program gives."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from conftest import PLATE, raises

import sphorge as sp


@pytest.fixture
def free():
    """A plate at rest that nothing is near of, 192 particles. Balances to rounding are those of double precision."""
    body = dict(PLATE["body"][0], velocity=["0 m/s", "0 m/s"])
    own = {"body": [body], "method": "total-lagrangian", "numerics": {"precision": "double"}}
    return sp.Deck({key: value for key, value in {**PLATE, **own}.items() if key != "wall"}, name="free")


GRIP = """
[[region]]
name = "grip"
shape = { box = { min = ["-4 mm", "20 mm"], max = ["4 mm", "24 mm"] } }

[[motion]]
region = "grip"
velocity = ["free", "0 m/s"]
"""


def test_a_load_moves_a_body_by_its_mass_and_its_work_is_in_the_history(free):
    simulation = sp.Simulation(free, out="a", threads=1)
    mass = free.check()["bodies"]["plate"]["mass"]
    impulse = np.zeros(2)
    given = []

    @simulation.load("plate")
    def push(state):
        force = np.array([1e6, -4e11 * state.time])
        given.append((state.time, force))
        return force

    times = [0.0]
    while (state := simulation.step()) is not None:
        times.append(state.time)
        velocity = state["velocity"].mean(axis=0)
    impulse = sum(force * dt for (_, force), dt in zip(given, np.diff(times)))
    np.testing.assert_allclose(velocity[:2], (impulse / mass), rtol=1e-9)
    history = sp.Run("a").history
    assert history["external_work"][-1] == pytest.approx(0.5 * mass * (velocity**2).sum(), rel=1e-9)
    assert abs(history["energy_drift"]).max() < 1e-9 and simulation.warnings == []
    # Nothing else has done any.
    assert history["load_work"][-1] == pytest.approx(history["external_work"][-1], rel=1e-12)
    assert "loads of a program" in history.meanings["external_work"] and history.units["load_work"] == "J/m"


def call(*arguments):
    return subprocess.run([sys.executable, "-m", "sphorge", *arguments], capture_output=True, text=True)


def test_a_driven_run_says_so_wherever_it_is_looked_at(here, free):
    deck = sp.Deck.from_text(free.text + GRIP, name="gripped")
    assert "nothing moves" in deck.check()["notes"][0]
    simulation = sp.Simulation(deck, out="a", threads=1)
    simulation.load("plate")(lambda state: [1e6, 0.0] if state.step > 4 else [0.0, 0.0])
    simulation.motion("grip")(lambda state: [None, 0.0])
    run = simulation.run()
    # No note that nothing moves: something does.
    assert simulation.notes == []
    assert run.driven == {"loads": ["plate"], "motions": ["grip"]} == run.summary["driven"]
    assert repr(run) == "<sphorge.Run 'a': completed, driven by a program>"
    assert "by a program: load on `plate`; velocity of `grip`" in str(run) and "by a program" in run._repr_html_()
    assert "# A program gave loads or velocities to the run of this deck" in run.deck.splitlines()[0]
    assert run.deck.splitlines()[1:] == deck.text.splitlines()
    # By itself the deck is another run, which is told.
    checked = call("check", "a/deck.toml")
    assert checked.returncode == 0 and "without that program this is another run" in checked.stderr and "nothing moves" in checked.stderr
    alone = call("run", "a/deck.toml", "-o", "alone", "--threads", "1")
    assert alone.returncode == 0 and "without that program this is another run" in alone.stderr
    other = sp.Run("alone")
    assert other.driven is None and "driven" not in other.summary and "driven by" not in repr(other)
    compared = call("compare", "a", "alone").stdout
    # Narrow tables break lines.
    assert "driven" in compared and "velocity of" in compared
    row = next(line for line in compared.splitlines() if "peak memory  " in line)
    assert "–" in row and ("MB" in row or "kB" in row), row
    # Of a simulation that nobody drives the notes are those of the command line.
    plain = sp.Simulation(sp.Deck.from_text(run.deck, name="plain"), out="plain", threads=1)
    assert plain.notes == []
    plain.run()
    assert len(plain.notes) == 2 and "another run" in plain.notes[0] and "nothing moves" in plain.notes[1]


def test_what_is_broken_under_a_driver_names_it(deck):
    deck["warnings.compression"] = 1e-9
    simulation = sp.Simulation(deck, out="a", threads=1)
    simulation.load("plate")(lambda state: [1e6, 0.0])
    with pytest.warns(sp.SphorgeWarning, match="look at these, too"):
        run = simulation.run()
    assert "a program gives loads or velocities to this run" in run.warnings[0]["cure"]
    with pytest.warns(sp.SphorgeWarning) as told:
        run = sp.Simulation(deck, out="b", threads=1).run()
    assert "program" not in run.warnings[0]["cure"] and "program" not in str(told[0].message)


def test_that_a_run_was_driven_is_not_lost_where_it_goes_on(here, free):
    free["output.frames"] = 4
    whole = sp.Simulation(free, out="whole", threads=1)
    whole.load("plate")(lambda state: [1e6, 0.0])
    begun = sp.Simulation(free, out="a", threads=1)
    begun.step()
    # A state of before the first load.
    begun.load("plate")(lambda state: [1e6, 0.0])
    begun.step()
    begun.stop()
    assert sp.Run("a").driven == {"loads": ["plate"], "motions": []}
    again = sp.Simulation.resume("a", threads=1)
    again.load("plate")(lambda state: [1e6, 0.0])
    assert again.run().driven == {"loads": ["plate"], "motions": []}
    assert not any("deck" in note for note in again.notes), again.notes
    assert not (here / "a/deck-found.toml").exists() and sp.Run("a").deck.startswith("# A program gave")


def test_a_motion_is_prescribed_by_a_function(free):
    deck = sp.Deck.from_text(free.text + GRIP, name="gripped")
    simulation = sp.Simulation(deck, out="a", threads=1)

    @simulation.motion("grip")
    def pull(state):
        # As a controller would: until the plate is stretched.
        return [None, "20 m/s" if np.ptp(state["position"][:, 1]) < 23.015e-3 else 0.0]

    top = simulation.state["position"][:, 1] > 20e-3
    speeds = set()
    while (state := simulation.step()) is not None:
        velocity = state["velocity"][top, 1]
        assert np.ptp(velocity) == 0.0
        speeds.add(velocity[0])
    assert speeds == {0.0, 20.0}
    history = sp.Run("a").history
    assert history["external_work"][-1] > 0 and abs(history["energy_drift"]).max() < 1e-9


def test_a_driven_run_does_not_go_on_with_some_of_its_functions(here, free):
    other = dict(free["body"][0], name="other", shape={"box": {"min": ["40 mm", "0 mm"], "max": ["46 mm", "6 mm"]}})
    free["body"] = [*free["body"], other]
    begun = sp.Simulation(free, out="two", threads=1)
    for body in ("plate", "other"):
        # One of no size yet is one all the same.
        begun.load(body)(lambda state, size=1e6 * (body == "plate"): [size, 0.0])
    begun.step()
    begun.stop()
    again = sp.Simulation.resume("two", threads=1)
    again.load("plate")(lambda state: [1e6, 0.0])
    with raises(sp.SphorgeError, match="does not give the load on `other`"):
        again.run()
    again.load("other")(lambda state: [0.0, 0.0])
    assert again.run().status.startswith("completed")


def test_a_driven_run_goes_on_by_the_program_that_drives_it_alone(here, free):
    free["output.frames"] = 4

    def drive(simulation):
        simulation.load("plate")(lambda state: [1e6 * (1 + state.step % 3), 0.0])
        return simulation

    whole = drive(sp.Simulation(free, out="whole", threads=1)).run()
    broken = drive(sp.Simulation(free, out="broken", threads=1))
    for _ in range(7):
        broken.step()
    broken.stop()
    again = sp.Simulation.resume("broken", threads=1)
    with raises(sp.SphorgeError, match="a program gave loads") as refused:
        again.step()
    assert "@simulation.load" in refused.value.hint
    run = drive(again).run()
    for name in ("velocity_x", "kinetic_energy", "external_work"):
        if name in whole.history:
            assert run.history[name][-1] == whole.history[name][-1]
    stopped = drive(sp.Simulation(free, out="stopped", threads=1))
    stopped.step()
    stopped.stop()
    told = subprocess.run([sys.executable, "-m", "sphorge", "resume", "stopped"], capture_output=True, text=True)
    assert told.returncode != 0 and "a program gave loads or velocities" in told.stderr


@pytest.mark.parametrize(
    "given", [None, 5.0, [1.0], [1.0, 2.0, 3.0, 4.0], [float("nan"), 0.0], [float("inf"), 0.0], ["1 mm", 0.0], "1 N", [None, 0.0], [0.0, 0.0, 1.0], [True, 0.0], [[1.0], 0.0], {"x": 1.0}, np.zeros((2, 2)),
              [10**400, 0.0], ["\udcff", 0.0], bytearray(2), memoryview(b"ab"), [1j, 0.0]]  # fmt: skip
)
def test_a_load_that_is_none_ends_the_run_and_is_named(here, free, given):
    simulation = sp.Simulation(free, out="a", threads=1)
    simulation.load("plate")(lambda state: given)
    with raises((TypeError, ValueError), match="the load on `plate`"):
        simulation.run()
    assert sp.Run("a").status == "stopped" and simulation.has_ended


def test_what_cannot_be_driven_is_told(free):
    simulation = sp.Simulation(free, threads=1)
    with raises(sp.SphorgeError, match="no body `plat`") as wrong:
        simulation.load("plat")
    assert wrong.value.hint == "did you mean `plate`? there are: plate"
    with raises(sp.SphorgeError, match="has the region"):
        simulation.motion("grip")
    with pytest.raises(TypeError):
        simulation.load(5)
    with pytest.raises(TypeError):
        simulation.load("plate")(5)
    simulation.load("plate")(lambda state: sp.STOP)
    with raises(sp.SphorgeError, match="has one already"):
        simulation.load("plate")(lambda state: [0.0, 0.0])
    run = simulation.run()
    assert run.status == "stopped" and simulation.steps == 0 and run.summary["stopped_by"] == "the load on `plate` returned sphorge.STOP"


def test_a_load_that_raises_ends_the_run_with_its_files_whole(here, free):
    simulation = sp.Simulation(free, out="a", threads=1)

    @simulation.load("plate")
    def push(state):
        if state.step == 5:
            raise ZeroDivisionError("mine")
        with raises(ValueError, match="read-only"):
            state["velocity"][0, 0] = 1.0
        with raises(sp.SphorgeError, match="cannot drive"):
            simulation.step()
        return [1.0, 0.0]

    with raises(ZeroDivisionError, match="mine"):
        simulation.run()
    run = sp.Run("a")
    assert run.status == "stopped" and run.summary["steps"] == 5 and len(run.frames) >= 1
    assert run.summary["end_reason"] == "program" and run.summary["stopped_by"] == "the load on `plate` raised ZeroDivisionError: mine"
    assert "stopped by  " in str(run) and "ZeroDivisionError: mine" in str(run)


def points(n=8, spacing=1e-3):
    return (np.stack(np.meshgrid(np.arange(n), np.arange(n)), axis=-1).reshape(-1, 2) + 0.5) * spacing


def test_arrays_are_particles(here):
    places = points()
    velocities = np.stack([np.zeros(64), -100.0 * np.ones(64)], axis=1)
    body = dict(PLATE["body"][0], shape=sp.particles(places, volumes=1e-6, velocities=velocities), velocity=[0.0, 0.0])
    wall = [dict(PLATE["wall"][0], contact="penalty")]
    deck = sp.Deck(dict(PLATE, body=[body], wall=wall), name="cloud")
    assert deck.check()["bodies"]["plate"]["mass"] == pytest.approx(64e-6 * 7890.0)
    simulation = sp.Simulation(deck, out="a", threads=1)
    start = simulation.state
    assert set(map(tuple, start["position"][:, :2])) == set(map(tuple, places))
    assert (start["velocity"] == [0.0, -100.0, 0.0]).all()
    assert simulation.run().status == "completed"
    # The same arrays are the same file; the run finds it from anywhere.
    assert sp.particles(places, volumes=1e-6, velocities=velocities) == body["shape"] and len(list((here / "out/particles").iterdir())) == 1
    cells = sp.particles(places)
    assert sp.Deck(dict(PLATE, body=[dict(body, shape=cells)])).check()["bodies"]["plate"]["mass"] == pytest.approx(64e-6 * 7890.0)
    masses = sp.particles(places, masses=np.full(64, 7.89e-3))
    assert sp.Deck(dict(PLATE, body=[dict(body, shape=masses)])).check()["bodies"]["plate"]["mass"] == pytest.approx(64 * 7.89e-3)


def test_volumes_that_do_not_fit_the_spacing_are_told():
    def notes(volume):
        return sp.Deck(dict(PLATE, body=[dict(PLATE["body"][0], shape=sp.particles(points(), volumes=volume))])).check()["notes"]

    assert not any("stand for" in note for note in notes(1e-6))
    assert any("stand for 9.000e-6 m^2 each" in note for note in notes(9e-6))


def test_a_table_that_has_changed_is_told_where_the_run_goes_on(here):
    shape = sp.particles(points(), volumes=1e-6)
    deck = sp.Deck(dict(PLATE, body=[dict(PLATE["body"][0], shape=shape)]), name="listed")
    deck["time.max-steps"] = 4
    begun = sp.Simulation(deck, out="a", threads=1)
    begun.step()
    begun.stop()
    table = here / shape["table"]["file"]
    before = table.read_text()
    table.write_text(before.replace("1e-06", "1.5e-06"))
    with raises(sp.SphorgeError, match="the particles of `plate` in .* have changed") as told:
        sp.Simulation.resume("a", threads=1)
    assert table.name in str(told.value) and "bring the file back" in told.value.hint
    # Other words for the same particles are no change.
    table.write_text(before.replace("1e-06", "0.000001"))
    assert sp.Simulation.resume("a", threads=1).run().status.startswith("completed")


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ({"positions": [[0.0, np.nan]]}, "positions: the number of particle 0 is not finite"),
        ({"positions": [[0.0, 0.0], [0.0, np.inf]]}, "particle 1"),
        ({"positions": np.zeros((0, 2))}, "no particles"),
        ({"positions": np.ma.masked_array(points(), mask=np.arange(128).reshape(64, 2) > 63)}, "positions: particle 32 is masked"),
        ({"positions": points(), "masses": np.ma.masked_array(np.ones(64), mask=np.arange(64) == 3)}, "masses: particle 3 is masked"),
        ({"positions": points() + 0j}, "positions: these are not numbers: they are complex"),
        ({"positions": points(), "velocities": 1j * points()}, "velocities: these are not numbers: they are complex"),
        ({"positions": points().astype(str)}, "positions: these are not numbers: their type"),
        ({"positions": [[10**400, 0]]}, "positions: a number is too large"),
        ({"positions": [1.0, 2.0]}, "shape"),
        ({"positions": np.zeros((2, 4))}, "shape"),
        ({"positions": [["a", "b"]]}, "not numbers"),
        ({"positions": None}, "positions: an array"),
        ({"positions": [[0.0, 0.0], [0.0]]}, "not numbers"),
        ({"positions": np.zeros((3, 2))}, "particle 1 is where another one is"),
        ({"positions": points(), "volumes": np.ones(63)}, "volumes: there are 64 particles"),
        ({"positions": points(), "volumes": -1.0}, "volumes: that of particle 0 is not above zero"),
        ({"positions": points(), "volumes": np.ones((64, 1))}, "one number for each"),
        ({"positions": points(), "volumes": np.nan}, "volumes: the number of particle 0"),
        ({"positions": points(), "masses": 0.0}, "masses: that of particle 0"),
        ({"positions": points(), "volumes": 1.0, "masses": 1.0}, "one determines the other"),
        ({"positions": points(), "velocities": np.zeros((64, 3))}, "velocities: positions have the shape"),
        ({"positions": points(), "velocities": np.zeros(2)}, "velocities"),
        ({"positions": points(), "velocities": np.full((64, 2), np.nan)}, "velocities: the number of particle 0"),
    ],
)
def test_arrays_that_are_no_particles_are_named(here, arguments, told):
    with raises((ValueError, TypeError), match=told):
        sp.particles(**arguments)
    assert list(here.iterdir()) == []


def test_nothing_is_left_of_an_axis_that_the_deck_does_not_have():
    def check(**given):
        return sp.Deck(dict(PLATE, body=[dict(PLATE["body"][0], shape=sp.particles(**given))])).check()

    flat = np.concatenate([points(), np.zeros((64, 1))], axis=1)
    assert check(positions=flat, velocities=0.0 * flat)["particles"] == 64
    inclined, thrown = flat.copy(), np.zeros_like(flat)
    inclined[:, 2], thrown[:, 2] = inclined[:, 0], 100.0
    with raises(sp.DeckError, match="column `z`: the deck is plane strain"):
        check(positions=inclined)
    with raises(sp.DeckError, match="column `vz`: the deck is plane strain"):
        check(positions=flat, velocities=thrown)


def test_arrays_that_do_not_fit_the_deck_are_a_fault_of_the_deck():
    body = dict(PLATE["body"][0], shape=sp.particles([[0.0, 0.0, 0.0], [0.0, 0.0, 1.0]]))
    with pytest.raises(sp.DeckError):
        sp.Deck(dict(PLATE, body=[body])).check()


def test_steps_that_are_taken_back_are_driven_anew():
    """A block that strikes one at rest, where steps may change so little that some are repeated."""
    box = {"material": "ofhc-copper", "velocity": ["0 m/s", "0 m/s"]}
    hammer = {**box, "name": "hammer", "velocity": ["120 m/s", "0 m/s"], "shape": {"box": {"min": ["0 mm", "0 mm"], "max": ["6 mm", "6 mm"]}}}
    anvil = {**box, "name": "anvil", "shape": {"box": {"min": ["6.3 mm", "0 mm"], "max": ["12.3 mm", "6 mm"]}}}
    time = {"end": "6 us", "step-control": {"stretch": 0.002, "repeats": 4}}
    base = {"dimensions": "plane-strain", "particles": {"spacing": "1 mm"}, "numerics": {"precision": "double"}}
    deck = sp.Deck({**base, "time": time, "body": [hammer, anvil], "output": {"history-interval": "0.1 us"}}, name="strike")
    simulation = sp.Simulation(deck, out="a", threads=1)
    given, times, calls = {}, {}, []

    @simulation.load("hammer")
    def push(state):
        calls.append(state.step)
        times[state.step] = state.time
        given[state.step] = 1e6 * (state.step % 7 - 3) + 1e12 * state.time
        return [given[state.step], 0.0]

    run = simulation.run()
    assert any("is repeated" in note for note in simulation.notes) and len(calls) > len(given)
    # At the end it is asked once more.
    assert sorted(given) == list(range(simulation.steps + 1)) and times[simulation.steps] == simulation.time
    impulse = sum(given[step] * (times[step + 1] - times[step]) for step in range(simulation.steps))
    masses = [body["mass"] for body in deck.check()["bodies"].values()]
    momentum = run.history["momentum_x"]
    assert momentum[0] == pytest.approx(120.0 * masses[0], rel=1e-9)
    assert momentum[-1] - momentum[0] == pytest.approx(impulse, rel=1e-9) and impulse > 1.0
    assert abs(run.history["energy_drift"]).max() < 1e-9


def test_bodies_that_only_conduct_cannot_be_driven():
    simulation = sp.Simulation("heat-slab", threads=1)
    with raises(sp.SphorgeError, match="takes no loads") as error:
        simulation.load(simulation._bodies[0])
    assert "bodies can move" in error.value.hint
