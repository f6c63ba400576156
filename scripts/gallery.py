#!/usr/bin/env python3
"""Makes the gallery: a page of every shipped deck with picture, animation, deck, time and command.

    python3 scripts/gallery.py PROGRAM RUNS [--finished] [--numbers] [--only NAME...] [--coarser NAME=FACTOR...] [--page FILE.md]

PROGRAM is the program `sphorge`. RUNS is a folder with a folder for each deck, such as `check_decks.py --keep` makes: a run that has ended is taken as it is,
also one of another spacing, which the page tells; one that is missing is made with one thread, at a spacing that is coarser by a factor if --coarser says
so, unless --finished is given. With --only, the page keeps what it has of the other decks; with --numbers it keeps
pictures, too, and the time of a step: for a machine that does something else meanwhile.

The page is docs/guide/gallery.md, its pictures are docs/images/gallery/NAME.webp and NAME-moving.webp. Wants the Python package Pillow, which writes WebP:
animated PNG files of the same pictures are more than twice as large.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
#: The first that a run has is shown, but for decks about something else.
FIELDS = ("plastic_strain", "temperature", "pressure", "velocity")
ABOUT = {
    "bullet": ("plastic_strain", ["--view", "xz", "--section"]),
    "convecting-block": ("temperature", []),
    "crack-energy": ("integrity", []),
    "failure-strains": ("damage", []),
    "copper-bar": ("plastic_strain", ["--mirror", "--section"]),
    "elastic-bar": ("stress.zz", []),
    "heat-slab": ("temperature", []),
    "notched-bars": ("damage", ["--view", "xz", "--mirror", "--section"]),
    "oscillating-plate": ("stress.xx", []),
    "perforation": ("damage", ["--view", "xz", "--mirror", "--section"]),
    "plate-impact": ("pressure", []),
    "elastic-plastic-piston": ("pressure", []),
    "rotating-rod": ("velocity", []),
    "rubber-rings": ("pressure", []),
    "spall": ("integrity", []),
    "taylor-fracture": ("damage", ["--section"]),
    "weldox-tension": ("damage", ["--mirror"]),
    "taylor-bar-42crmo4": ("temperature", ["--mirror", "--section"]),
    "two-materials": ("temperature", []),
}
#: Frames of an animation at most, seconds that they take, pixels of a picture across.
FRAMES, SECONDS, PIXELS = 26, 5, 420


def call(*words: object) -> str:
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True)
    # One that was stopped or has warnings has pictures, too.
    if done.returncode not in (0, 130):
        sys.exit(f"{' '.join(map(str, words))}\n{done.stderr}")
    return done.stdout


def spacings(text: str) -> list[str]:
    return re.findall(r'^\s*spacing = "([^"]+)"', text, re.MULTILINE)


def coarser(spacing: str, factor: float) -> str:
    number, unit = spacing.split(" ", 1)
    return f"{float(number) * factor:.6g} {unit}"


def webp(source: Path, to: Path, quality: int) -> None:
    """A PNG file, animated or not, as WebP."""
    from PIL import Image

    whole, frames, times = Image.open(source), [], []
    for k in range(getattr(whole, "n_frames", 1)):
        whole.seek(k)
        frames.append(whole.convert("RGB"))
        times.append(int(whole.info.get("duration", 0)))
    if len(frames) == 1:
        frames[0].save(to, quality=quality, method=6)
    else:
        frames[0].save(to, save_all=True, append_images=frames[1:], duration=times, loop=0, quality=quality, method=6, minimize_size=True)


def chosen(run: Path) -> list[int]:
    """Numbers of frames at equal distances, the first and the last among them."""
    count = (run / "fields.pvd").read_text(encoding="utf-8").count("<DataSet")
    kept = min(count, FRAMES)
    return sorted({round(k * (count - 1) / max(kept - 1, 1)) for k in range(kept)})


def draw(program: Path, run: Path, name: str, images: Path | None) -> tuple[str, list[str]]:
    """Draws the last frame and an animation, if there is a folder for them; what they show."""
    first = next((run / "fields").glob("000000.*vtp")).read_bytes()[:20000].decode("latin-1")
    field, options = ABOUT.get(name, (next((one for one in FIELDS if f'Name="{one}"' in first), "velocity"), []))
    if images is None:
        return field, options
    with tempfile.TemporaryDirectory() as folder:
        still, moving = Path(folder) / "still.png", Path(folder) / "moving.png"
        shared = ["--field", field, *options, "--width", f"{PIXELS} px"]
        call(program, "plot", run, *shared, "-o", still)
        webp(still, images / f"{name}.webp", 80)
        frames = ",".join(map(str, chosen(run)))
        call(program, "plot", run, *shared, "--frames", frames, "--animate", "--duration", f"{SECONDS} s", "-o", moving)
        webp(moving, images / f"{name}-moving.webp", 45)
    return field, options


#: Units in which engineers read numbers of one of SI, the largest first: their size in SI.
READABLE = {
    "m": (("m", 1.0), ("mm", 1e-3), ("um", 1e-6)),
    "s": (("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)),
    "Pa": (("GPa", 1e9), ("MPa", 1e6), ("kPa", 1e3), ("Pa", 1.0)),
    "J/kg": (("MJ/kg", 1e6), ("kJ/kg", 1e3), ("J/kg", 1.0)),
}


def pretty(key: str, value: float, unit: str) -> str:
    for readable, size in READABLE.get(unit, ()):
        if abs(value) >= size:
            value, unit = value / size, readable
            break
    return f"{key.replace('_', ' ')} {value:.4g}" + ("" if unit in ("", "1", "-") else f" {unit}")


def grouped(number: int) -> str:
    return f"{number:,}".replace(",", "\u00a0") if number >= 10_000 else str(number)


def section(program: Path, run: Path, name: str, text: str, images: Path | None) -> str:
    """What the page says of a deck."""
    summary = json.loads((run / "summary.json").read_text(encoding="utf-8"))
    own, shipped = spacings((run / "deck.toml").read_text(encoding="utf-8")), spacings(text)
    field, options = draw(program, run, name, images)
    title = re.search(r'^title = "(.*)"', text, re.MULTILINE)[1]
    command, coarse = f"sphorge run {name}", ""
    if own[:1] != shipped[:1]:
        command += f" --set 'particles.spacing=\"{own[0]}\"'"
        coarse = f" **Coarser than shipped**: particles are {own[0]} apart, those of the deck {shipped[0]}."
    values = [pretty(key, value, summary["measure_units"].get(key, "")) for key, value in summary["measures"].items() if value is not None]
    broken = [warning["name"] for warning in summary.get("warnings", [])]
    lines = [
        f"## {name}",
        "",
        f"{title}.{coarse}",
        "",
        "```sh",
        command,
        f"sphorge plot out/{name} --field {field} {' '.join(options)}".rstrip(),
        "```",
        "",
        f"![The last frame of {name}](../images/gallery/{name}.webp) ![All of {name}](../images/gallery/{name}-moving.webp)",
        "",
        f"{grouped(summary['particles'])} particles, {grouped(summary['steps'])} steps, {summary['wall_seconds']:.3g} s; {summary['status']}"
        + (f" ({', '.join(broken)})" if broken else "")
        + ".",
        *(["", f"Measured: {', '.join(values)}."] if values else []),
        "",
        "<details><summary>The deck</summary>",
        "",
        "```toml",
        text.rstrip(),
        "```",
        "",
        "</details>",
    ]
    return "\n".join(lines)


def with_time_of(old: str, new: str) -> str:
    """The new section with the time that its steps take at the speed of the old one."""
    cost = r"([\d\u00a0]+) steps, ([\d.e+]+) s;"
    (steps, seconds), (now, _) = re.search(cost, old).groups(), re.search(cost, new).groups()
    time = float(seconds) / int(steps.replace("\u00a0", "")) * int(now.replace("\u00a0", ""))
    return re.sub(cost, f"{now} steps, {seconds if steps == now else f'{time:.3g}'} s;", new)


def machine() -> str:
    model = next((line.split(":", 1)[1].strip() for line in open("/proc/cpuinfo", encoding="utf-8") if line.startswith("model name")), "an unnamed processor")
    return f"{model}, {os.cpu_count()} cores, which other programs used, too"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path)
    parser.add_argument("runs", type=Path)
    parser.add_argument("--finished", action="store_true")
    parser.add_argument("--numbers", action="store_true")
    parser.add_argument("--only", nargs="+", default=[])
    parser.add_argument("--coarser", nargs="+", default=[], metavar="NAME=FACTOR")
    parser.add_argument("--page", type=Path, default=ROOT / "docs/guide/gallery.md")
    given = parser.parse_args()
    names = re.findall(r"^│ ([a-z0-9-]+) +┆", call(given.program, "decks"), re.MULTILINE)
    names.remove("name")
    factors = {name: float(factor) for name, factor in (one.split("=") for one in given.coarser)}
    unknown = [name for name in [*given.only, *factors] if name not in names]
    if unknown:
        sys.exit(f"no shipped decks: {', '.join(unknown)}; there are: {', '.join(names)}")
    images = given.page.parent.parent / "images/gallery"
    images.mkdir(parents=True, exist_ok=True)
    before = given.page.read_text(encoding="utf-8") if given.page.exists() else ""
    kept = {part.split("\n", 1)[0]: "## " + part.rstrip() for part in before.split("\n## ")[1:]}
    for name in given.only or names:
        # The line for editors is not the deck's own.
        text = "\n".join(line for line in call(given.program, "decks", name).splitlines() if not line.startswith("#:"))
        run = given.runs / name
        if not (run / "summary.json").exists():
            if given.finished:
                print(f"{name}: has no finished run", flush=True)
                continue
            setting = ["--set", f'particles.spacing="{coarser(spacings(text)[0], factors[name])}"'] if name in factors else []
            call(given.program, "run", name, "-o", run, "--overwrite", "--quiet", "--threads", "1", *setting)
        new = section(given.program, run, name, text, None if given.numbers else images)
        kept[name] = with_time_of(kept[name], new) if given.numbers and name in kept else new
        print(f"{name}: {sum(file.stat().st_size for file in images.glob(f'{name}*.webp') if file.stem in (name, f'{name}-moving')) / 1e3:.0f} kB", flush=True)
    shown = [name for name in names if name in kept]
    head = [
        "# Gallery",
        "",
        f"{'Every deck that comes' if len(shown) == len(names) else f'{len(shown)} of the {len(names)} decks that come'} with the program, run to its end: the last frame, all of it, and what was measured.",
        f"Times are those of one thread of {machine()}. Made by `scripts/gallery.py`.",
        "",
        ", ".join(f"[{name}](#{name})" for name in shown) + ".",
        "",
    ]
    given.page.write_text("\n".join(head) + "\n" + "\n\n".join(kept[name] for name in shown) + "\n", encoding="utf-8")
    print(f"{given.page}: {len(shown)} of {len(names)} decks, {sum(file.stat().st_size for file in images.iterdir()) / 1e6:.2f} MB of pictures")


main()
