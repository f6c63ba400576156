from __future__ import annotations

import copy
import os
import pickle

import numpy as np
import pytest
from conftest import PLATE, raises

import sphorge as sp


def test_a_deck_is_a_name_a_path_a_dict_or_a_text(here, deck):
    assert sp.Deck("iron-plate")["body.bar.material"] == "armco-iron"
    (here / "own.toml").write_text(deck.text)
    for path in ("own.toml", here / "own.toml"):
        own = sp.Deck(path)
        assert own.name == "own" and own.check()["particles"] == 192
    assert sp.Deck.from_text(deck.text).check()["particles"] == 192
    checked = deck.check()
    assert checked["measures"] == ["height"] and checked["bodies"]["plate"]["particles"] == 192
    assert checked["bodies"]["plate"]["mass"] == pytest.approx(8e-3 * 24e-3 * 7890, rel=1e-9)
    assert "penetration" in sp.decks


def test_keys_are_set_and_read(deck):
    deck["particles.spacing"] = "2 mm"
    deck["body.plate.velocity.1"] = -50.0
    deck["body.0.temperature"] = np.float64(300.0)
    deck["output.fields"] = ["pressure", "velocity"]
    assert deck["particles.spacing"] == "2 mm" and deck["body.0.velocity"] == ["0 m/s", -50.0]
    assert deck["body.plate.temperature"] == 300.0 and deck["output.fields"] == ["pressure", "velocity"]
    assert "time.end" in deck and "time.courant" not in deck and 5 not in deck
    with raises(KeyError, match="courant"):
        deck["time.courant"]
    own = deck.copy()
    own["particles.spacing"] = "4 mm"
    assert deck["particles.spacing"] == "2 mm" and own["particles.spacing"] == "4 mm"


def test_a_copy_is_a_deck_of_its_own_however_it_is_made(here, deck):
    (here / "own.toml").write_text(deck.text)
    for own in (deck, sp.Deck(here / "own.toml"), sp.Deck("iron-plate")):
        own["time.end"] = "3 us"
        text = own.text
        for copied in (copy.copy(own), copy.deepcopy(own), pickle.loads(pickle.dumps(own)), copy.deepcopy({"deck": own})["deck"]):
            assert type(copied) is sp.Deck and (copied.name, copied.text) == (own.name, text)
            copied["time.end"] = "9 us"
            assert own["time.end"] == "3 us" and copied["time.end"] == "9 us"
            # What was set once can be set again.
            copied["time.end"] = "3 us"
            assert copied.text == text
    # A deck of a file has the text of when it was read.
    own = sp.Deck(here / "own.toml")
    packed = pickle.dumps(own)
    (here / "own.toml").write_text("")
    assert pickle.loads(packed).check() == own.check()


def test_a_text_that_is_none_is_named(deck):
    half = "bar \ud800"
    for make, named in [
        (lambda: deck.__setitem__("title", half), "`title`"),
        (lambda: deck.__setitem__(half, 1), "the key"),
        (lambda: sp.Deck({**PLATE, "title": half}), "`title`"),
        (lambda: sp.Deck({**PLATE, "body": [{**PLATE["body"][0], "name": half}]}), "`body.0.name`"),
        (lambda: sp.Deck(PLATE, name=half), "the name of the deck"),
        (lambda: sp.Deck.from_text(half), "the text of the deck"),
    ]:
        with raises(ValueError, match=f"{named}: character .* surrogates") as told:
            make()
        told.value.args[0].encode()


def test_faults_are_those_of_the_command_line(deck):
    with pytest.raises(sp.DeckError) as slip:
        deck["particles.spaceing"] = "1 mm"
    assert "unknown key `spaceing`" in str(slip.value) and slip.value.hint.startswith("did you mean `spacing`?")
    assert isinstance(slip.value, (sp.SphorgeError, ValueError))
    # It was not set.
    deck.check()
    wrong = sp.Deck.from_text(deck.text.replace('spacing = "1 mm"', 'spacing = "1 s"').replace("armco", "armko"))
    with pytest.raises(sp.DeckError) as faults:
        wrong.check()
    error = faults.value
    assert len(error.problems) == 2 and error.line == 1 + wrong.text[: wrong.text.index("spacing")].count("\n")
    assert "expected a length" in error.problems[0].message and "armco-iron" in error.problems[1].hint
    # As a terminal shows it, without colours.
    assert '"1 s"' in str(error) and "─" in str(error) and "\x1b" not in str(error)


@pytest.mark.parametrize("source", [None, 5, 1.5, b"iron-plate", ["iron-plate"], object()])
def test_what_is_no_deck_is_a_type_error(source):
    with pytest.raises(TypeError):
        sp.Deck(source)
    with pytest.raises(TypeError):
        sp.Simulation(source)


def test_what_is_not_there_is_told(here):
    with raises(sp.SphorgeError, match="there is no deck `iron-plat`") as missing:
        sp.Deck("iron-plat")
    assert "did you mean `iron-plate`" in missing.value.hint
    for path in ("none.toml", here, "a/b.toml", "nul\0.toml"):
        with pytest.raises((sp.DeckError, ValueError)):
            sp.Deck(path)
    (here / "bytes.toml").write_bytes(b"title = \"\xff\"")
    with raises(sp.DeckError, match="UTF-8"):
        sp.Deck("bytes.toml")
    with pytest.raises(sp.DeckError):
        sp.Deck.from_text("title = ").check()


@pytest.mark.parametrize(
    "value",
    [float("nan"), float("inf"), np.array([np.nan, np.nan]), np.array([[1.0, 2.0], [3.0, np.nan]]), [], {}, {"a": 1}, True, "", "\x1b[31m", "\ud800", -1e308],
)
def test_no_value_is_taken_for_what_it_is_not(deck, value):
    for key in ("particles.spacing", "body.plate.velocity", "time.end", "body.plate.shape"):
        changed = deck.copy()
        with pytest.raises(ValueError):
            changed[key] = value
            changed.check()


@pytest.mark.parametrize("value", [None, object(), {1: 2}, {1, 2}, b"1 mm", 1j, np.array(["a"]).dtype])
def test_values_that_decks_do_not_have_are_type_errors(deck, value):
    with pytest.raises(TypeError):
        deck["time.end"] = value
    with pytest.raises(TypeError):
        sp.Deck({"time": {"end": value}})


def test_keys_that_are_no_paths_are_told(deck):
    for key in ("", ".", "a..b", "body.9.velocity", "\0", "ü.ä", "x" * 10000):
        with pytest.raises(sp.DeckError):
            deck[key] = 1
        with pytest.raises(KeyError):
            deck[key]
    for key in (None, 5, b"time.end", ("time", "end")):
        with pytest.raises(TypeError):
            deck[key] = 1


def test_dicts_become_toml_that_reads_the_same(deck):
    odd = dict(PLATE, title='a "quoted" \\ \n \x7f ü 𝄞 text')
    assert sp.Deck(odd)["title"] == odd["title"]
    arrays = dict(PLATE, body=[dict(PLATE["body"][0], velocity=np.array([0.0, -100.0]), temperature=np.int64(300))])
    again = sp.Deck(arrays)
    assert again["body.0.velocity"] == [0.0, -100.0] and again["body.0.temperature"] == 300
    again.check()


def test_materials_have_constants_with_units():
    iron = sp.materials["armco-iron"]
    assert iron["constants"]["density"] == {"value": 7890.0, "unit": "kg/m^3", "symbol": "rho_0", "meaning": "density at rest"}
    assert iron["strength"]["key"] == "johnson-cook" and iron["strength"]["constants"]["A"]["unit"] == "Pa"
    assert "Patiño" in iron["reference"]
    assert sp.fields["pressure"][0] == "Pa"
    with raises(KeyError, match="did you mean `armco-iron`.*there are: .*armco-iron"):
        sp.materials["armco"]


@pytest.mark.parametrize("name", ["../../evil", "/evil", "a/b", "a\\b", ".", "..", "", "a\nb", "nul\0"])
def test_a_deck_is_not_called_what_no_folder_is(here, name):
    for make in (lambda: sp.Deck(PLATE, name=name), lambda: sp.Deck.from_text("", name=name)):
        with raises(ValueError, match="is no name of a deck: its output folder is called so"):
            make()
    for odd in (5, b"deck"):
        with raises(TypeError, match="the name of a deck is a text"):
            sp.Deck(PLATE, name=odd)


def test_a_file_that_is_called_what_no_folder_is_needs_another_one(here):
    # Its name without the ending is "..", the folder above.
    (here / "...toml").write_text(sp.Deck(PLATE).text)
    deck = sp.Deck("...toml")
    assert deck.name == ".."
    for make in (lambda: sp.Simulation(deck), lambda: sp.Simulation(deck, overwrite=True)):
        with raises(sp.SphorgeError, match=r"`\.\.` is no name of a folder.*out=\.\.\."):
            make()
    assert sorted(os.listdir(here)) == ["...toml"]
    assert sp.Simulation(deck, out="a", threads=1).run().status == "completed"


def test_the_text_of_a_deck_is_not_taken_for_a_path(here):
    text = sp.Deck(PLATE).text
    for of in (text, 'title = "Bar"', "title = 'a/b'"):
        with raises(sp.SphorgeError, match="this is a text, not the path of a deck.*sphorge.Deck.from_text\\(text\\) takes the text"):
            sp.Deck(of)
    assert sp.Deck.from_text(text).text == text and "from_text" in sp.Deck.__doc__
    # A path may look like it.
    (here / "a = 1").write_text(text)
    assert sp.Deck("a = 1").text == text


def test_tables_of_a_deck_are_found_wherever_the_program_goes(here, monkeypatch):
    (here / "elsewhere").mkdir()
    (here / "places.csv").write_text("x,y\n0.0005,0.0005\n0.0015,0.0005\n")
    body = {"name": "b", "material": "armco-iron", "shape": {"table": {"file": "places.csv"}}, "velocity": [1.0, 0.0]}
    (here / "own.toml").write_text(sp.Deck({"dimensions": "plane-strain", "particles": {"spacing": "1 mm"}, "time": {"end": "1 ns"}, "body": [body]}).text)
    deck = sp.Deck("own.toml")
    monkeypatch.chdir(here / "elsewhere")
    assert deck.check()["particles"] == pickle.loads(pickle.dumps(deck)).check()["particles"] == 2
    assert sp.Simulation(deck, out="a", threads=1).run().status == "completed"
