from __future__ import annotations

from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]


@pytest.mark.skipif(not (ROOT / "docs").exists(), reason="only in the repository")
@pytest.mark.parametrize(("page", "count"), [("docs/python.md", 4), ("README.md", 1), ("crates/sphorge-py/README.md", 1)])
def test_what_a_page_shows_runs_as_it_stands(here, page, count):
    blocks = [part.split("```")[0] for part in (ROOT / page).read_text(encoding="utf-8").split("```python\n")[1:]]
    assert len(blocks) == count
    names: dict[str, object] = {}
    for block in blocks:
        exec(compile(block, page, "exec"), names)
    assert list((here / "out").rglob("summary.json"))
