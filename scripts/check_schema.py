"""Looks whether the schema of decks says what decks are, by a validator that is not ours.

    python3 scripts/check_schema.py target/release/sphorge

The schema that `sphorge schema` prints must itself be right, accept every shipped deck, the decks of the tests that have every key and every
shape, and a deck with the whole catalogue of materials; it must refuse decks with a wrong key, word, type or length; and every example and
default that it gives of a key must be a value of that key. Ends with 1 and a list if not. Wants the package jsonschema.
"""

import copy
import json
import pathlib
import subprocess
import sys
import tomllib

import jsonschema

ROOT = pathlib.Path(__file__).resolve().parent.parent
DECK_CRATE = ROOT / "crates/sphorge-deck/src"


def read(path):
    return tomllib.loads(path.read_text(encoding="utf-8"))


def spoilt(deck):
    """Decks that are not right, each with what is wrong."""

    def with_change(what, change):
        other = copy.deepcopy(deck)
        change(other)
        return what, other

    yield with_change("a key that is none", lambda d: d["particles"].update(smothing=1.2))
    yield with_change("a word that is none", lambda d: d.update(search="never"))
    yield with_change("a key is missing", lambda d: d["time"].pop("end"))
    yield with_change("a vector of four", lambda d: d["wall"][0]["plane"].update(normal=[0, 1, 2, 3]))
    yield with_change("a table for a number", lambda d: d["particles"].update(spacing={}))


def properties(schema, path=""):
    """Every property of the schema with its place."""
    if isinstance(schema, dict):
        for name, inner in schema.get("properties", {}).items():
            if isinstance(inner, dict):
                yield f"{path}.{name}", inner
        for key, inner in schema.items():
            yield from properties(inner, f"{path}.{key}")
    elif isinstance(schema, list):
        for k, inner in enumerate(schema):
            yield from properties(inner, f"{path}.{k}")


def main():
    program = sys.argv[1]
    schema = json.loads(subprocess.run([program, "schema"], check=True, capture_output=True, text=True).stdout)
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)
    troubles = []

    tests = DECK_CRATE / "tests/decks"
    decks = {path.name: read(path) for folder in (ROOT / "decks", tests) for path in sorted(folder.glob("*.toml"))}
    flavour = decks["flavour.toml"]
    decks["flavour with the catalogue"] = flavour | {"material": read(DECK_CRATE / "material/catalogue.toml")}
    for name, deck in decks.items():
        troubles += [f"{name}: {error.message} at {error.json_path}" for error in validator.iter_errors(deck)]

    refused = 0
    for what, deck in spoilt(flavour):
        refused += 1
        if validator.is_valid(deck):
            troubles.append(f"accepted: {what}")

    values = 0
    for place, described in properties(schema):
        of_key = jsonschema.Draft202012Validator({**described, "$defs": schema.get("$defs", {})})
        for value in described.get("examples", []) + ([described["default"]] if "default" in described else []):
            values += 1
            if not of_key.is_valid(value):
                troubles.append(f"{place} cannot be {value}")
    if len(decks) < 20 or values < 200:
        troubles.append(f"only {len(decks)} decks and {values} values were looked at")

    print("\n".join(troubles) or f"{len(decks)} decks accepted, {refused} refused, {values} examples and defaults are values of their keys")
    return 1 if troubles else 0


if __name__ == "__main__":
    sys.exit(main())
