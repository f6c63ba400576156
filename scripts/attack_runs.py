#!/usr/bin/env python3
"""Attacks a program by damaged and forged files of runs and by mutated decks, and says what it does of each.

    scripts/attack_runs.py damaged PROGRAM [COUNT [SEED]]
    scripts/attack_runs.py forged PROGRAM [COUNT [SEED]]
    scripts/attack_runs.py decks PROGRAM [COUNT [SEED]]

A fault is a panic, a signal, a hang, or a resumed run that says nothing and ends otherwise than the one that was not attacked. `damaged` changes, cuts
or lengthens one file of a run that was killed before its end, then resumes it. `forged` sets one value of its last checkpoint to a number, with right
CRC sums; every second one with a right SHA-256 sum, too. `decks` changes shipped decks and checks them. Each attack is printed that is a fault; the
exit code is 1 if there is one.
"""

import collections, hashlib, io, os, random, shutil, struct, subprocess, sys, tempfile, zipfile

DECK = """title = "Small plate on a wall"
dimensions = "plane-strain"
particles = { spacing = "2 mm" }
method = "METHOD"
search = "SEARCH"
time = { end = "2 us" }
output = { frames = 8, history-interval = "0.1 us" }

[[body]]
name = "plate"
material = "armco-iron"
shape = { box = { min = ["-4 mm", "0 mm"], max = ["4 mm", "12 mm"] } }
velocity = ["0 m/s", "-100 m/s"]

[[wall]]
name = "anvil"
plane = { point = ["0 mm", "0 mm"], normal = [0, 1] }

[[measure]]
name = "height"
extent = { body = "plate", axis = "y" }
"""
# What differs between two runs of the same deck.
OF_THE_RUN = {"summary.json", ".sphorge-lock", ".sphorge-run", "deck-found.toml"}


def run(program, *arguments, folder):
    try:
        ended = subprocess.run([program, *arguments], cwd=folder, capture_output=True, timeout=60)
    except subprocess.TimeoutExpired:
        return None, "", "hangs"
    told = ended.stdout.decode(errors="replace"), ended.stderr.decode(errors="replace")
    return ended.returncode, *told


def files(folder):
    found = {}
    for root, _, names in os.walk(folder):
        for name in names:
            path = os.path.join(root, name)
            found[os.path.relpath(path, folder)] = open(path, "rb").read()
    return found


def results(folder):
    return {name: data for name, data in files(folder).items() if name not in OF_THE_RUN and not name.startswith("checkpoint-")}


def prepare(program, place, method, search):
    """A run that has ended, and one as if killed in its midst, with two checkpoints."""
    deck = DECK.replace("METHOD", method).replace('search = "SEARCH"\n', f'search = "{search}"\n' if search else "")
    open(os.path.join(place, "plate.toml"), "w").write(deck)
    common = ["--threads", "1"]
    code, _, err = run(program, "run", "plate.toml", "-o", "whole", *common, folder=place)
    assert code == 0, err
    code, _, err = run(program, "run", "plate.toml", "-o", "half", "--checkpoint-interval", "0.4 us", *common, folder=place)
    assert code == 0, err
    # Checkpoints are of about 1.6 us and 2 us; what tells of the end goes.
    os.remove(os.path.join(place, "half", "summary.json"))
    return results(os.path.join(place, "whole"))


def attack(program, place, expected, change, kinds):
    """Resumes a copy of the half run that `change` has changed; returns what was wrong."""
    copy = os.path.join(place, "copy")
    shutil.rmtree(copy, ignore_errors=True)
    shutil.copytree(os.path.join(place, "half"), copy, symlinks=True)
    what = change(copy)
    code, out, err = run(program, "resume", "copy", "--threads", "1", folder=place)
    notes = [line for line in err.splitlines() if line.startswith("note:") and "continuing from" not in line]
    if code is None or code < 0 or "panicked" in err:
        kinds["hang, signal or panic"] += 1
        return f"{what}: code {code}, {err[-300:]}"
    if code != 0:
        kinds["refused"] += 1
        return None
    found = results(copy)
    differing = sorted(name for name in expected.keys() | found.keys() if expected.get(name) != found.get(name))
    if not differing:
        kinds["recognised, same results" if notes else "no matter, same results"] += 1
        return None
    if notes:
        kinds["named"] += 1
        unnamed = [name for name in differing if not any(name in note or "frames are missing" in note for note in notes)]
        return f"{what}: {unnamed} not named by {notes}" if unnamed else None
    kinds["used in silence"] += 1
    return f"{what}: {differing} differ in silence"


def damage(chance):
    def change(folder):
        names = sorted(files(folder))
        name = chance.choice(names)
        path = os.path.join(folder, name)
        data = bytearray(open(path, "rb").read())
        way = chance.choice(["flip", "flip", "flip", "cut", "append", "zero", "empty", "remove"])
        if way == "flip" and data:
            for _ in range(chance.choice([1, 1, 4])):
                data[chance.randrange(len(data))] ^= 1 << chance.randrange(8)
        elif way == "cut":
            del data[chance.randrange(len(data) + 1):]
        elif way == "append":
            data += chance.randbytes(chance.choice([1, 100]))
        elif way == "zero" and data:
            at = chance.randrange(len(data))
            data[at:at + 64] = bytes(len(data[at:at + 64]))
        elif way == "empty":
            data.clear()
        os.remove(path)
        if way != "remove":
            open(path, "wb").write(data)
        return f"{way} of {name}"
    return change


NUMBERS = [0.0, -1.0, 1.0, 1e300, -1e300, 1e30, -1e30, 1e-300, 5e-324, float("inf"), float("-inf"), float("nan"), 1e10, -1e10, 1e-10]
COUNTS = [0, 1, 2, 7, 1000, 1 << 31, 1 << 32, (1 << 53) + 1, 1 << 62, (1 << 64) - 1]


def sum_of(entries):
    total = hashlib.sha256()
    for name, data in entries:
        total.update(struct.pack("<Q", len(name)) + name.encode() + struct.pack("<Q", len(data)) + data)
    return total.hexdigest().encode()


def forge(chance, number):
    def change(folder):
        path = os.path.join(folder, max(name for name in os.listdir(folder) if name.startswith("checkpoint-")))
        with zipfile.ZipFile(path) as archive:
            entries = [(info.filename, archive.read(info)) for info in archive.infolist()]
        values = [k for k, (name, data) in enumerate(entries) if name.startswith("state/") and len(data) >= 1]
        k = chance.choice(values)
        name, data = entries[k][0], bytearray(entries[k][1])
        if len(data) >= 8 and len(data) % 8 == 0:
            value = chance.choice([struct.pack("<d", chance.choice(NUMBERS)), struct.pack("<Q", chance.choice(COUNTS))])
            at = 8 * chance.randrange(len(data) // 8)
        else:
            value = bytes([chance.randrange(256)])
            at = chance.randrange(len(data))
        data[at:at + len(value)] = value
        entries[k] = name, bytes(data)
        is_summed = number % 2 == 0
        if is_summed:
            entries = [(name, data) for name, data in entries if name != "sha256"]
            entries.append(("sha256", sum_of(entries)))
        with zipfile.ZipFile(path, "w", zipfile.ZIP_STORED) as archive:
            for entry in entries:
                archive.writestr(*entry)
        return f"{name} at {at} set to {value.hex()}, {'with' if is_summed else 'without'} its sum"
    return change


def attacks(kind, program, count, chance):
    kinds, faults = collections.Counter(), []
    variants = [("total-lagrangian", ""), ("updated-lagrangian", "adaptive"), ("updated-lagrangian", "skin"), ("updated-lagrangian", "every-step")]
    for number, (method, search) in enumerate(variants):
        with tempfile.TemporaryDirectory() as place:
            expected = prepare(program, place, method, search)
            for k in range(number, count, len(variants)):
                change = damage(chance) if kind == "damaged" else forge(chance, k // len(variants))
                of = kinds if kind == "damaged" else collections.Counter()
                fault = attack(program, place, expected, change, of)
                if kind == "forged":
                    kinds.update({f"{'with' if k // len(variants) % 2 == 0 else 'without'} sum: {word}": n for word, n in of.items()})
                # A number that is possible, with a right sum, is used: the sums do not protect from forgery.
                is_fault = fault and not (kind == "forged" and k // len(variants) % 2 == 0 and "panic" not in fault and "in silence" in fault)
                if is_fault:
                    faults.append(fault)
    return kinds, faults


WORDS = ["", "-", "1e400", "nan", "[", "]", "{", "}", '"', "0", "-1", "1e-320", "9" * 400, "true", "\x1b[31m", "\u202e", "é", "# ", "\n", " = ", "."]


def mutated(text, chance):
    for _ in range(chance.choice([1, 1, 2, 5])):
        way, at = chance.randrange(5), chance.randrange(len(text) + 1)
        lines = text.split("\n")
        line = chance.randrange(len(lines))
        if way == 0:
            text = text[:at] + chance.choice(WORDS) + text[at:]
        elif way == 1:
            text = text[:at] + text[at + chance.choice([1, 2, 8]):]
        elif way == 2:
            lines.insert(chance.randrange(len(lines)), lines[line])
            text = "\n".join(lines)
        elif way == 3:
            del lines[line]
            text = "\n".join(lines)
        else:
            pieces = lines[line].split(" ")
            pieces[chance.randrange(len(pieces))] = chance.choice(WORDS)
            lines[line] = " ".join(pieces)
            text = "\n".join(lines)
        if not text:
            text = "\n"
    return text


def decks(program, count, chance):
    kinds, faults = collections.Counter(), []
    with tempfile.TemporaryDirectory() as place:
        _, listed, _ = run(program, "decks", folder=place)
        names = [name for name in (line.split()[0].strip("│┆ ") if line.split() else "" for line in listed.splitlines()) if name.replace("-", "").isalnum()]
        shipped = []
        for line in listed.splitlines():
            for word in line.replace("│", " ").replace("┆", " ").split()[:1]:
                code, text, _ = run(program, "decks", word, folder=place)
                if code == 0:
                    shipped.append(text)
        shipped = shipped or [DECK]
        for k in range(count):
            text = mutated(chance.choice(shipped), chance)
            open(os.path.join(place, "deck.toml"), "w").write(text)
            limits = ["--set", 'particles.spacing="5 mm"'] if k % 2 else []
            code, out, err = run("bash", "-c", f"ulimit -v 4000000; exec {program} check deck.toml " + " ".join(f"'{a}'" for a in limits), folder=place)
            kinds[f"code {code}"] += 1
            if code not in (0, 1, 2) or "panicked" in err or any(c in out + err for c in "\x1b\u202e"):
                faults.append(f"deck {k}: code {code}: {err[-300:]!r}")
                open(f"/tmp/deck-{k}.toml", "w").write(text)
    return kinds, faults


def main():
    kind, program = sys.argv[1], os.path.abspath(sys.argv[2])
    count = int(sys.argv[3]) if len(sys.argv) > 3 else 200
    chance = random.Random(int(sys.argv[4]) if len(sys.argv) > 4 else 1)
    kinds, faults = decks(program, count, chance) if kind == "decks" else attacks(kind, program, count, chance)
    for word, number in sorted(kinds.items()):
        print(f"{number:6d}  {word}")
    for fault in faults:
        print("FAULT", fault)
    print(f"{len(faults)} faults")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
