#!/usr/bin/env python3
"""Runs the commands of the README and the guide, and holds what the pages show against what the program prints and computes.

    guide_runs.py PROGRAM [PAGE...]            compare; exit code 1 if anything differs
    guide_runs.py PROGRAM --write [PAGE...]    write what differs into the pages

The commands of a page (blocks `sh`) run in their order, on one processor, in a folder of the page's own. A block `text` behind them is what one of them
prints, errors and notes included. A line `...` in it leaves lines out. Numbers are compared to a thousandth or the last digit; times, speeds and memory
(VOLATILE) are not. They are not written either, without `--times`: the time of a run is then that of the new number of steps at the old speed. What takes
too long, needs a device, or serves until it is ended is not run (SKIPPED). Sentences about numbers are for people: read what differs.

Marks of a page, each an HTML comment that begins a line, but for the last:

    <!-- $ sphorge run rod.toml             commands that the page does not show, one a line; a block `text` behind them is their output
    $ sphorge run rod.toml -o out/b -->
    <!-- save rod.toml -->                  the block `toml` behind it is this deck, for all pages
    <!-- save quarter.toml from rod.toml -->   it is changes of that deck: tables that are added; keys below `# of the NAME` replace those of a body
    <!-- last row of out/rod -->            the block `text` behind it is the end of the history of a run
    <!-- not compared: REASON -->           the block `text` behind it is left alone
    <!-- table of out/a out/b: steps | lowest_point mm | - -->   each row of the table behind it is a run, and each column from the second on is of these
                                            expressions; `-` is left alone; several in a row or cell: `out/a+out/b`, `a.steps; b.steps`
    7.7<!-- out/a: rod_velocity -->         a number; of several runs, `out/a, out/b: 100 * (b.steps / a.steps - 1)`

An expression is one of Python of the columns at the end of the history of a run (`_` for a point in their names; `start.NAME` at the start), its `steps`,
`particles`, `repeated_steps` and `spacing`. A unit may stand behind it; the number keeps its digits behind the point. `check_decks.py` has the marks for
runs of shipped decks as shipped.

Needs Linux, bash, Python 3.9 and nothing else.
"""

import argparse
import csv
import json
import os
import queue
import re
import subprocess
import sys
import tempfile
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from itertools import zip_longest
from pathlib import Path
from types import SimpleNamespace

from check_decks import ROOT, UNITS, ZERO

GUIDE = re.findall(r"\((guide/[\w-]+\.md)\)", (ROOT / "docs/SUMMARY.md").read_text(encoding="utf-8"))
PAGES = ["README.md", *(f"docs/{page}" for page in GUIDE if not page.endswith("gallery.md")), "docs/warnings.md"]
# A command that takes longer, s, hangs.
TIME_LIMIT = 1800

# Commands that are not run: the first pattern that is found in one has the reason.
SKIPPED = [
    (r"^(?!sphorge )", "not of this program"),
    (r"\bbullet\b", "hours"),
    (r"\bballistic-limit\b", "an hour"),
    (r"\b(penetration|perforation)\b", "minutes; check_decks.py runs it as shipped"),
    (r"^sphorge validate(?!.* (--list|heat-slab))", "the validation is a job of its own"),
    (r"^sphorge bench\b", "speed"),
    (r"--engine gpu|--ranks", "devices and ranks"),
    (r"^sphorge view(?!.* -o )|--view$", "serves until it is ended"),
    (r"out/(my-)?run\b", "a run of the reader's own"),
    (r"^sphorge resume out/iron-plate\b", "a run that was stopped"),
]
# What differs from run to run.
NUMBER = r"-?\d+(?: \d{3})*(?:\.\d+)?(?:e[-+]?\d+)?"
TIME = rf"{NUMBER} (?:us|ms|s|min|h)\b(?: \d+ (?:s|min)\b)?"
VOLATILE = re.compile(
    rf"(?P<time>{TIME}(?= left)|(?<= in ){TIME}(?= on |$)|(?<=about ){TIME}(?= on ))"
    rf"|{NUMBER} (?:thousand |million )?particle-steps/s|(?<=\(){TIME}(?= per step\))"
    rf"|^memory +{NUMBER} .B$|(?<=┆) *{TIME} (?=│)|^│ (?:wall-clock|speed-up|time in|particle-steps|peak)\b.*"
)

MARKS = re.compile(
    r"^<!-- (?P<hidden>\$ .*?) -->$"
    r"|^<!-- save (?P<deck>[\w.-]+)(?: from (?P<base>[\w.-]+))? -->\n+```toml\n(?P<toml>.*?)^```$"
    r"|^<!-- last row of (?P<last>out/[\w-]+) -->$"
    r"|^<!-- not compared: (?P<reason>[^\n]*) -->\n+```text\n.*?^```$"
    r"|^```(?P<kind>\w*)[^\n]*\n(?P<block>.*?)^```$",
    re.S | re.M,
)
TABLE = re.compile(r"^<!-- table of (?P<runs>[^:]*): (?P<columns>.*?) -->\n+(?P<rows>(?:\|.*\n)+)", re.M)
VALUE = re.compile(rf"(?P<number>{NUMBER})(?P<bold>\**)<!-- (?P<runs>out/[^:>]*): (?P<of>[^>]*?) -->")
LIKE_A_MARK = re.compile(r"<!-- (?:\$|save|last row|table|out/).*?-->", re.S)


# ---- what commands print


def skeleton(line):
    """A line without its numbers, by which it is found again."""
    return " ".join(re.sub(r"[─═┄]+", "─", re.sub(NUMBER, "#", line)).split())


def settled(line):
    """A line without what differs from run to run, and without what only lines up columns."""
    line = re.sub("^expected steps .*", "~", VOLATILE.sub("~", line))
    return " ".join(re.sub(r"[─═┄]+", "─", line).split())


def alike(a, b):
    """Whether two lines are the same to a thousandth or the last digit of their numbers, and to rounding errors: other processors may print the other."""

    def near(x, y):
        p, q, last = float(x), float(y), 10.0 ** -len(y.partition(".")[2].partition("e")[0])
        return abs(p - q) <= max(1e-3 * abs(q), (1.01 * last if "e" not in y else 0.0), 1e-5 * (max(abs(p), abs(q)) < 1e-5))

    numbers = [[number.replace(" ", "") for number in re.findall(NUMBER, settled(line))] for line in (a, b)]
    return skeleton(settled(a)) == skeleton(settled(b)) and all(map(near, *numbers))


def resemblance(shown, printed):
    return sum(skeleton(a) == skeleton(b) for a, b in zip(shown, printed))


def cut(shown, printed):
    """The lines of what was printed that stand for those that are shown, between the same cuts; none if it has no such lines."""
    parts, found, begin = [[]], [], 0
    for line in shown:
        parts.append([]) if line == "..." else parts[-1].append(line)
    if len(parts) == 1:
        return printed
    for k, part in enumerate(parts):
        end = len(printed) - len(part)
        if part and 0 < k < len(parts) - 1:
            begin = max(range(begin, end + 1), key=lambda at: (resemblance(part, printed[at:]), -at), default=begin)
            if not resemblance(part, printed[begin:]):
                return []
        elif part and k > 0:
            begin = max(begin, end)
        found += ["..."] * (k > 0) + printed[begin : begin + len(part)]
        begin += len(part)
    return found


def with_times_of(old, new, share):
    """A new line with times, speeds and memory of the old one, if they are lines of the same; times of steps are those of a share of the steps."""
    spans = list(VOLATILE.finditer(old))
    same = [re.sub(r"\([\w-]+\)", "", skeleton(settled(line))) for line in (old, new)]
    if same[0] != same[1] or len(spans) != len(VOLATILE.findall(new)):
        return new

    def span(match):
        was = spans.pop(0)
        text = was[0]
        if was["time"] and re.fullmatch(rf"{NUMBER} \w+", text):
            number, unit = text.rsplit(" ", 1)
            text = f"{float(number.replace(' ', '')) * share:.{len(number.partition('.')[2])}f} {unit}"
        return text.rjust(len(match[0])) if new.endswith("│") else text

    return VOLATILE.sub(span, new)


def updated(shown, outputs, keeps_times):
    """The block of text by the output that resembles it most, and which it is; the block itself where only what differs from run to run does."""
    shown = shown.rstrip("\n").split("\n")
    cuts = [cut(shown, printed) for printed in outputs]
    best = max(reversed(cuts), key=lambda lines: resemblance(shown, lines))
    which = cuts.index(best)
    if not resemblance(shown, best):
        raise ValueError("no command before this block prints it")
    if [settled(line) for line in shown] == [settled(line) for line in best]:
        best = shown
    elif keeps_times and len(shown) == len(best):
        steps = [re.search(rf"(?:x|about) ({NUMBER}) (?:steps|to )", "\n".join(lines)) for lines in (best, shown)]
        share = float(steps[0][1].replace(" ", "")) / float(steps[1][1].replace(" ", "")) if all(steps) else 1.0
        best = [with_times_of(old, new, share) for old, new in zip(shown, best)]
    return "\n".join(best) + "\n", which


def last_row(run):
    """The end of a history, as the page of results shows it: the columns of the energies."""
    columns = {column["name"]: column["unit"] for column in json.loads((run / "history-columns.json").read_text())}
    *_, row = csv.DictReader((run / "history.csv").open())
    names = list(row)
    names = names[names.index("kinetic_energy") : names.index("energy_drift") + 1]
    return [f"{name:23s} {float(row[name]):.5g} {columns[name]}".rstrip() for name in names]


# ---- numbers of runs


def numbers(run):
    """What expressions may name of a run."""
    summary = json.loads((run / "summary.json").read_text())
    spacing = re.search(r'^spacing = "?([\d.e-]+) ?(\w*)"?', (run / "deck.toml").read_text(), re.M)

    def row(cells):
        return {name.replace(".", "_"): float(value) for name, value in cells.items() if re.fullmatch(NUMBER, value)}

    start, *_, end = map(row, csv.DictReader((run / "history.csv").open()))
    own = {key: summary[key] for key in ("steps", "particles", "repeated_steps")}
    return {**end, **own, "spacing": float(spacing[1]) / UNITS[spacing[2]], "start": SimpleNamespace(**start)}


def filled(text, expressions, runs, folder):
    """A text with its numbers replaced, one after the other, by those of the expressions."""
    of = [numbers(folder / run) for run in runs]
    names = {**of[0], **{"abcdefgh"[k]: SimpleNamespace(**one) for k, one in enumerate(of)}, "abs": abs, "max": max, "min": min}
    wanted = [expression.strip() for expression in expressions.split(";")]

    def number(match):
        if not wanted:
            return match[0]
        expression, _, unit = wanted[0].rpartition(" ")
        if not expression or unit not in UNITS:
            expression, unit = wanted[0], ""
        wanted.pop(0)
        value = eval(expression, {"__builtins__": {}}, names) * UNITS[unit] + ZERO.get(unit, 0.0)
        old = match[0]
        if "e" in old:
            return f"{value:.{len(old.partition('.')[2].partition('e')[0])}e}".replace("e-0", "e-")
        new = f"{value:,.{len(old.partition('.')[2])}f}"
        return new.replace(",", " " if " " in old or "." not in old else "")

    text = re.sub(NUMBER, number, text)
    if wanted:
        raise ValueError(f"no number for {'; '.join(wanted)}")
    return text


def table(match, folder):
    """A table with its columns filled."""
    head, rule, *rows = match["rows"].rstrip("\n").split("\n")
    runs, columns = match["runs"].split(), [column.strip() for column in match["columns"].split("|")]
    if len(runs) != len(rows):
        raise ValueError(f"{len(runs)} runs for {len(rows)} rows")
    lines = [head, rule]
    for run, row in zip(runs, rows):
        cells = row.split("|")
        if len(cells) < len(columns) + 3:
            raise ValueError(f"{len(columns)} columns for `{row}`")
        for k, column in enumerate(columns, 2):
            if "-" not in (run, column) and cells[k].strip():
                cells[k] = filled(cells[k], column, run.split("+"), folder)
        lines.append("|".join(cells))
    return match[0].replace(match["rows"], "\n".join(lines) + "\n")


# ---- pages


def changed(deck, changes):
    """A deck with changes: tables, or keys of bodies below `# of the NAME`."""
    parts = re.split(r"^# of the (\S+)\n", changes, flags=re.M)
    for name, keys in zip(parts[1::2], parts[2::2]):
        key = keys.split(" = ", 1)[0]
        own = re.search(rf'^name = "{name}"\n.*?^({key} = .*?)\n', deck, re.S | re.M)
        deck = deck[: own.start(1)] + keys.rstrip() + deck[own.end(1) :]
    return f"{deck.rstrip()}\n\n{parts[0]}" if parts[0].strip() else deck


def decks():
    """Decks that pages define."""
    found = {}
    texts = [(ROOT / page).read_text(encoding="utf-8") for page in PAGES]
    marks = [match for text in texts for match in MARKS.finditer(text) if match["deck"]]
    for match in sorted(marks, key=lambda match: match["base"] is not None):
        found[match["deck"]] = changed(found[match["base"]], match["toml"]) if match["base"] else match["toml"]
    return found


class Page:
    """A page, and what is found of it."""

    def __init__(self, name, folder, options):
        self.name, self.folder, self.options = name, folder, options
        self.text = (ROOT / name).read_text(encoding="utf-8")
        self.notes, self.differences, self.faults = [], [], []
        self.counts = Counter()
        # What was printed since the last block of commands that a page shows, and of these outputs the ones of commands that failed.
        self.outputs, self.failed = [], {}

    def command(self, line, place):
        """Runs a line, and keeps what it prints."""
        reason = next((reason for pattern, reason in SKIPPED if re.search(pattern, line)), None)
        if reason and not line.startswith("$ "):
            self.notes.append(f"{place}: not run ({reason}): {line}")
            return
        self.counts["commands"] += 1
        environment = {**os.environ, "PATH": f"{self.folder.parent}:{os.environ['PATH']}"}
        pipes = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.STDOUT}
        ended = subprocess.run(["bash", "-c", line.removeprefix("$ ")], cwd=self.folder, env=environment, timeout=TIME_LIMIT, **pipes)
        # Of the progress every tenth part: other lines come with time.
        lines = [part.rstrip() for part in ended.stdout.decode().rstrip("\n").split("\n")]
        self.outputs.append([part for part in lines if not re.match(r" *\d*[1-9] %  .* left, step ", part)])
        if ended.returncode:
            self.failed[len(self.outputs) - 1] = f"{place}: exit code {ended.returncode} of `{line}`: {self.outputs[-1][-3:]}"

    def begin(self):
        """Forgets what was printed: only commands whose output is shown may fail."""
        self.faults += self.failed.values()
        self.outputs, self.failed = [], {}

    def piece(self, match):
        """Does what a piece of a page asks for; the piece as it should be."""
        place = f"{self.name}:{match.string[: match.start()].count(chr(10)) + 1}"
        if match["hidden"] or match["kind"] == "sh":
            if not match["hidden"]:
                self.begin()
            lines = (re.sub(r"\s+# .*$", "", line).strip() for line in (match["hidden"] or match["block"]).split("\n"))
            for line in filter(None, lines):
                self.command(line, place)
        elif match["last"]:
            self.outputs.append(last_row(self.folder / match["last"]))
        elif match["kind"] == "text" and not self.outputs or match["reason"]:
            self.notes.append(f"{place}: a block is not compared: {match['reason'] or 'no command before it was run'}")
        elif match["kind"] == "text":
            self.counts["blocks"] += 1
            new, which = updated(match["block"], self.outputs, not self.options.times)
            self.failed.pop(which, None)
            self.begin()
            return match[0].replace(match["block"], new)
        return match[0]

    def fill(self, mark, text, new):
        """A text with the pieces that a mark finds as `new` makes them."""

        def of(match):
            place = f"{self.name}:{match.string[: match.start()].count(chr(10)) + 1}"
            try:
                right = new(match)
            except Exception as wrong:
                self.faults.append(f"{place}: {match[0][:160]}: {type(wrong).__name__}: {wrong}")
                return match[0]
            lines = [each.split("\n") for each in (match[0], right)]
            self.differences += [f"{place}: `{a}` is `{b}`" for a, b in zip_longest(*lines, fillvalue="") if not alike(a, b)]
            return right

        return mark.sub(of, text)

    def run(self):
        """Runs the commands, and then fills in tables and numbers."""

        def number(match):
            return match[0].replace(match["number"], filled(match["number"], match["of"], match["runs"].split(", "), self.folder), 1)

        self.folder.mkdir()
        (self.folder / "docs").symlink_to(ROOT / "docs")
        for deck, text in decks().items():
            (self.folder / deck).write_text(text, encoding="utf-8")
        text = self.fill(MARKS, self.text, self.piece)
        self.begin()
        text = self.fill(TABLE, text, lambda match: table(match, self.folder))
        text = self.fill(VALUE, text, number)
        self.counts |= Counter(tables=len(TABLE.findall(text)), numbers=len(VALUE.findall(text)))
        unknown = LIKE_A_MARK.findall(VALUE.sub("", TABLE.sub("", MARKS.sub("", text))))
        self.faults += [f"{self.name}: a mark that is not known: {mark}" for mark in unknown]
        if self.options.write and text != self.text:
            (ROOT / self.name).write_text(text, encoding="utf-8")
        print(f"{self.name}: " + ", ".join(f"{count} {what}" for what, count in self.counts.items()), flush=True)
        return self


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program", help="the binary")
    parser.add_argument("pages", nargs="*", default=PAGES, metavar="PAGE", help=f"by default {', '.join(PAGES)}")
    parser.add_argument("--write", action="store_true", help="write what differs into the pages")
    parser.add_argument("--times", action="store_true", help="and times, speeds and memory with them: on an idle machine")
    arguments = parser.parse_intermixed_args()
    names = [str(Path(page).resolve().relative_to(ROOT)) if Path(page).exists() else page for page in arguments.pages]
    if unknown := [name for name in names if name not in PAGES]:
        parser.error(f"no such page: {', '.join(unknown)}; there are {', '.join(PAGES)}")
    processors = queue.SimpleQueue()
    for processor in os.sched_getaffinity(0):
        processors.put(processor)

    def own_processor():
        # That of this thread, and so of all programs that it starts.
        os.sched_setaffinity(0, {processors.get()})

    with tempfile.TemporaryDirectory() as temporary, ThreadPoolExecutor(processors.qsize(), initializer=own_processor) as pool:
        (Path(temporary) / "sphorge").symlink_to(Path(arguments.program).resolve())
        pages = [Page(name, Path(temporary) / name.replace("/", "-")[:-3], arguments) for name in names]
        pages = list(pool.map(Page.run, pages))
    notes, differences, faults = ([line for page in pages for line in getattr(page, of)] for of in ("notes", "differences", "faults"))
    print("\n".join([*notes, *differences, *faults]))
    print(f"{len(differences)} lines differ{' and are written' if arguments.write else ''}, {len(faults)} faults")
    return 1 if faults or (differences and not arguments.write) else 0


if __name__ == "__main__":
    sys.exit(main())
