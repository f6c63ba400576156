"""Looks at the report of `sphorge validate` in a browser without a window, at the width of a phone and of a screen.

    python3 scripts/check_report.py out/validate/report.html

Asks that the page is no wider than the window, that every picture is drawn, that every link leads somewhere in the page, that nothing is
fetched, and that as many cases are headed as the JSON beside it lists. Wants Chromium.
"""

import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

PROBE = """
<script>
addEventListener("load", () => {
  const broken = [...document.images].filter((image) => !image.complete || image.naturalWidth === 0);
  const dead = [...document.links].filter((link) => !document.getElementById(decodeURIComponent(link.hash.slice(1))));
  const wide = [...document.querySelectorAll("body > *")].filter((e) => e.getBoundingClientRect().right > innerWidth + 1);
  const found = {
    width: document.documentElement.scrollWidth, window: innerWidth,
    wide: wide.map((e) => e.tagName + " " + e.textContent.slice(0, 60)),
    pictures: document.images.length, broken: broken.length, dead: dead.map((link) => link.href),
    cases: document.querySelectorAll("h2").length,
    fetched: performance.getEntriesByType("resource").map((r) => r.name).filter((name) => !name.startsWith("data:")),
  };
  parent.postMessage(JSON.stringify(found).replace(/[<&]/g, ""), "*");
});
</script>
"""

FRAME = """<!DOCTYPE html><script>
addEventListener("message", (event) => { document.getElementById("found").textContent = "FOUND" + event.data + "FOUND"; });
</script><pre id="found"></pre><iframe src="probed.html" style="width: %dpx; height: 900px; border: 0"></iframe>
"""


def look(browser, page, width):
    """What the page is like in a window of that width, px."""
    with tempfile.TemporaryDirectory() as folder:
        probed = pathlib.Path(folder) / "probed.html"
        probed.write_text(page.read_text(encoding="utf-8").replace("</body>", PROBE + "</body>"), encoding="utf-8")
        # Browsers make no window as narrow as a phone, but frames.
        frame = pathlib.Path(folder) / "frame.html"
        frame.write_text(FRAME % width, encoding="utf-8")
        command = [browser, "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--window-size=1400,1000"]
        command += [f"--user-data-dir={folder}/profile", "--virtual-time-budget=60000", "--dump-dom", frame.as_uri()]
        done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    found = re.search(">FOUND(.*)FOUND<", done.stdout, re.DOTALL)
    if not found:
        raise SystemExit(f"the browser shows nothing:\n{done.stderr[-2000:]}")
    return json.loads(found.group(1))


def main():
    page = pathlib.Path(sys.argv[1])
    browser = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if not browser:
        raise SystemExit("there is no Chromium: install it (Debian: apt install chromium)")
    cases = len(json.loads(page.with_suffix(".json").read_text(encoding="utf-8"))["cases"])
    for width in (390, 1280):
        found = look(browser, page, width)
        print(f"{width} px: {found['cases']} cases, {found['pictures']} pictures, {found['width']} px wide in {found['window']}")
        wrong = []
        if found["width"] > found["window"] or found["wide"]:
            wrong.append(f"wider than the window: {found['wide']}")
        if found["broken"] or not found["pictures"]:
            wrong.append(f"{found['broken']} of {found['pictures']} pictures are not drawn")
        if found["dead"] or found["fetched"]:
            wrong.append(f"links to nowhere {found['dead']}, fetched {found['fetched']}")
        if found["cases"] != cases:
            wrong.append(f"{found['cases']} headed cases, {cases} listed")
        if wrong:
            raise SystemExit("; ".join(wrong))


if __name__ == "__main__":
    main()
