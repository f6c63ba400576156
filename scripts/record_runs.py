#!/usr/bin/env python3
"""Records the results of a `sphorge` binary, and compares two such records bit by bit.

    record_runs.py record BINARY OUT [--only NAME...] [--jobs N] [--set KEY=VALUE]...
    record_runs.py compare A [B] [--only NAME...]

`record` runs every shipped deck at a low resolution, and the variants of the table below, which cover features that no shipped
deck uses: each with every neighbour search, in mixed and in double precision, on one thread and on two. OUT, a new folder, gets
`index.json` and the files it names by the SHA-256 of their content: `history.csv` of each run, and all fields of its last frame
with the particles in order of `id`, independent of the order in which a program writes them. Values that depend on the clock
or on memory are left out. Frames have most fields in single precision; the history has sums over all particles, and one
particle with all its fields, in double precision. `--set` adds an override to every run, which shows that a comparison can fail.

`compare` reports which runs of A and B differ, where first and by how much, and whether one and two threads agree in each of
the two records; with A alone only the latter. A difference is relative to the largest value of its column or field. The exit
code is 1 if anything differs. Compare only records made on one machine: other processors may round differently.

Needs only Python 3.9.
"""

import argparse
import csv
import gzip
import hashlib
import io
import itertools
import json
import math
import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import time
import zlib
from array import array
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from xml.etree import ElementTree

SEARCHES = {
    "every-step": '"every-step"',
    "skin": '"skin"',
    "adaptive": '"adaptive"',
    "adaptive-published": '{ adaptive = { guard = "none" } }',
    "total-lagrangian": '"total-lagrangian"',
    "frozen": '{ total-lagrangian = { form = "frozen" } }',
}

# Rows of the history of a run; a run that takes longer than the limit, s, is stopped.
ROWS = 24
TIME_LIMIT = 120

# Fields of frames, beside the position, which is always there; the history has those that are no whole numbers of one particle.
WHOLE_FIELDS = ["id", "body", "material", "neighbors", "adapted", "last_searched"]
FIELDS = [
    "mass", "smoothing_length", "velocity", "speed", "acceleration", "density", "energy", "temperature", "pressure", "sound_speed",
    "deviator", "stress", "von_mises_stress", "velocity_gradient", "plastic_strain", "plastic_strain_increment", "yield_stress",
    "plastic_work",
]

# Entries of `summary.json` that depend neither on the clock nor on memory.
SUMMARY = [
    "status", "end_reason", "failure", "particles", "steps", "simulated_time", "precision", "mean_neighbors", "searched_fraction",
    "energy", "momentum_drift", "largest_momentum_drift", "audit", "measures", "warnings",
]

# Shipped decks: end of the run, s; the place, mm, of the particle the history follows; overrides.
DECKS = {
    "taylor-plate": (12e-6, (0.4, 0.9), "particles.spacing=0.6e-3"),
    "iron-plate": (12e-6, (0.4, 0.9), "particles.spacing=0.6365e-3"),
    "taylor-bar": (8e-6, (0.6, 0.2, 1.1), "particles.spacing=1.0e-3"),
    "taylor-bar-42crmo4": (20e-6, (0.5, 0.3, 1.0), "particles.spacing=0.81e-3"),
    "copper-bar": (30e-6, (0.6, 0.3, 1.0), "particles.spacing=0.94074e-3"),
    "high-shear": (20e-6, (1.3, 0.4), "particles.spacing=1.137e-3"),
    "penetration": (2.5e-6, (1.1, -0.5), "particles.spacing=0.8e-3"),
    "disc-on-plate": (2.5e-6, (0.3, 0.7), "particles.spacing=0.5e-3"),
    "tensile": (0.5e-3, (11, 6, 253), "particles.spacing=23.8095e-3", 'motion.1.velocity.2=[[0, 0], [0.2e-3, 10]]',
        "region.middle.shape.box={ min = [-0.015, -0.015, 0.24], max = [0.015, 0.015, 0.26] }"),
    "bullet": (0.1e-3, (7, 3, -8), "particles.spacing=15e-3", "body.bullet.spacing=12e-3",
        "body.plate.shape.box={ min = [-0.6, -0.03, -0.03], max = [0.6, 0.03, 0] }"),
    "perforation": (6e-6, (1.1, 0.7, -3), "particles.spacing=3e-3"),
    "plate-impact": (7.5e-6, (0.3,)),
    "elastic-plastic-piston": (8e-6, (6.1,), "particles.spacing=0.2e-3"),
    "homogeneous": (0.15e-3, (110, 70, 30), "particles.spacing=0.125"),
    "pulled": (0.02e-3, (0.3, 0.7), "particles.spacing=1e-3"),
    "elastic-bar": (10e-6, (3.1, 0.7, 0.3), "particles.spacing=0.54e-3"),
    "oscillating-plate": (15e-3, (101, 7), "particles.spacing=4e-3"),
    "rubber-rings": (60e-6, (-1.5, 3.1), "particles.spacing=2.5e-3"),
    "rotating-rod": (13e-3, (41, 7)),
    "heat-slab": (4.0, (3.1,), "particles.spacing=0.5e-3"),
    "two-materials": (1.0, (-0.7,)),
    "convecting-block": (40.0, (3.1, 9.2), "particles.spacing=4e-3"),
    "block": (25e-6, (3, 5, 9), "particles.spacing=5.8e-3"),
    "failure-strains": (80e-6, (0.2, 0.7, 0.3)),
    "weldox-tension": (0.05e-3, (3.1, 0.3, 0.8)),
    "notched-bars": (0.03e-3, (0.6, 1.2, 2.1), "particles.spacing=1e-3"),
    "spall": (1.6e-6, (2.3,), "particles.spacing=0.1e-3"),
    "taylor-fracture": (25e-6, (0.7, 1.6, 1.2), "particles.spacing=1.27e-3"),
    "crack-energy": (20e-6, (0.3, 3.1), "particles.spacing=0.5e-3"),
}

# Variants: a deck or another variant, and overrides.
VARIANTS = {
    "leapfrog": ("taylor-plate", "numerics.integrator=leapfrog"),
    "leapfrog-shear": ("high-shear", "numerics.integrator=leapfrog"),
    "leapfrog-penetration": ("penetration", "numerics.integrator=leapfrog", "numerics.energy-split=symmetric"),
    "predictor-corrector": ("taylor-bar", "numerics.integrator=predictor-corrector", "numerics.mls-interval=50"),
    "linear-gradient": ("leapfrog", "numerics.gradient-correction=linear"),
    "linear-gradient-3d": ("taylor-bar", "numerics.gradient-correction=linear"),
    "density-weighted": ("leapfrog", "numerics.pair-form=density-weighted"),
    "density-weighted-3d": ("taylor-bar", "numerics.pair-form=density-weighted"),
    "mixed-pair-form": ("taylor-plate", "numerics.pair-form=mixed"),
    "balsara": ("leapfrog-shear", "numerics.viscosity={ alpha = 1.0, beta = 2.0, balsara = true }"),
    "bare": ("leapfrog", "numerics.viscosity=false", "numerics.artificial-stress=false", "numerics.xsph=0.0"),
    "artificial-stress": ("rotating-rod", "method=updated-lagrangian", "numerics.gradient-correction=linear",
        "numerics.artificial-stress={ epsilon = 0.2, exponent = 6 }"),
    "xsph": ("plate-impact", "numerics.xsph=0.3", "numerics.artificial-stress=true"),
    "mls": ("taylor-plate", "numerics.mls-interval=60"),
    "temperature-from-energy": ("disc-on-plate", "numerics.temperature=energy",
        "material.aluminium-pysph-plate.specific-heat=875", "material.steel-pysph-disc.specific-heat=460"),
    "follow-density": ("leapfrog-penetration", "numerics.smoothing-length=follow-density"),
    "follow-density-1d": ("plate-impact", "numerics.smoothing-length={ follow-density = { factor = 1.1 } }"),
    "follow-density-3d": ("taylor-bar", "numerics.smoothing-length=follow-density", "particles.smoothing=1.3"),
    "wendland-c2": ("leapfrog", "numerics.kernel=wendland-c2", "particles.smoothing=1.6"),
    "wendland-c4": ("leapfrog", "numerics.kernel=wendland-c4", "particles.smoothing=1.7"),
    "quintic-spline": ("leapfrog", "numerics.kernel=quintic-spline"),
    "wendland-c2-3d": ("taylor-bar", "numerics.kernel=wendland-c2"),
    "wendland-c4-3d": ("copper-bar", "numerics.kernel=wendland-c4", "time.end=12e-6"),
    "quintic-spline-1d": ("elastic-plastic-piston", "numerics.kernel=quintic-spline"),
    "penalty-contact": ("disc-on-plate", "contact=penalty"),
    "friction-contact": ("bullet", "contact={ penalty = { stiffness = 2.0, damping = 0.5, friction = 0.2 } }"),
    "friction-wall": ("leapfrog", "wall.anvil.contact={ penalty = { friction = 0.3 } }", "body.plate.velocity=[60, -200]"),
    "moving-wall": ("taylor-bar", "wall.anvil.velocity=[0, 5, [[0, 0], [4e-6, 80]]]"),
    "segment-wall": ("leapfrog", 'wall=[{ name = "edge", segment = { from = [-0.002, 0], to = [0.0022, -0.0003] } }]'),
    "symmetry": ("leapfrog", "body.plate.shape.box.min=[0, 0]", 'symmetry=[{ axis = "x" }, { axis = "y" }]', "wall=[]"),
    "negative-symmetry": ("disc-on-plate", 'symmetry=[{ axis = "y", side = "negative" }]', "body.plate.shape.box.max=[0.002, 0]",
        "body.disc.shape={ intersection = [{ disc = { centre = [-0.005, 0], radius = 0.005 } }, "
        "{ box = { min = [-0.011, -0.006], max = [0.001, 0] } }] }"),
    "periodic": ("leapfrog-shear", "periodic.x=[-0.012507, 0.012507]"),
    "periodic-heat": ("convecting-block", "periodic.y=[0, 0.08]"),
    "periodic-3d": ("block", "periodic={ x = [0, 0.058], y = [0, 0.058] }", 'body.block.velocity-profile={ along = "x", '
        "amplitude = [90, 40, 0], rows = [[0, 0.0], [0.029, 1.0], [0.058, 0.0]] }"),
    "gravity": ("taylor-bar", "gravity=[1e5, 0, -2e6]", "numerics.xsph=0.0"),
    "heat-in-motion": ("leapfrog", "material.armco-iron.conductivity=2e4",
        'region=[{ name = "tail", shape = { box = { min = [-0.004, 0.024], max = [0.004, 0.026] } } }]',
        'thermal={ boundary = [{ name = "air", convection = { coefficient = 2e6, ambient = 273.0 } }, '
        '{ name = "sun", flux = 3e7 }, { name = "tail", region = "tail", hold = 350.0 }] }'),
    "surface-temperature": ("convecting-block", 'thermal.boundary=[{ name = "bath", surface-temperature = 293.0 }]'),
    "heat-between-bodies": ("temperature-from-energy", "numerics.temperature=plastic-work", "thermal={ conduction = true }",
        "material.aluminium-pysph-plate.conductivity=2e4", "material.steel-pysph-disc.conductivity=5e3",
        "body.disc.temperature=500.0"),
    "spall-pressure": ("leapfrog-penetration", "material.aluminium-patino.spall-pressure=0.8e9"),
    "debris": ("penetration", "time.end=6e-6", "particles.spacing=1e-3"),
    "benz-asphaug": ("leapfrog-shear", "material.armco-iron.return-rule=benz-asphaug", "numerics.mls-interval=40"),
    "fixed-step": ("leapfrog", "time.fixed-step=3e-8"),
    "too-large-step": ("leapfrog", "time.fixed-step=1.33e-7"),
    "limited-steps": ("taylor-bar", "time.max-step=4e-8", "time.max-steps=170", "time.courant=0.2"),
    "stop-early": ("leapfrog", "time.stop-kinetic-fraction=0.7"),
    "hexagonal": ("leapfrog", "particles.lattice=hexagonal", "body.plate.spin={ rate = 8000 }"),
    "hexagonal-3d": ("taylor-bar", "particles.lattice=hexagonal"),
    "rings": ("taylor-bar", "particles.lattice=rings"),
    "shapes": ("leapfrog", "body.plate.shape={ rotate = { angle = 0.05 }, shift = [0, 0.0004], "
        "difference = [{ polygon = { corners = [[-0.004, 0], [0.005, 0], [0.001, 0.024]] } }, "
        "{ disc = { centre = [0, 0.006], radius = 0.0014 } }] }",
        "body.plate.velocity-gradient={ rows = [[500, 900], [0, -400]] }"),
    "free-motion": ("tensile", 'motion.0.velocity=["free", "free", 0]'),
    "thick-skin": ("rotating-rod", "numerics.gradient-correction=linear", "search={ skin = { fraction = 0.4 } }"),
    "accumulated": ("taylor-bar",
        "search={ adaptive = { accumulate = true, plastic-strain-threshold = 2e-3, strain-bound = 0.01 } }"),
    "no-hourglass-control": ("copper-bar", "search={ total-lagrangian = { hourglass = 0.0 } }"),
    "observers": ("leapfrog",
        'tracer=[{ name = "eye", point = [0.0001, 0.002], fixed = true }, { name = "tail", point = [0, 0.025] }]',
        'section=[{ name = "waist", point = [0, 0.005], normal = [0.2, 1], body = "plate" }]'),
    "measures": ("disc-on-plate", 'measure=[{ name = "a", diameter = { body = "disc", axis = "x" } }, '
        '{ name = "b", value = { field = "pressure", point = [0.0003, 0.0002] } }, { name = "c", front-speed = { body = "plate", '
        'field = "pressure", axis = "x", level = 2e9 } }, { name = "d", reversal-time = { body = "disc", axis = "y" } }, '
        '{ name = "e", period = { field = "velocity", component = "y" } }, { name = "f", crater-diameter = { body = "plate", '
        'axis = "x", edge = "entry-lips" } }, { name = "g", mean = { field = "stress", component = "xy", '
        'window = { min = [-0.009, 0], max = [0.009, 0.009] } } }]'),
}


def case(name):
    """Shipped deck of a deck or variant, and its overrides."""
    if name in DECKS:
        end, place, *own = DECKS[name]
        tracer = f'{{ name = "probe", point = {[x * 1e-3 for x in place]}, fields = {json.dumps(["position", *FIELDS])} }}'
        output = {"output.history-interval": end / ROWS, "output.frames": 2, "output.fields": json.dumps(WHOLE_FIELDS + FIELDS)}
        common = {"time.end": end, **output, "audit": 20, "tracer": f"[{tracer}]"}
        return name, [f"{key}={value}" for key, value in common.items()] + own
    base, *own = VARIANTS[name]
    deck, overrides = case(base)
    return deck, overrides + own


def jobs_of(name, more):
    """Every run of a deck or variant: key, deck, threads, overrides."""
    deck, overrides = case(name)
    own_search = any(override.startswith("search=") for override in overrides)
    searches = {"own-search": []} if own_search else {key: [f"search={value}"] for key, value in SEARCHES.items()}
    for (search, chosen), precision, threads in itertools.product(searches.items(), ("mixed", "double"), (1, 2)):
        yield f"{name}/{search}/{precision}/{threads}", deck, threads, [
            *overrides, *chosen, f"numerics.precision={precision}", *more
        ]


class Store:
    """Folder of a record: files named by the hash of their content, and `index.json`, which says what they are."""

    def __init__(self, folder):
        self.folder = Path(folder)

    def put(self, content):
        digest = hashlib.sha256(content).hexdigest()
        path = self.folder / "files" / f"{digest}.gz"
        if not path.exists():
            path.write_bytes(gzip.compress(content, 6, mtime=0))
        return digest

    def get(self, digest):
        return gzip.decompress((self.folder / "files" / f"{digest}.gz").read_bytes())

    def runs(self, only):
        runs = json.loads((self.folder / "index.json").read_text(encoding="utf-8"))["runs"]
        return {key: run for key, run in runs.items() if not only or key.split("/")[0] in only}


# Types of VTK: code of `array` and bytes.
TYPES = {"Float64": ("d", 8), "Float32": ("f", 4), "UInt32": ("I", 4), "Int32": ("i", 4), "Int64": ("q", 8)}


def array_bytes(data, at, is_compressed):
    """The bytes of an array of a frame that begins at `at`; compressed, it is blocks of zlib streams behind their number and sizes."""
    (count,) = struct.unpack_from("<Q", data, at)
    if not is_compressed:
        return data[at + 8 : at + 8 + count]
    at += 24 + 8 * count
    blocks = []
    for size in struct.unpack_from(f"<{count}Q", data, at - 8 * count):
        blocks.append(zlib.decompress(data[at : at + size]))
        at += size
    return b"".join(blocks)


def read_frame(path):
    """Time and step of a `.vtp` frame, and its arrays in order of `id`: name, type, components, bytes."""
    data = path.read_bytes()
    header_end = data.index(b"<AppendedData")
    start = data.index(b"_", data.index(b">", header_end)) + 1
    root = ElementTree.fromstring(data[:header_end] + b"</VTKFile>")
    header, is_compressed = root.find("PolyData"), root.get("compressor") == "vtkZLibDataCompressor"
    stated = {element.get("Name"): element.text for element in header.iterfind("FieldData/DataArray")}
    arrays = []
    for element in [*header.iterfind("Piece/Points/DataArray"), *header.iterfind("Piece/PointData/DataArray")]:
        content = array_bytes(data, start + int(element.get("offset")), is_compressed)
        width = int(element.get("NumberOfComponents", "1"))
        arrays.append((element.get("Name"), element.get("type"), width, content))
    ids = array("I", next(content for name, _, _, content in arrays if name == "id"))
    order = sorted(range(len(ids)), key=ids.__getitem__)
    if len(set(ids)) < len(ids):
        raise ValueError(f"{path}: two particles have the same id")
    ordered = []
    for name, kind, width, content in sorted(arrays):
        size = TYPES[kind][1] * width
        if len(content) != size * len(ids):
            raise ValueError(f"{path}: `{name}` has {len(content)} bytes, not those of {len(ids)} particles")
        ordered.append((name, kind, width, b"".join(content[i * size : (i + 1) * size] for i in order)))
    return {"time": stated["TimeValue"], "step": stated["Step"]}, ordered


def refusal(text):
    """Code and first message of a report of faults, without the excerpt of the deck."""
    lines = [line.strip() for line in text.splitlines()]
    first = next((i for i, line in enumerate(lines) if line.startswith("×")), None)
    if first is None:
        return " ".join(lines)[:400]
    rest = itertools.takewhile(lambda line: line.startswith("│"), lines[first + 1 :])
    return " ".join([f"{lines[0]}:", lines[first].lstrip("× "), *(line.lstrip("│ ") for line in rest)])


def perform(job, binary, store, scratch):
    """One run: its key and what is recorded of it."""
    key, deck, threads, overrides = job
    out = scratch / key.replace("/", "_")
    command = [binary, "run", deck, "--threads", str(threads), "-o", str(out)]
    command += [part for override in overrides for part in ("--set", override)]
    try:
        done = subprocess.run(command, capture_output=True, encoding="utf-8", timeout=TIME_LIMIT, check=False)
    except subprocess.TimeoutExpired:
        return key, {"exit": "none", "message": f"longer than {TIME_LIMIT} s"}
    run = {"exit": done.returncode}
    if done.returncode not in (0, 1):
        return key, {**run, "message": refusal(done.stderr)}
    summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    run["summary"] = {name: summary.get(name) for name in SUMMARY}
    run["history"] = store.put((out / "history.csv").read_bytes())
    frames = sorted((out / "fields").glob("*.vtp"))
    run["frames"] = len(frames)
    if frames:
        run["last_frame"], arrays = read_frame(frames[-1])
        run["fields"] = {name: [kind, width, hashlib.sha256(content).hexdigest()] for name, kind, width, content in arrays}
        run["arrays"] = store.put(b"".join(content for *_, content in arrays))
    shutil.rmtree(out)
    return key, run


def record(options):
    decks = subprocess.run([options.binary, "decks"], capture_output=True, encoding="utf-8", check=True).stdout
    shipped = set(re.findall(r"^│ (\S+) +┆", decks, re.MULTILINE)) - {"name"}
    if shipped != set(DECKS):
        sys.exit(f"the table and the program have different decks: {', '.join(sorted(shipped ^ set(DECKS)))}")
    schema = subprocess.run([options.binary, "schema"], capture_output=True, encoding="utf-8", check=True).stdout
    words = {choice["const"] for choice in json.loads(schema)["$defs"]["SearchWord"]["oneOf"]}
    if missing := words - set(SEARCHES):
        sys.exit(f"the program has searches that are not in the table: {', '.join(sorted(missing))}")
    if unknown := set(options.only or []) - set(DECKS) - set(VARIANTS):
        sys.exit(f"not in the table: {', '.join(sorted(unknown))}")
    store, runs, start = Store(options.out), {}, time.monotonic()
    if store.folder.exists():
        sys.exit(f"{store.folder} is there already")
    (store.folder / "files").mkdir(parents=True)
    memory = "/dev/shm" if os.access("/dev/shm", os.W_OK) else None
    with tempfile.TemporaryDirectory(dir=memory) as scratch, ThreadPoolExecutor(options.jobs) as pool:
        for name in options.only or [*DECKS, *VARIANTS]:
            done = dict(pool.map(lambda job: perform(job, options.binary, store, Path(scratch)), jobs_of(name, options.set)))
            runs.update(done)
            exits = Counter(run["exit"] for run in done.values())
            print(f"{name:24}", ", ".join(f"{count} runs with exit code {code}" for code, count in exits.items()), flush=True)
    binary = hashlib.sha256(Path(options.binary).read_bytes()).hexdigest()
    text = json.dumps({"binary": binary, "overrides": options.set, "runs": runs}, indent=1, ensure_ascii=False)
    (store.folder / "index.json").write_text(text + "\n", encoding="utf-8")
    for message, count in Counter(run["message"] for run in runs.values() if "message" in run).items():
        print(f"{count} runs: {message}")
    print(f"{len(runs)} runs in {time.monotonic() - start:.0f} s")
    return True


def number(text):
    """A cell of the history or an entry of the summary; words, and nothing, are no number."""
    try:
        return float(text)
    except (TypeError, ValueError):
        return math.nan


def relative(pairs):
    """Largest difference over the largest size; infinite where one of two values is no number."""
    largest = scale = 0.0
    for a, b in pairs:
        scale = max(scale, *(abs(x) if math.isfinite(x) else 0.0 for x in (a, b)))
        if a != b and not (math.isnan(a) and math.isnan(b)):
            difference = abs(a - b)
            largest = max(largest, difference if math.isfinite(difference) else math.inf)
    return largest / scale if scale else largest


def sizes(pairs_by_name):
    ranked = sorted(((relative(pairs), name) for name, pairs in pairs_by_name.items()), reverse=True)
    return "largest relative differences: " + ", ".join(f"{name} {value:.1e}" for value, name in ranked)


def flat(value, path=""):
    """Entries of nested tables by their paths."""
    if not isinstance(value, dict):
        return {path: value}
    return {key: v for name, inner in value.items() for key, v in flat(inner, f"{path}.{name}".lstrip(".")).items()}


def summary_differences(a, b):
    a, b = flat(a), flat(b)
    unlike = [name for name in {**a, **b} if a.get(name) != b.get(name)]
    if unlike:
        largest = sizes({name: [(number(a.get(name)), number(b.get(name)))] for name in unlike})
        yield f"summary.json: first differs in {unlike[0]}: {a.get(unlike[0])} against {b.get(unlike[0])}; {largest}"


def history_differences(a, b):
    (names_a, *rows_a), (names_b, *rows_b) = (list(csv.reader(io.StringIO(text.decode()))) for text in (a, b))
    if names_a != names_b:
        yield f"history.csv: other columns: {', '.join(sorted(set(names_a) ^ set(names_b))) or 'the same in another order'}"
    if len(rows_a) != len(rows_b):
        yield f"history.csv: {len(rows_a)} rows against {len(rows_b)}"
    columns_a, columns_b = (dict(zip(names, zip(*rows))) for names, rows in ((names_a, rows_a), (names_b, rows_b)))
    shared = {name: list(zip(columns_a[name], columns_b[name])) for name in columns_a if name in columns_b}
    unlike = {name: pairs for name, pairs in shared.items() if any(x != y for x, y in pairs)}
    if unlike:
        rows = {name: next(i for i, (x, y) in enumerate(pairs) if x != y) for name, pairs in unlike.items()}
        first = min(rows, key=rows.get)
        largest = sizes({name: [(number(x), number(y)) for x, y in pairs] for name, pairs in unlike.items()})
        values = " against ".join(unlike[first][rows[first]])
        yield f"history.csv: first differs in row {rows[first]}, column {first}: {values}; {largest}"


def unpack(run, store):
    """Fields of the last frame as flat arrays."""
    content, at, fields = store.get(run["arrays"]), 0, {}
    for name, (kind, width, _) in run["fields"].items():
        code, size = TYPES[kind]
        length = size * width * run["summary"]["particles"]
        fields[name] = array(code, content[at : at + length])
        at += length
    return fields


def frame_differences(a, b, stores):
    for key in ("frames", "last_frame"):
        if a.get(key) != b.get(key):
            yield f"frames: {key} {a.get(key)} against {b.get(key)}"
    fields_a, fields_b = a.get("fields", {}), b.get("fields", {})
    if fields_a.keys() != fields_b.keys():
        yield f"last frame: only in one: {', '.join(sorted(fields_a.keys() ^ fields_b.keys()))}"
    unlike = [name for name in fields_a if name in fields_b and fields_a[name] != fields_b[name]]
    if unlike:
        values_a, values_b = (unpack(run, store) for run, store in zip((a, b), stores))
        pairs = {name: list(zip(values_a[name], values_b[name])) for name in unlike}
        first = unlike[0]
        place = next((i for i, (x, y) in enumerate(pairs[first]) if str(x) != str(y)), 0)
        particle = values_a["id"][place // fields_a[first][1]]
        yield f"last frame: first differs in {first} of particle {particle}; {sizes(pairs)}"


def run_differences(a, b, stores):
    """What differs between two runs, one line each."""
    for key in ("exit", "message"):
        if a.get(key) != b.get(key):
            yield f"{key}: {a.get(key)} against {b.get(key)}"
    if "summary" in a and "summary" in b:
        yield from summary_differences(a["summary"], b["summary"])
        if a["history"] != b["history"]:
            texts = (store.get(run["history"]) for run, store in zip((a, b), stores))
            yield from list(history_differences(*texts)) or ["history.csv: other bytes, the same values"]
        yield from frame_differences(a, b, stores)


def tally(pairs, stores):
    """Reports what differs in pairs of runs, and counts them."""
    counts = Counter()
    for title, a, b in pairs:
        differences = list(run_differences(a, b, stores)) if a and b else [f"only in {'A' if a else 'B'}"]
        if differences:
            print(title, *differences, sep="\n    ")
        counts["different" if differences else "refused" if a["exit"] == 2 else "identical"] += 1
    return counts


def compare(options):
    stores = [Store(folder) for folder in (options.a, options.b) if folder]
    records = [store.runs(options.only) for store in stores]
    same = True
    for label, store, runs in zip("AB", stores, records):
        stems = [key[:-2] for key in runs if key.endswith("/1")]
        pairs = [(f"{label}: {stem}, one thread against two", runs[f"{stem}/1"], runs[f"{stem}/2"]) for stem in stems]
        counts = tally(pairs, (store, store))
        different = counts["different"]
        print(f"{label}: one and two threads agree in {len(pairs) - different} pairs of runs, not in {different}")
        same = same and not different
    if len(stores) == 2:
        a, b = records
        counts = tally([(key, a.get(key), b.get(key)) for key in {**a, **b}], stores)
        print(f"{counts['identical']} identical, {counts['different']} different, {counts['refused']} refused alike")
        same = same and not counts["different"]
    return same and all(records)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True)
    command = commands.add_parser("record", help="run everything and record it")
    command.add_argument("binary", metavar="BINARY")
    command.add_argument("out", metavar="OUT", help="a folder that is not there yet")
    command.add_argument("--jobs", type=int, default=1, metavar="N", help="runs at a time")
    command.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="one more override for every run")
    command.set_defaults(command=record)
    other = commands.add_parser("compare", help="compare two records, or the threads of one")
    other.add_argument("a", metavar="A")
    other.add_argument("b", metavar="B", nargs="?")
    other.set_defaults(command=compare)
    for each in (command, other):
        each.add_argument("--only", nargs="+", metavar="NAME", help="only these decks and variants")
    options = parser.parse_args()
    sys.exit(0 if options.command(options) else 1)


if __name__ == "__main__":
    main()
