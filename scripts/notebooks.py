#!/usr/bin/env python3
"""The notebooks of the documentation: written from the scripts in docs/notebooks, executed in the order of their cells.

    scripts/notebooks.py                      writes docs/notebooks/*.ipynb from docs/notebooks/*.py
    scripts/notebooks.py --check              says whether they are what the scripts say
    scripts/notebooks.py --execute FOLDER     executes them in a kernel of this Python, and writes them with their output to FOLDER

A script has cells like those of Jupytext: `# %%` begins one with code, `# %% [markdown]` one with text. The notebooks are stored without output.
"""

from __future__ import annotations

import argparse
import json
import shutil
import sys
import time
from pathlib import Path

ROOT = Path(__file__).parents[1]
#: No cell may take longer, s.
LIMIT = 300


def cells(text: str) -> list[dict[str, object]]:
    """The cells of a script."""
    made: list[dict[str, object]] = []
    for k, part in enumerate(text.split("# %%")[1:]):
        head, _, body = part.partition("\n")
        is_text = head.strip() == "[markdown]"
        lines = body.strip("\n").splitlines()
        if is_text:
            lines = [line[2:] if line.startswith("# ") else line.removeprefix("#") for line in lines]
        source = [line + "\n" for line in lines[:-1]] + lines[-1:]
        cell: dict[str, object] = {"cell_type": "markdown" if is_text else "code", "id": f"cell-{k}", "metadata": {}, "source": source}
        if not is_text:
            cell |= {"execution_count": None, "outputs": []}
        made.append(cell)
    return made


def notebook(script: Path) -> str:
    """A notebook as a file holds it."""
    metadata = {"kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"}, "language_info": {"name": "python"}}
    whole = {"cells": cells(script.read_text(encoding="utf-8")), "metadata": metadata, "nbformat": 4, "nbformat_minor": 5}
    return json.dumps(whole, indent=1, ensure_ascii=False) + "\n"


def execute(file: Path, to: Path) -> None:
    """Executes a notebook in a folder of its own."""
    import nbformat
    from nbclient import NotebookClient

    place = to / file.stem
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir(parents=True)
    read = nbformat.read(file, as_version=4)
    start = time.monotonic()
    NotebookClient(read, timeout=LIMIT, kernel_name="python3", resources={"metadata": {"path": str(place)}}).execute()
    nbformat.write(read, to / file.name)
    kinds = {kind for cell in read.cells for output in cell.get("outputs", []) for kind in output.get("data", {})}
    if "image/png" not in kinds and not any("data:image/png" in str(output.get("data", {})) for cell in read.cells for output in cell.get("outputs", [])):
        sys.exit(f"{file.name}: nothing was drawn")
    size = (to / file.name).stat().st_size
    print(f"{file.name}: {time.monotonic() - start:.0f} s, {size / 1e3:.0f} kB with its output")
    if size > 3e6:
        sys.exit(f"{file.name}: its output is larger than 3 MB")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--execute", type=Path, metavar="FOLDER")
    arguments = parser.parse_args()
    for script in sorted((ROOT / "docs/notebooks").glob("*.py")):
        file = script.with_suffix(".ipynb")
        if arguments.execute:
            execute(file, arguments.execute.absolute())
        elif arguments.check:
            if not file.exists() or file.read_text(encoding="utf-8") != notebook(script):
                sys.exit(f"{file} is not that of {script.name}: scripts/notebooks.py writes it")
        else:
            file.write_text(notebook(script), encoding="utf-8")


main()
