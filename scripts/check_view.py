"""Looks at `sphorge view` in a browser without a window: pixels, clicks, fingers, a run that grows meanwhile, and a single page.

    python3 scripts/check_view.py target/release/sphorge target/ci/view [--measure]

Runs small decks into the folder first. With `--measure` it prints how fast pictures are, too. Wants Chromium.
"""

import json
import os
import pathlib
import platform
import shutil
import socket
import subprocess
import sys
import time

from chromium import Chromium, find

COARSE = ["--set", 'particles.spacing="0.6 mm"', "-q"]
BAR = ["--set", 'particles.spacing="0.9 mm"', "--set", 'time.end="12 us"', "--set", "output.frames=4", "-q"]
SHOWN = "typeof app !== 'undefined' && app.panels.length > 0 && app.panels.every((panel) => panel.frame >= 0) && app.pictures > 0"
WHITE = (255, 255, 255)


class Viewer:
    """The program while it serves runs."""

    def __init__(self, program, *arguments):
        self.process = subprocess.Popen([program, "view", "--no-open", *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.address = self.process.stdout.readline().strip()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()


def expect(condition, what):
    if not condition:
        raise SystemExit(f"not so: {what}")
    print(f"  {what}")


def settle(page):
    """Waits until what was asked for is drawn."""
    page.evaluate("app.refresh().then(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))))")


def particle_on_page(page, particle, panel=0):
    """Where a particle is seen, pixels of the page."""
    return page.evaluate(
        f"""(() => {{
          const panel = app.panels[{panel}], box = panel.element.getBoundingClientRect();
          const place = plus(Array.from(panel.data.positions.slice(3 * {particle}, 3 * {particle} + 3)), panel.run.origin);
          const [right, up] = panel.camera.seen(place), pixel = panel.measure().pixel;
          return [box.left + box.width / 2 + right / pixel, box.top + box.height / 2 - up / pixel];
        }})()"""
    )


def color_of(page, particle, panel=0):
    """The colour that a value has on the bar."""
    return tuple(
        page.evaluate(
            f"""(() => {{
              const {{ low, high, table }} = app.colors, value = app.panels[{panel}].data.values[{particle}];
              const k = Math.round(255 * Math.min(Math.max((value - low) / (high - low), 0), 1));
              return Array.from(table.slice(3 * k, 3 * k + 3));
            }})()"""
        )
    )


def near(a, b, by=6):
    return all(abs(x - y) <= by for x, y in zip(a, b))


def distinct(picture, box):
    """How many colours an area has."""
    left, top, right, bottom = map(int, box)
    return len({picture.at(x, y) for y in range(top, bottom, 3) for x in range(left, right, 3)})


def holes(picture, box):
    """Rows of an area in which there is paper between two coloured places."""
    left, top, right, bottom = map(int, box)
    rows = 0
    for y in range(top, bottom):
        covered = [x for x in range(left, right) if min(picture.at(x, y)) < 245]
        rows += bool(covered) and covered[-1] - covered[0] + 1 > len(covered)
    return rows


def darker(picture, box, color):
    """Places of an area that are darker than a colour."""
    left, top, right, bottom = map(int, box)
    return sum(sum(picture.at(x, y)) < 0.95 * sum(color) for y in range(top, bottom) for x in range(left, right))


def specks(picture, box, color, wide=12):
    """Places of an area that are darker than a colour and have it on both sides in their row, and above or below, no farther than so many pixels."""
    left, top, right, bottom = map(int, box)
    is_own = [[near(picture.at(x, y), color, 3) for x in range(left, right)] for y in range(top, bottom)]
    across, down = right - left, bottom - top
    found = 0
    for y in range(down):
        if not any(is_own[y]):
            continue
        for x in range(across):
            if is_own[y][x] or sum(picture.at(left + x, top + y)) >= 0.95 * sum(color):
                continue
            beside = any(is_own[y][max(x - wide, 0) : x]) and any(is_own[y][x + 1 : x + wide])
            found += beside and (any(is_own[k][x] for k in range(max(y - wide, 0), y)) or any(is_own[k][x] for k in range(y + 1, min(y + wide, down))))
    return found


def box_of(page, panel=0, inset=0):
    return page.evaluate(f"(() => {{ const b = app.panels[{panel}].element.getBoundingClientRect(); return [b.left + {inset}, b.top + {inset}, b.right - {inset}, b.bottom - {inset}]; }})()")


def outside(page, panel=0):
    """How many particles are not in the picture."""
    return page.evaluate(
        f"((number) => {{"
        """
          const panel = app.panels[number], { width, height } = panel.rectangle(), { pixel } = panel.measure();
          let outside = 0;
          for (let k = 0; k < panel.particles.count; k += 1) {
            const [right, up] = panel.camera.seen(plus(Array.from(panel.data.positions.slice(3 * k, 3 * k + 3)), panel.run.origin));
            if (Math.abs(right) > 0.5 * width * pixel || Math.abs(up) > 0.5 * height * pixel) outside += 1;
          }
          return outside;
        """
        f"}})({panel})"
    )


def too_wide(page):
    """What is wider than the screen or beside it, but charts, which are scrolled to where there are many."""
    return page.evaluate(
        """[...document.querySelectorAll('body *')].filter((element) => {
          const { left, right } = element.getBoundingClientRect();
          return element.offsetParent && !element.closest('.chart') && (left < -0.5 || right > innerWidth + 0.5);
        }).map((element) => element.id || element.className || element.tagName)"""
    )


def coarse(program, folder):
    print("a coarse bar that is much deformed")
    with Viewer(program, folder / "five", "--view", "xz", "--field", "body") as viewer, Chromium(1280, 800) as page:
        page.open(viewer.address)
        page.wait(SHOWN)
        settle(page)
        page.press("#edges")
        page.wait("!app.state.edges")
        for section in ("", "y"):
            page.choose("#section", section)
            page.evaluate("app.say('')")
            settle(page)
            # Names, arrows and the length are not of the body.
            page.evaluate("for (const { overlay, heading } of app.panels) { overlay.hidden = true; heading.hidden = true; }")
            settle(page)
            picture = page.picture()
            box = box_of(page, inset=2)
            expect(distinct(picture, box) > 1 and holes(picture, box) == 0, f"there is no hole in it {'with a section' if section else 'from outside'}")
            # What is seen is flat, the plane of symmetry or the cut, and its colour that of the body.
            single = page.evaluate("app.opening.single")
            # Beside the cut, half a pixel of what is behind it is seen.
            dark = specks(picture, box, single) if section else darker(picture, box, single)
            expect(dark == 0, "nor is there a dark speck")
        planes = page.evaluate("app.panels[0].run.symmetry.map(([axis]) => axis)")
        expect(planes == [0, 1], "images are not in the plane that stands for the wall")
        for view in ("xz", "corner"):
            page.press(f"#view-{view}")
            for place in ("120", "250", "377", "440", "560", "687"):
                page.choose("#place", place)
                page.wait("!app.isMoving")
                settle(page)
                dark = specks(page.picture(), box, single)
                expect(dark == 0, f"nor in a section {page.evaluate('app.controls.where.textContent')}, seen from {view}: {dark}")
        cells, faces = page.evaluate("[app.panels[0].particles.count, app.panels[0].particles.surface.faces.count]")
        expect(faces < 4 * cells, f"of {cells} cells {faces} faces are drawn, those outside")
        expect(not page.told, f"the browser complains of nothing {page.told or ''}")


def connections(program, folder):
    print("connections that say nothing")
    with Viewer(program, folder / "plate") as viewer, Chromium(1280, 800) as page:
        host, port = viewer.address.split("/")[2].split(":")
        held = [socket.create_connection((host, int(port))) for _ in range(120)]
        page.open(viewer.address)
        page.wait(SHOWN, 20)
        expect(not page.told, f"120 of them keep nobody out {page.told or ''}")
        for one in held:
            one.close()


def plane(program, folder):
    print("a plate in a plane")
    with Viewer(program, folder / "plate") as viewer, Chromium(1280, 800) as page:
        page.open(viewer.address)
        page.wait(SHOWN)
        settle(page)
        count = page.evaluate("app.panels[0].particles.count")
        expect(page.evaluate("app.panels[0].how(false)") == "cells", f"{count} particles are drawn as cells")
        page.press("#edges")
        settle(page)
        picture = page.picture()
        seen = [k for k in range(7, count, count // 12) if near(picture.at(*particle_on_page(page, k)), color_of(page, k))]
        expect(len(seen) >= 11, f"{len(seen)} of 12 particles have the colour of their value where they are")
        expect(picture.at(30, 400) == WHITE, "beside the plate there is paper")
        # Cells of neighbours meet: half way between two of them is no paper.
        (x, y), (x_next, y_next) = particle_on_page(page, 0), particle_on_page(page, 1)
        expect(picture.at((x + x_next) / 2, (y + y_next) / 2) != WHITE, "there is no gap between two cells")

        x, y = particle_on_page(page, count // 2)
        page.click(x, y)
        page.wait("document.getElementById('picked').textContent.includes('Particle')  && app.picked")
        expect(page.evaluate("app.picked.particle") == count // 2, "the particle that is clicked is picked")
        own = page.evaluate("fetch(`run/0/frame/${app.panels[0].frame}/particle/${app.picked.particle}`).then((answer) => answer.json())")
        page.wait("document.querySelectorAll('#picked td').length > 20")
        table = page.evaluate("document.getElementById('picked').textContent")
        value = page.evaluate(f"quantity({next(f['values'][0] for f in own['fields'] if f['name'] == 'pressure')}, 'Pa')")
        expect(value in table and "von Mises" in table, f"its numbers are there, its pressure {value}")

        before = page.evaluate("app.colors.label")
        page.choose("#field", "velocity.y")
        page.wait("app.panels[0].field === 'velocity.y'")
        settle(page)
        expect(page.evaluate("app.colors.label + app.colors.unit") == "velocity ym/s" != before, "another field is shown with its unit")

        page.press("#body-0")
        settle(page)
        expect(picture_is_empty(page), "a body that is switched off is gone")
        page.press("#body-0")
        page.press("#walls")
        settle(page)
        page.evaluate("document.activeElement.blur()")

        # The space bar plays wherever the focus is but on a button or a tick; arrows go on by one frame.
        page.choose("#time", "0")
        page.evaluate("document.getElementById('time').focus()")
        page.key("ArrowRight")
        page.wait("app.panels[0].frame === 1")
        page.key(" ", "Space", " ")
        page.wait("app.timeline.isPlaying && app.panels[0].frame > 2")
        page.key(" ", "Space", " ")
        page.wait("!app.timeline.isPlaying")
        expect(page.evaluate("app.panels[0].frame < app.panels[0].run.times.length - 1"), "the space bar plays and pauses while the slider has the focus")

        page.press("#play")
        page.wait("!app.timeline.isPlaying && app.timeline.index === app.panels[0].run.times.length - 1", 60)
        expect(True, "it plays to its last frame")
        page.choose("#time", "0")
        page.wait("app.panels[0].frame === 0")
        expect("0 s" in page.evaluate("document.getElementById('now').textContent"), "the slider goes to the first frame")
        # In the middle of the chart of the history is the middle of the run.
        x, y = page.middle("#history canvas")
        page.click(x, y)
        page.wait("app.panels[0].frame > 0")
        last = page.evaluate("app.panels[0].run.times.length - 1")
        expect(abs(page.evaluate("app.panels[0].frame") - last / 2) <= 0.1 * last + 1, "a click on the curve goes to its time")

        title = page.evaluate("document.title + '|' + document.getElementById('status').textContent")
        expect(title.startswith("completed: Taylor") and title.endswith("|completed at 60 µs"), "the page says how far the run is")
        # Of twenty frames two have a shock that leaves one colour to all others.
        ranges = page.evaluate("rangeOfFrames(Array.from({ length: 20 }, (_, k) => (k === 3 ? [-50, 200, -50, 100] : k === 7 ? [-70, 90, -70, 90] : [-9, 1 + 0.01 * k, 0, 1 + 0.01 * k])))")
        expect(ranges[:2] == [-70, 200] and ranges[2] == 0 and abs(ranges[3] - 1.19) < 1e-12, "limits of all frames are those of nine of ten")
        half = page.evaluate("app.camera.half")
        page.wheel(450, 300, -300)
        page.wait(f"app.camera.half < {0.8 * half}")
        middle = page.evaluate("app.camera.middle[0]")
        page.drag((450, 300), (550, 300))
        page.wait(f"app.camera.middle[0] < {middle}")
        page.press("#fit")
        page.wait(f"Math.abs(app.camera.half / {half} - 1) < 0.2")
        expect(True, "wheel, drag and fit work")
        expect(not page.told, f"the browser complains of nothing {page.told or ''}")


def typed(program, folder):
    print("limits that are typed")
    with Viewer(program, folder / "plate", "--field", "pressure") as viewer, Chromium(1280, 800) as page:
        page.open(viewer.address)
        page.wait(SHOWN)
        settle(page)
        # The last frame has a small pressure; the limits of all frames are larger.
        page.wait("!app.isReading && app.colors.high > 5e8")
        page.choose("#ranges", "fixed")
        settle(page)
        boxes = "[app.controls.low.value, app.controls.high.value, app.controls.unit.textContent]"
        before = page.evaluate(boxes)
        expect(before[2] == "GPa", "limits of the pressure are in GPa")
        for box, text in (("low", "-0.001"), ("high", "0.002"), ("low", "-0.0005")):
            page.choose(f"#{box}", text)
            settle(page)
        expect(page.evaluate(boxes) == ["−0.0005", "0.002", "GPa"] and page.evaluate("app.state.fixed") == [-5e5, 2e6], "and stay so while numbers are typed")
        for text, value in (("2 GPa", 2e9), ("300 MPa", 3e8), ("1 kbar", 1e8), ("20 N/mm^2", 2e7), ("3e6 kg/(m s²)", 3e6), ("1,5", 1.5e9)):
            page.choose("#high", text)
            settle(page)
            found = page.evaluate("app.state.fixed[1]")
            expect(abs(found / value - 1) < 1e-12 and page.evaluate(boxes)[1:] == [f"{value / 1e9:g}", "GPa"], f"{text} is {value:g} Pa")
        for box, text, told in (("high", "abc", "“abc” is no number"), ("high", "3 K", "not in “K”"), ("high", "3 Gpa", "“Gpa” is no unit"), ("high", "", "There is no number"), ("high", "1e999", "“1e999” is no number"), ("low", "9", "smaller one comes first")):
            page.choose("#high", "1.5")
            page.choose(f"#{box}", text)
            settle(page)
            expect(told in page.evaluate("app.controls.wrong.textContent") and not page.evaluate("app.controls.wrong.hidden") and page.evaluate("app.state.fixed") == [-5e5, 1.5e9], f"of {text!r} the page says: {page.evaluate('app.controls.wrong.textContent')}")
        page.choose("#high", "10")
        settle(page)
        expect(page.evaluate("app.state.fixed") == [9e9, 1e10] and page.evaluate("app.controls.wrong.hidden"), "two numbers that fit together only when both are typed are taken")
        page.choose("#field", "plastic_strain")
        settle(page)
        page.choose("#high", "50 %")
        settle(page)
        expect(page.evaluate("app.state.fixed[1]") == 0.5, "a pure number can be in per cent")
        expect(not page.told, f"the browser complains of nothing {page.told or ''}")


def slow(program, folder):
    print("limits of all frames that are read slowly")
    with Viewer(program, folder / "plate", "--field", "velocity") as viewer, Chromium(1280, 800) as page:
        page.open(viewer.address)
        page.wait(SHOWN)
        page.wait("!app.isReading")
        # As many times slower as a run is larger; the bar keeps what it said.
        page.evaluate(
            """(() => {
              const { store } = app, range = store.range.bind(store);
              store.range = async (...which) => { await new Promise((done) => setTimeout(done, 60)); return range(...which); };
              window.told = [];
              const bar = document.getElementById("bar");
              new MutationObserver(() => told.push(bar.getAttribute("aria-label"))).observe(bar, { attributes: true, attributeFilter: ["aria-label"] });
            })()"""
        )
        page.choose("#field", "pressure")
        page.wait("told.some((words) => words.includes('reading frames, '))")
        page.choose("#field", "temperature")
        page.wait("!app.isReading")
        settle(page)
        told = page.evaluate("told")
        counts = [int(words.split("reading frames, ")[1].split(" of 51")[0]) for words in told if words.startswith("temperature") and "reading frames, " in words]
        said = ", ".join(map(str, counts))
        expect(len(counts) > 4 and counts == sorted(counts) and counts[-1] > 25, f"the bar says how many of 51 frames are read: {said}; also of a field that is chosen meanwhile")
        expect(told[-1].startswith("temperature (K): "), "and no more when all are")
        expect(not page.told, f"the browser complains of nothing {page.told or ''}")


def picture_is_empty(page):
    picture = page.picture()
    left, top, width, height = page.evaluate("(() => { const b = app.panels[0].element.getBoundingClientRect(); return [b.left, b.top, b.width, b.height]; })()")
    return distinct(picture, (left + 0.3 * width, top + 0.2 * height, left + 0.7 * width, top + 0.7 * height)) <= 1


def solid(program, folder):
    print("a bar in space")
    with Viewer(program, folder / "bar", "--field", "pressure") as viewer, Chromium(1280, 800) as page:
        page.open(viewer.address)
        page.wait(SHOWN)
        settle(page)
        before = page.evaluate("app.camera.towards")
        page.drag((450, 300), (520, 260))
        page.wait("!app.isMoving")
        after = page.evaluate("app.camera.towards")
        expect(sum(abs(a - b) for a, b in zip(before, after)) > 0.1, "it is turned by a drag")
        page.press("#view-xz")
        settle(page)
        x, y = page.evaluate("(() => { const b = app.panels[0].element.getBoundingClientRect(); return [b.left + b.width / 2, b.top + b.height / 2]; })()")
        page.click(x, y)
        page.wait("app.picked")
        along = "(() => { const { panel, particle } = app.picked; return panel.data.positions[3 * particle + 1] + panel.run.origin[1]; })()"
        outside = page.evaluate(along)
        page.choose("#section", "y")
        settle(page)
        expect(page.evaluate("app.state.mirror"), "a section through a plane of symmetry shows the images, too")
        expect(page.evaluate("document.getElementById('mirror').checked"), "and their tick says so")
        page.choose("#place", "750")
        settle(page)
        x, y = page.evaluate("(() => { const b = app.panels[0].element.getBoundingClientRect(); return [b.left + b.width / 2, b.top + b.height / 2]; })()")
        page.click(x, y)
        page.wait(f"app.picked && {along} > {outside} + 1e-3")
        expect(True, "a section shows the inside")
        particle = page.evaluate("app.picked.particle")
        page.evaluate("pickParticle(app, app.panels[0], -1)")
        settle(page)
        picture = page.picture()
        expect(near(picture.at(x, y), color_of(page, particle), 8), "the cut has the colours of the bar, without light")
        places = []
        for place in ("300", "900"):
            page.choose("#place", place)
            settle(page)
            places.append(page.evaluate("app.panels[0].at(450, 250)"))
        expect(places[0] != places[1], "the section is moved")
        expect(not page.told, f"the browser complains of nothing {page.told or ''}")


def several(program, folder):
    print("two runs beside each other, and a curve in one dimension")
    with Viewer(program, folder / "plate", folder / "other") as viewer, Chromium(1280, 800) as page:
        page.open(viewer.address)
        page.wait(SHOWN)
        settle(page)
        picture = page.picture()
        boxes = page.evaluate("app.panels.map(({ element }) => { const b = element.getBoundingClientRect(); return [b.left + 40, b.top + 60, b.right - 40, b.bottom - 60]; })")
        expect(len(boxes) == 2 and all(distinct(picture, box) > 20 for box in boxes), "both are drawn")
        expect(page.evaluate("app.curves && document.getElementById('time').max") is not None, "they have one time")
        values = page.evaluate("[...document.querySelectorAll('.chart output')].map((output) => [...output.children].map((one) => one.title.split(':')[0]))")
        expect(values and all(names == ["plate", "other"] for names in values), "beside each chart is the value of each run")
        options = page.evaluate("[...document.querySelectorAll('#field option')].map((option) => option.value)")
        expect("velocity.y" in options and "velocity.z" not in options and "stress.zz" in options and "stress.yz" not in options, "components that are zero in a plane are not offered")
        expect(not page.told, f"the browser complains of nothing {page.told or ''}")
    for width, phone in ((1280, False), (390, True)):
        with Viewer(program, folder / "plate", folder / "longer" / "plate") as viewer, Chromium(width, 800, phone=phone) as page:
            page.open(viewer.address)
            page.wait(SHOWN)
            settle(page)
            if phone:
                page.press("#show-history")
                page.wait("document.getElementById('history').offsetHeight > 100")
            names = page.evaluate("app.panels.map((panel) => panel.heading.querySelector('.name').textContent)")
            expect(names == [f"{folder.name}/plate", "longer/plate"], f"runs of one name are told apart at {width} pixels")
            is_whole = "[...document.querySelectorAll('.heading > *, #history .key span')].every((e) => { const r = e.getBoundingClientRect(); return e.scrollWidth <= e.clientWidth + 1 && r.right <= innerWidth; })"
            expect(page.evaluate(is_whole) and page.evaluate("document.querySelectorAll('#history .key span').length") == 2, "and no label is cut")
    with Viewer(program, folder / "plate", folder / "bar") as viewer, Chromium(1280, 800) as page:
        page.open(viewer.address)
        page.wait(SHOWN)
        settle(page)
        towards = "app.panels.map(({ camera }) => camera.towards)"
        flat, solid = page.evaluate(towards)
        expect(flat == [0, 0, 1] and min(map(abs, solid)) > 0.1 and page.evaluate("document.querySelectorAll('#view-xz').length") == 1, "beside a run in a plane one in space is seen from its corner")
        x, y = page.evaluate("(() => { const b = app.panels[1].element.getBoundingClientRect(); return [b.left + b.width / 2, b.top + b.height / 2]; })()")
        page.drag((x, y), (x + 70, y - 40))
        page.wait("!app.isMoving")
        turned = page.evaluate(towards)
        expect(turned[0] == flat and turned[1] != solid, "and turned by itself")
        page.press("#fit")
        settle(page)
        expect(all(outside(page, panel) == 0 for panel in (0, 1)), "all of both is in the picture")
        cut = """[...document.querySelectorAll('.chart select')].filter((select) => {
          const context = document.createElement('canvas').getContext('2d');
          context.font = getComputedStyle(select).font;
          return context.measureText(select.selectedOptions[0].textContent).width > select.clientWidth - 26;
        }).map((select) => select.value)"""
        page.choose("#column-0", "max_plastic_strain")
        settle(page)
        expect(page.evaluate("document.querySelectorAll('.chart select').length") > 3 and page.evaluate(cut) == [], f"names of columns are whole beside the values of two runs {page.evaluate(cut) or ''}")
        beside = "[...document.querySelectorAll('#controls label > *')].filter((e) => e.offsetParent && e.getBoundingClientRect().right > document.getElementById('controls').getBoundingClientRect().right - 8).map((e) => e.textContent)"
        expect("iron" in page.evaluate("document.querySelector('#body-0').parentElement.textContent") and page.evaluate(beside) == [], "names of bodies stay in the panel")
        expect(not page.told, f"the browser complains of nothing {page.told or ''}")
    with Viewer(program, *(folder / name for name in ("plate", "other", "bar", "longer/plate"))) as viewer, Chromium(390, 844, phone=True) as page:
        page.open(viewer.address)
        page.wait(SHOWN)
        settle(page)
        over = """app.panels.filter(({ element, heading }) => {
          const [room, words] = [element, heading].map((one) => one.getBoundingClientRect());
          return words.height < 20 || words.bottom > room.bottom || words.right > room.right || room.bottom > document.getElementById('bar').getBoundingClientRect().top + 1;
        }).map(({ run }) => run.name)"""
        for width in (390, 320):
            page.resize(width, 844, phone=True)
            for drawer in (None, "controls", "history"):
                if drawer:
                    page.press(f"#show-{drawer}")
                settle(page)
                expect(page.evaluate(over) == [] and too_wide(page) == [], f"what is said of four runs at {width} pixels is over their pictures {f'with {drawer}' if drawer else ''}{page.evaluate(over) or ''}{too_wide(page) or ''}")
            page.press("#show-history")
            settle(page)
    with Viewer(program, folder / "shock") as viewer, Chromium(1280, 800) as page:
        page.open(viewer.address)
        page.wait(SHOWN)
        settle(page)
        expect(page.evaluate("app.panels[0].chart.curves[0].x.length") > 10, "values over x are a curve")
        expect(not page.told, f"the browser complains of nothing {page.told or ''}")


def dead(program, folder):
    print("a program that has ended, and a phone on its side")
    with Viewer(program, folder / "plate") as viewer, Chromium(844, 390, phone=True) as page:
        page.open(viewer.address)
        page.wait(SHOWN)
        settle(page)
        expect(page.evaluate("app.panels[0].element.offsetHeight") > 250, "the picture has most of the height")
        page.press("#show-history")
        page.wait("document.getElementById('history').offsetHeight > 100")
        page.press("#show-history")
        page.wait("document.getElementById('history').offsetHeight === 0")
        expect(True, "the history comes and goes with its button")
        expect(page.evaluate("app.controls.picked.textContent").startswith("ParticleTap "), "on a phone particles are tapped")
        page.evaluate("app.panels[0].run.status = 'running'")
        viewer.process.kill()
        page.wait("app.isGone", 30)
        free = "(() => { const [words, view, time] = ['message', 'view', 'timeline'].map((id) => document.getElementById(id).getBoundingClientRect()); return words.height > 10 && words.bottom <= view.top + 1 && time.bottom <= innerHeight; })()"
        expect(page.evaluate(free), "that it has ended is told above the picture, where it hides nothing")
        expect(page.evaluate("document.getElementById('status').textContent + document.getElementById('status').className") == "no longer told", "nothing is said to run any more")


def phone(program, folder):
    print("a phone")
    with Viewer(program, folder / "bar") as viewer, Chromium(390, 844, phone=True) as page:
        page.open(viewer.address)
        page.wait(SHOWN)
        settle(page)
        expect(page.evaluate("document.documentElement.scrollWidth") <= 390, "the page is no wider than the screen")
        half = page.evaluate("app.camera.half")
        page.pinch(195, 350, 40, 110)
        page.wait(f"app.camera.half < {0.7 * half}")
        expect(True, "two fingers zoom")
        page.evaluate("app.fit()")
        settle(page)
        expect(outside(page) == 0, "all of the bar is in the picture")
        page.tap(*particle_on_page(page, page.evaluate("app.panels[0].particles.surface.faces.numbers[4 * 20]")))
        page.wait("app.picked && !app.panels[0].card.hidden && app.panels[0].card.querySelector('.value')")
        card = page.evaluate("(() => { const r = app.panels[0].card.getBoundingClientRect(); return [r.left, r.top, r.right, r.bottom, app.panels[0].card.textContent]; })()")
        expect(card[0] >= 0 and card[2] <= 390 and card[3] <= 844 and "plastic strain: " in card[4], "a tap shows the number of a particle")
        page.press(".card .all")
        page.wait("document.getElementById('controls').offsetHeight > 100 && document.getElementById('picked').getBoundingClientRect().top < innerHeight")
        expect(True, "and leads to all its numbers")
        page.evaluate("pickParticle(app, app.panels[0], -1)")
        settle(page)
        expect(outside(page) == 0, "with the controls open all of the bar is still in the picture")
        page.press("#show-history")
        page.wait("document.getElementById('history').offsetHeight > 100 && document.getElementById('controls').offsetHeight === 0")
        expect(True, "controls and history open one at a time")
        for width in (390, 320):
            page.resize(width, 844, phone=True)
            settle(page)
            expect(page.evaluate("innerWidth") == width and page.evaluate("document.querySelectorAll('.chart').length") == 1 and too_wide(page) == [], f"nor is anything with the history at {width} pixels {too_wide(page) or ''}")
            whole = page.evaluate("(() => { const r = document.querySelector('.chart').getBoundingClientRect(); return r.left >= 0 && r.right <= innerWidth; })()")
            expect(whole and page.evaluate("document.getElementById('time').offsetWidth") >= 90, "the curve is whole, and the slider of the time can be held")
            page.press("#show-controls")
            settle(page)
            expect(too_wide(page) == [], f"nor with the controls {too_wide(page) or ''}")
            page.press("#show-history")
            settle(page)
        expect(not page.told, f"the browser complains of nothing {page.told or ''}")


def growing(program, folder):
    print("a run that grows")
    run = folder / "growing"
    # The browser starts before the run, which takes some ten seconds: neither may have ended before the other is there.
    deck = [program, "run", "iron-plate", "-o", str(run), "--view", "--no-open", "--threads", "1", "--set", 'particles.spacing="0.3 mm"', "-q"]
    process = None
    try:
        with Chromium(1280, 800) as page:
            process = subprocess.Popen(deck, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
            page.open(process.stderr.readline().strip())
            page.wait(SHOWN)
            page.wait("app.panels[0].run.status === 'running'")
            page.wait("/^\\d+ %: /.test(document.title) && /^running at .* of 60 µs, \\d+ %$/.test(document.getElementById('status').textContent)")
            expect(True, "while it goes on the page and its tab say so, and how far it is")
            page.wait("app.panels[0].run.status === 'completed'", 600)
            page.wait("app.panels[0].frame === app.panels[0].run.times.length - 1")
            frames = page.evaluate("app.panels[0].run.times.length")
            expect(frames == 51, f"its {frames} frames came without a reload, and the last one is shown")
            # Another look at how it grows: some frames, of which not all are listed, then all.
            series = run / "fields.pvd"
            whole = series.read_text(encoding="utf-8")
            (run / "summary.json").rename(run / "summary.away")
            shorter = "\n".join(line for line in whole.splitlines() if not any(f"{k:06}.vtp" in line for k in range(20, 51)))
            series.write_text(shorter, encoding="utf-8")
            held = folder / "held"
            held.mkdir()
            for k in range(30, 51):
                (run / f"fields/{k:06}.vtp").rename(held / f"{k:06}.vtp")
            page.wait("app.panels[0].run.times.length === 30 && app.panels[0].frame === 29")
            page.wait("document.getElementById('status').textContent.startsWith('interrupted at ')")
            expect(True, "a run that nobody writes and that has not ended is called so")
            for frame in held.iterdir():
                frame.rename(run / "fields" / frame.name)
            page.wait("app.panels[0].run.times.length === 51 && app.panels[0].frame === 50")
            expect(True, "frames are there before they are listed")
            # Checks that warn are counted in the history, and named in a summary.
            history = run / "history.csv"
            rows = history.read_text(encoding="utf-8").splitlines()
            at = rows[0].split(",").index("warnings")
            warned = [",".join([*row.split(",")[:at], "2", *row.split(",")[at + 1 :]]) if k > 100 else row for k, row in enumerate(rows)]
            history.write_text("\n".join(warned) + "\n", encoding="utf-8")
            page.wait("document.getElementById('status').textContent.endsWith(', 2 warnings')")
            expect("2 checks have warned" in page.evaluate("document.getElementById('controls').textContent"), "checks that have warned are counted before a run ends")
            history.write_text("\n".join(rows) + "\n", encoding="utf-8")
            page.wait("!document.getElementById('status').textContent.includes('warn')")
            series.write_text(whole, encoding="utf-8")
            page.wait("app.panels[0].run.times.length === 51 && app.panels[0].frame === 50")
            expect(True, "who looks at the last frame goes on to the new one")
            run.rename(folder / "away")
            page.wait("app.panels[0].trouble.includes('does not exist')")
            expect(not picture_is_empty(page), "of a folder that has vanished the last picture stays, and it is told")
            page.choose("#time", "3")
            settle(page)
            page.wait("document.getElementById('status').textContent === 'cannot be read now' && document.title.startsWith('cannot be read now: ')")
            page.choose("#time", "50")
            page.wait("app.panels[0].frame === 50")
            expect(True, "also in the title, whatever time is chosen")
            (folder / "away").rename(run)
            page.wait("app.panels[0].trouble === ''")
            process.kill()
            page.wait("document.getElementById('message').textContent.includes('has ended')")
            expect(True, "that the program has ended is told")
    finally:
        if process:
            process.kill()
            process.wait()


def single(program, folder):
    print("a single page")
    to = folder / "page.html"
    subprocess.run([program, "view", str(folder / "plate"), "-o", str(to)], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    with Chromium(1280, 800) as page:
        page.open(to.resolve().as_uri())
        page.wait(SHOWN)
        settle(page)
        picture = page.picture()
        count = page.evaluate("app.panels[0].particles.count")
        page.press("#edges")
        settle(page)
        picture = page.picture()
        seen = [k for k in range(7, count, count // 12) if near(picture.at(*particle_on_page(page, k)), color_of(page, k))]
        expect(len(seen) >= 11, f"{to.stat().st_size / 1e6:.1f} MB: {len(seen)} of 12 particles have their colour")
        page.click(*particle_on_page(page, count // 3))
        page.wait("app.picked && document.querySelectorAll('#picked td').length > 6")
        expect(page.evaluate("app.picked.particle") == count // 3, "a particle is picked")
        expect("rounded" in page.evaluate("document.getElementById('controls').textContent"), "what was left out is told")
        expect(page.evaluate("performance.getEntriesByType('resource').filter(({ name }) => !name.startsWith('data:')).length") == 0, "nothing is fetched")
        expect(not page.told, f"the browser complains of nothing {page.told or ''}")


def machine():
    """What these figures are of."""
    model = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo", encoding="utf-8") if line.startswith("model name")), platform.processor())
    return f"{model}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}"


def measure(program, folder):
    """Pictures a second and the time to the first one, with a card or by software, whatever the browser has."""
    rows = []
    for name, spacing in (("20 000", "0.2428 mm"), ("200 000", "0.1127 mm"), ("2 000 000", "0.0523 mm")):
        run = folder / name.replace(" ", "")
        if not run.exists():
            deck = [program, "run", "copper-bar", "-o", str(run), "-q", "--set", f'particles.spacing="{spacing}"', "--set", "time.max-steps=2"]
            subprocess.run([*deck, "--set", "output.frames=1"], check=True, stdout=subprocess.DEVNULL)
        with Viewer(program, run) as viewer, Chromium(1280, 800) as page:
            began = time.monotonic()
            page.open(viewer.address)
            page.wait(SHOWN, 600)
            page.evaluate("new Promise((done) => requestAnimationFrame(done)).then(() => app.graphics.gl.finish())", 300)
            first = time.monotonic() - began
            # As it is while a finger turns it: the picture is read back, so that it is whole.
            turn = """(async (detail) => {
              const pixel = new Uint8Array(4), { gl } = app.graphics, times = [];
              app.isMoving = true;
              app.detail = detail;
              for (let k = 0; k < 16; k += 1) {
                app.camera.turn(0.02, 0.005);
                const began = performance.now();
                app.paint();
                gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
                times.push(performance.now() - began);
                app.detail = detail;
              }
              app.isMoving = false;
              return times.sort((a, b) => a - b)[8];
            })"""
            rates = [1000 / page.evaluate(f"{turn}({detail})", 600) for detail in range(2)]
            count, faces = page.evaluate("[app.panels[0].particles.count, app.panels[0].particles.surface.faces.count]")
            card = page.evaluate("(() => { const { gl } = app.graphics, e = gl.getExtension('WEBGL_debug_renderer_info'); return e ? gl.getParameter(e.UNMASKED_RENDERER_WEBGL) : 'unknown'; })()")
            rows.append({"particles": count, "faces": faces, "first_picture_s": round(first, 2), "pictures_per_second": dict(zip(("cells", "cells_half_resolution"), (round(rate, 1) for rate in rates)))})
            print(f"  {count} particles, {faces} faces: first picture after {first:.1f} s; turning {rates[0]:.1f} pictures/s, in half the resolution {rates[1]:.1f}", flush=True)
    told = {"machine": machine(), "renderer": card, "window": [1280, 800], "runs": rows}
    (folder / "frames.json").write_text(json.dumps(told, indent=2) + "\n", encoding="utf-8")
    print(f"  {machine()}; {card}; {folder / 'frames.json'}")


def main():
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    if not find():
        print("skipped: no Chromium here (Debian: apt install chromium)")
        return
    if "--measure" in sys.argv:
        folder.mkdir(parents=True, exist_ok=True)
        return measure(program, folder)
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for name, deck in {
        "plate": ["iron-plate", *COARSE],
        "other": ["taylor-plate", *COARSE],
        "bar": ["copper-bar", *BAR],
        "five": ["copper-bar", "--set", 'particles.spacing="1.27 mm"', "--set", "output.frames=4", "-q"],
        "longer/plate": ["iron-plate", "--set", 'particles.spacing="1 mm"', "-q"],
        "shock": ["plate-impact", "--set", 'time.end="3 us"', "-q"],
    }.items():
        subprocess.run([program, "run", *deck, "-o", str(folder / name)], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    for check in (plane, typed, slow, solid, coarse, several, phone, dead, connections, growing, single):
        check(program, folder)


if __name__ == "__main__":
    main()
