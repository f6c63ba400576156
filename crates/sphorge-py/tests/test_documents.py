from __future__ import annotations

from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]


@pytest.mark.skipif(not (ROOT / "docs").exists(), reason="only in the repository")
def test_the_extras_that_are_listed_are_those_of_the_package():
    import re

    project = (ROOT / "crates/sphorge-py/pyproject.toml").read_text(encoding="utf-8")
    table = project.split("[project.optional-dependencies]\n")[1].split("\n[")[0]
    extras = set(re.findall(r"^(\w+) = ", table, re.MULTILINE))
    listed = re.findall(r'pip install "sphorge\[([\w,]+)\]"', (ROOT / "docs/python.md").read_text(encoding="utf-8"))
    assert listed and all(set(one.split(",")) == extras for one in listed), (listed, extras)


@pytest.mark.skipif(not (ROOT / "docs").exists(), reason="only in the repository")
@pytest.mark.parametrize(("page", "count"), [("docs/python.md", 9), ("README.md", 1), ("crates/sphorge-py/README.md", 1)])
def test_what_a_page_shows_runs_as_it_stands(here, page, count):
    blocks = [part.split("```")[0] for part in (ROOT / page).read_text(encoding="utf-8").split("```python\n")[1:]]
    assert len(blocks) == count
    names: dict[str, object] = {}
    for block in blocks:
        exec(compile(block, page, "exec"), names)
    assert list((here / "out").rglob("summary.json"))
