#!/usr/bin/env python3
"""Runs the shipped decks as shipped to their end, and compares what comes out with the kept table `reference/shipped-decks.json`.

    check_decks.py PROGRAM [--jobs N] [--only NAME...] [--keep FOLDER]   run and compare; exit code 1 if anything differs
    check_decks.py PROGRAM --update [--jobs N] [--only NAME...]          run and write the table, and the numbers in the texts
    check_decks.py --texts                                               compare the texts and the gallery with the table alone

Compared are the status of a run, the names of its warnings, its steps and its measures. One rule holds for all: `relative` of the table, a
share of the kept number. A measure whose last bits decide has a band of its own under `bands`, with the reason, and a warning that
they decide is listed under `may_warn`; both are written by hand, and `--update` leaves them alone. Runs use one thread each, which does not
matter to their results.

Numbers in the texts that come from these runs stand before a comment that names them:

    3.28<!-- penetration: crater_diameter cm --> cm,  1.40<!-- penetration: cloud_length / cloud_width -->

A quoted number must be that of the table at its own number of digits. A block of what a run prints follows a comment that names the
deck, `<!-- output: iron-plate -->`; its measures and steps are those of the table.

Needs Python 3.9 and nothing else.
"""

import argparse
import json
import math
import os
import re
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
TABLE = ROOT / "reference/shipped-decks.json"
GALLERY = ROOT / "docs/guide/gallery.md"
TEXTS = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
# A run that takes longer, s, hangs.
TIME_LIMIT = 3600

# What a measure is by rounding where it is zero, in SI units, is less.
NOTHING = 1e-9

# Units of quotes: how many there are in one of SI, and where they begin.
UNITS = {"": 1.0, "mm": 1e3, "cm": 1e2, "um": 1e6, "ms": 1e3, "us": 1e6, "K": 1.0, "degC": 1.0, "m": 1.0, "m/s": 1.0, "ns": 1e9, "kPa": 1e-3, "MPa": 1e-6, "GPa": 1e-9, "kJ/kg": 1e-3, "MJ/kg": 1e-6}
ZERO = {"degC": -273.15}
QUOTE = re.compile(r"(?P<number>-?\d[\d ]*(?:\.\d+)?)(?P<bold>\**)<!-- (?P<deck>[\w-]+): (?P<what>\w+)(?: / (?P<over>\w+))?(?: (?P<unit>[\w/%]+))? -->")
# A block of what a run of a shipped deck prints.
OUTPUT = re.compile(r"(?P<start><!-- output: (?P<deck>[\w-]+) -->\n+```text\n)(?P<block>.*?)(?=^```$)", re.S | re.M)
MEASURE = re.compile(r"^(?P<name>\w+)(?P<gap> +)-?\d+(?:\.\d+)?(?: (?P<unit>[\w/]+))?$", re.M)
# What looks like one, so that one with a slip is not passed over.
LIKE_A_QUOTE = re.compile(r"<!-- [\w-]+: .*?-->")


def run(program, name, folder):
    """What the table has of a deck."""
    out = folder / name
    command = [program, "run", name, "-o", str(out), "--threads", "1", "--overwrite"]
    start = time.monotonic()
    ended = subprocess.run(command, capture_output=True, text=True, timeout=TIME_LIMIT)
    summary = json.loads((out / "summary.json").read_text()) if (out / "summary.json").exists() else {}
    found = {
        "status": summary.get("status", "did not start"),
        "warnings": sorted(warning["name"] for warning in summary.get("warnings", [])),
        "steps": summary.get("steps", 0),
        "measures": summary.get("measures", {}),
    }
    trouble = "" if ended.returncode == 0 else f"exit code {ended.returncode}: {ended.stderr.strip()[-600:]}"
    print(f"{name:24s} {found['status']:24s} {found['steps']:8d} steps {time.monotonic() - start:7.1f} s", flush=True)
    return found, trouble


def is_near(found, kept, share):
    """Whether a number is the kept one to a share of it; two that are nothing are equal."""
    if found is None or kept is None:
        return found == kept
    return math.isfinite(found) and (abs(found - kept) <= share * abs(kept) or max(abs(found), abs(kept)) <= NOTHING)


def differences(name, found, kept, table):
    """What is not as the table has it, a line for each."""
    may = set(kept.get("may_warn", []))
    for warning in sorted(set(found["warnings"]) - set(kept["warnings"]) - may):
        yield f"{name}: warns of `{warning}`, which it is not expected to"
    for warning in sorted(set(kept["warnings"]) - set(found["warnings"]) - may):
        yield f"{name}: does not warn of `{warning}`"
    if sorted(found["measures"]) != sorted(kept["measures"]):
        yield f"{name}: the measures are {sorted(found['measures'])}, kept are {sorted(kept['measures'])}"
    # What only warnings that may be or not be there decide is nothing else.
    if found["status"] != kept["status"] and not (may and {found["status"], kept["status"]} == {"completed", "completed with warnings"}):
        yield f"{name}: the status is `{found['status']}`, kept is `{kept['status']}`"
    bands = kept.get("bands", {})
    numbers = [("steps", found["steps"], kept["steps"])]
    numbers += [(of, found["measures"][of], value) for of, value in kept["measures"].items() if of in found["measures"]]
    for of, value, was in numbers:
        share = bands.get(of, table)["relative"]
        if not is_near(value, was, share):
            change = f" ({value / was - 1:+.2%}, allowed {share:.0%})" if value is not None and was else ""
            yield f"{name}: {of} is {value}, kept is {was}{change}"


def quoted(match, decks):
    """The number that a quote should have, as text; or what is wrong with it."""
    deck = decks.get(match["deck"])
    if deck is None:
        raise ValueError(f"the table has no deck `{match['deck']}`")
    numbers = deck["measures"] | {"steps": deck["steps"]}
    for of in filter(None, (match["what"], match["over"])):
        if numbers.get(of) is None:
            raise ValueError(f"`{match['deck']}` has no `{of}`")
    unit = match["unit"] or ""
    if unit not in UNITS:
        raise ValueError(f"no unit `{unit}`")
    value = numbers[match["what"]] / (numbers[match["over"]] if match["over"] else 1.0) * UNITS[unit] + ZERO.get(unit, 0.0)
    _, _, fraction = match["number"].partition(".")
    text = f"{value:.{len(fraction)}f}"
    return f"{int(text):,}".replace(",", " ") if " " in match["number"] else text


def shown(block, name, decks):
    """A block of what a run prints, with the numbers of the table: its measures, and how many steps there were."""
    deck = decks.get(name)
    if deck is None:
        raise ValueError(f"the table has no deck `{name}`")

    def measure(match):
        name, gap, unit = match["name"], match["gap"], match["unit"] or ""
        value = deck["measures"].get(name)
        if value is None or unit not in UNITS:
            return match[0]
        # As the program prints them.
        return f"{name}{gap}{value * UNITS[unit] + ZERO.get(unit, 0.0):.5g} {unit}".rstrip()

    steps = f"{deck['steps']:,}".replace(",", " ")
    def work(match):
        # At the speed that stands below it.
        seconds = float(match["seconds"]) * deck["steps"] / int(match["steps"].replace(" ", ""))
        return f"x {steps} steps in {seconds:.1f} s"

    block = MEASURE.sub(measure, block)
    block = re.sub(r"x (?P<steps>\d[\d ]*) steps in (?P<seconds>[\d.]+) s", work, block)
    return re.sub(r"^(100 %.* step )\d[\d ]*(?=,)", rf"\g<1>{steps}", block, flags=re.M)


def texts(decks, writes):
    """Compares the numbers in the texts with the table, or writes them; returns how many there are and what is wrong."""
    count, troubles = 0, []
    for path in TEXTS:
        text = path.read_text(encoding="utf-8")

        def of_table(match):
            nonlocal count
            count += 1
            place = f"{path.relative_to(ROOT)}:{text[:match.start()].count(chr(10)) + 1}"
            try:
                number = quoted(match, decks)
            except ValueError as wrong:
                troubles.append(f"{place}: {wrong}")
                return match[0]
            if number != match["number"] and not writes:
                troubles.append(f"{place}: {match['number']} is {number} in the table ({match['deck']})")
            return match[0].replace(match["number"], number, 1)

        def of_run(match):
            nonlocal count
            count += 1
            try:
                block = shown(match["block"], match["deck"], decks)
            except ValueError as wrong:
                troubles.append(f"{path.relative_to(ROOT)}: {wrong}")
                return match[0]
            for line, right in zip(match["block"].split("\n"), block.split("\n")):
                if line != right and not writes:
                    troubles.append(f"{path.relative_to(ROOT)}: `{line}` is `{right}` by the table ({match['deck']})")
            return match["start"] + block

        after = OUTPUT.sub(of_run, QUOTE.sub(of_table, text))
        for match in LIKE_A_QUOTE.finditer(OUTPUT.sub("", QUOTE.sub("", text))):
            troubles.append(f"{path.relative_to(ROOT)}: no number, or no name that is known, at {match[0]}")
        if writes and after != text:
            path.write_text(after, encoding="utf-8")
    return count, troubles


def gallery(decks, table):
    """Sections of the gallery whose runs, if they are at the resolution of the deck, are not those of the table."""
    for name, section in re.findall(r"^## ([\w-]+)\n(.*?)(?=^## |\Z)", GALLERY.read_text(encoding="utf-8"), re.S | re.M):
        kept, measured = decks.get(name), re.search(r"^Measured: (.*)\.$", section, re.M)
        if kept is None or measured is None or "**Coarser than shipped**" in section:
            continue
        numbers = re.findall(r"([a-z][^,]*?) (-?\d[\d.]*(?:e[-+]?\d+)?)(?: ([\w/^]+))?(?=,|$)", measured[1])
        told = {key.replace(" ", "_"): float(value) / UNITS.get(unit, 1.0) for key, value, unit in numbers}
        missing = sorted(set(kept["measures"]) - set(told) - {of for of, value in kept["measures"].items() if value is None})
        # To four digits.
        wrong = [f"{of} {value}" for of, value in told.items() if of in kept["measures"] and not is_near(value, kept["measures"][of], kept.get("bands", {}).get(of, table)["relative"] + 6e-4)]
        if missing or wrong:
            yield f"{GALLERY.relative_to(ROOT)}: {name} is not that of the table ({', '.join(wrong + missing)}): `scripts/gallery.py` makes it anew"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program", nargs="?", help="the binary")
    parser.add_argument("--update", action="store_true", help="write the table and the numbers in the texts")
    parser.add_argument("--texts", action="store_true", help="compare the texts alone")
    parser.add_argument("--only", nargs="+", default=[], metavar="NAME")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, metavar="N", help="runs at a time")
    parser.add_argument("--keep", type=Path, metavar="FOLDER", help="keep the folders of the runs there")
    arguments = parser.parse_args()
    table = json.loads(TABLE.read_text())
    decks, troubles = table["decks"], []

    if not arguments.texts:
        if not arguments.program:
            parser.error("name the program, or give --texts")
        shipped = sorted(path.stem for path in (ROOT / "decks").glob("*.toml"))
        unknown = sorted(set(table["too_long"]) - set(shipped)) + sorted(set(decks) - set(shipped)) + sorted(set(arguments.only) - set(shipped))
        if unknown:
            parser.error(f"no such deck: {', '.join(unknown)}")
        names = arguments.only or [name for name in shipped if name not in table["too_long"]]
        program = str(Path(arguments.program).resolve())
        with tempfile.TemporaryDirectory() as temporary, ThreadPoolExecutor(arguments.jobs) as pool:
            folder = arguments.keep or Path(temporary)
            folder.mkdir(parents=True, exist_ok=True)
            # The longest first.
            names.sort(key=lambda name: -decks.get(name, {}).get("steps", 0))
            results = dict(zip(names, pool.map(lambda name: run(program, name, folder), names)))
        for name, (found, trouble) in sorted(results.items()):
            if trouble:
                troubles.append(f"{name}: {trouble}")
            elif arguments.update:
                by_hand = {key: decks[name][key] for key in ("may_warn", "bands") if key in decks.get(name, {})}
                decks[name] = found | by_hand
            elif name not in decks:
                troubles.append(f"{name}: not in the table; `--update --only {name}` adds it")
            else:
                troubles += differences(name, found, decks[name], table)
        if arguments.update:
            table["decks"] = dict(sorted(decks.items()))
            TABLE.write_text(json.dumps(table, indent=2) + "\n")
    count, wrong = texts(decks, arguments.update)
    troubles += wrong
    troubles += gallery(decks, table)
    if not count:
        troubles.append("no number of the texts names where it comes from")
    print("\n".join(troubles) or f"{len(decks)} decks, {count} numbers in texts: as kept")
    return 1 if troubles else 0


if __name__ == "__main__":
    sys.exit(main())
