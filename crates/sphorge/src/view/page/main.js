// The page: what is shown, and what brings it up to date.
"use strict";

/** Seconds between two looks at a run that goes on, and at one that has ended. */
const LOOK = 1;
const SELDOM = 5;
/** A picture that takes longer, s, is drawn in less detail while it moves. */
const SLOW = 0.04;
/** How many pixels a picture has for one of the page, each way, while it moves: as on the screen, half as many, and with squares for balls. */
const DETAIL = [1, 0.5, 0.5];
const COARSEST = DETAIL.length - 1;
/** The same at rest: smooth edges. */
const AT_REST = 2;

/** Reading that takes longer is told, ms. */
const PATIENCE = 300;

/** Least width of a panel beside others, pixels. */
const LEAST_PANEL = 260;

/** Whole per cent of its time that a run has come to. */
const percent = ({ reached, end }) => Math.floor((100 * Math.min(reached ?? 0, end)) / end + 1e-9);

/** What is said of runs when nobody tells any more. */
const UNKNOWN = "no longer told";
/** The same of a run whose folder cannot be read. */
const LOST = "cannot be read now";

/** How many checks of a run have warned, in words, where its status does not tell. */
function warned({ status, warned: count }) {
  return count > 0 && !status.includes("warnings") ? `${count} ${count === 1 ? "warning" : "warnings"}` : "";
}

/** How far a run is, in words. */
function howFar(run) {
  const { status, reached, end } = run;
  if (run.error || reached === null) return run.error ? LOST : `${status}, no frame yet`;
  const isWhole = status.startsWith("completed") || !(end > 0);
  const far = isWhole ? [] : [`of ${quantity(end, "s")}, ${percent(run)} %`];
  return [[`${status} at ${quantity(reached, "s")}`, ...far].join(" "), warned(run)].filter(Boolean).join(", ");
}

/** What checks have found of a run; nothing if nothing. */
function broken({ name, warnings, warned: count }) {
  const others = count - warnings.length;
  if (count === 0) return null;
  const names = warnings.length > 0 ? `warnings: ${warnings.join(", ")}` : "";
  const unnamed = others > 0 ? `${others} ${others === 1 ? "check has" : "checks have"} warned${names ? " since" : ""}; ${others === 1 ? "it is" : "they are"} named where it runs, and here when it ends` : "";
  return `${name}: ${[names, unnamed].filter(Boolean).join("; ")}`;
}

/** Bodies by name, with what each is made of in the runs: where they differ, which run says what. */
function commonBodies(runs) {
  const names = [...new Set(runs.flatMap((run) => run.bodies).map(({ name }) => name))];
  return names.map((name) => {
    const found = runs.flatMap((run) => run.bodies.filter((body) => body.name === name).map(({ material }) => [run.name, material]));
    const isOne = found.length === runs.length && found.every(([, material]) => material === found[0][1]);
    return { name, material: isOne ? found[0][1] : found.map(([run, material]) => (material ? `${run}: ${material}` : run)).join("; ") };
  });
}

class App {
  panels = [];
  camera = new Camera();
  /** That of runs in a plane beside runs in space, which have a direction of their own. */
  flat = new Camera();
  picked = null;
  /** The program that the page came from does not answer. */
  isGone = false;
  fields = [];
  bodies = [];
  views = [];
  textures = { bodies: [], map: null };
  colors = null;
  /** How coarse pictures are while they move. */
  detail = 0;
  /** Ranges of fields by run and frame. */
  #ranges = new Map();
  #pixel = new Uint8Array(4);
  #isFitted = false;
  #isDue = false;
  #settle = 0;

  async open() {
    const of = (id) => document.getElementById(id);
    this.source = openSource();
    this.store = new Store(this.source);
    this.graphics = new Graphics(of("picture"));
    of("picture").addEventListener("webglcontextlost", (event) => event.preventDefault());
    // What was on the card is made again by making the page again.
    of("picture").addEventListener("webglcontextrestored", () => location.reload());
    this.opening = await this.source.opening();
    this.maps = decodedMaps(this.opening.maps);
    const { start } = this.opening;
    this.state = {
      field: start.field,
      map: start.map,
      ranges: start.range ? "fixed" : "all",
      fixed: start.range,
      hidden: new Set(),
      walls: true,
      mirror: start.mirror,
      edges: true,
      balls: false,
      section: null,
      time: start.time,
    };
    this.controls = new Controls(this, of("controls"));
    this.timeline = new Timeline(this);
    this.curves = new Curves(this, of("history"));
    this.pointers = new Pointers(this, of("panels"));
    for (const name of ["controls", "history"]) {
      of(`show-${name}`).addEventListener("click", () => {
        openDrawer(name, true);
        this.curves.draw();
      });
    }
    new ResizeObserver(() => {
      this.#columns();
      this.draw();
    }).observe(of("panels"));
    new ResizeObserver(() => this.curves.draw()).observe(of("history"));
    await this.#look();
  }

  isSolid() {
    return this.panels.some(({ run }) => run.dimensions === 3);
  }

  hasSymmetry() {
    return this.panels.some(({ run }) => run.symmetry.length > 0 && run.dimensions > 1);
  }

  hasWalls() {
    return this.panels.some(({ run }) => run.walls.length > 0 && run.dimensions > 1);
  }

  hasCells() {
    return this.panels.some(({ run }) => run.has_cells);
  }

  warnings() {
    return this.panels.map(({ run }) => broken(run)).filter(Boolean);
  }

  /** The runs that are seen through a camera. */
  #seenBy(camera) {
    return this.panels.filter((panel) => panel.camera === camera);
  }

  /** The box of all runs that turn together, m. */
  box(camera = this.camera) {
    return this.#seenBy(camera).reduce((box, panel) => joinedBox(box, panel.whole()), null);
  }

  say(text) {
    const element = document.getElementById("message");
    element.textContent = text;
    element.hidden = !text;
  }

  /** Looks at the runs again and again: frames that are new appear. */
  async #look() {
    for (;;) {
      let wait = LOOK;
      try {
        const runs = await this.source.runs();
        if (this.isGone) [this.isGone, this.troubles] = [false, null];
        await this.#take(runs);
        this.say("");
        if (runs.every((run) => !run.is_open)) wait = SELDOM;
      } catch (error) {
        if (!(error instanceof Gone)) throw error;
        this.say(error.message);
        this.isGone = true;
        if (this.panels.length > 0) this.#title();
        this.draw();
        wait = SELDOM;
      }
      if (!this.source.isLive) return;
      await new Promise((done) => setTimeout(done, 1000 * wait));
    }
  }

  async #take(runs) {
    if (this.panels.length === 0) {
      this.panels = runs.map((_, number) => new Panel(this, number));
      document.getElementById("panels").append(...this.panels.map((panel) => panel.element));
      this.#columns();
    }
    const state = (run) => [run?.times.length, run?.rows, run?.status, run?.warned, run?.identity];
    const before = JSON.stringify(this.panels.map(({ run }) => state(run)));
    this.panels.forEach((panel, k) => {
      if (panel.describe(runs[k])) {
        for (const key of this.#ranges.keys()) if (key.startsWith(`${k}/`)) this.#ranges.delete(key);
      }
    });
    const now = JSON.stringify(this.panels.map(({ run }) => state(run)));
    const troubles = this.panels.map(({ trouble }) => trouble).join();
    if (before === now && troubles === this.troubles) return;
    this.troubles = troubles;
    const shown = this.panels.map(({ run }) => run);
    this.#title();
    this.#common(shown);
    this.timeline.setTimes(shown);
    this.controls.build();
    await Promise.all([this.refresh(), this.curves.read()]);
  }

  /** How many panels are beside each other: as many as leave each wide enough. */
  #columns() {
    const { length } = this.panels;
    const grid = document.getElementById("panels");
    document.body.classList.toggle("several", length > 1);
    const most = Math.max(Math.floor(grid.clientWidth / LEAST_PANEL), 1);
    const wide = length <= 3 ? length : Math.ceil(Math.sqrt(length));
    grid.style.gridTemplateColumns = `repeat(${Math.max(Math.min(most, wide), 1)}, 1fr)`;
  }

  /** What is shown, and how far it is: in the page, and in the tab. */
  #title() {
    const { panels } = this;
    const runs = panels.map(({ run }) => run);
    const titles = [...new Set(runs.map((run) => run.title))];
    const title = titles.length > 3 ? `${titles[0]} and ${titles.length - 1} others` : titles.join("; ");
    const of = (id) => document.getElementById(id);
    of("title").textContent = title;
    of("title").title = title;
    const running = this.isGone ? 0 : panels.filter(({ run, isLost }) => run.status === "running" && !isLost).length;
    // Of several runs each says it above its picture.
    if (this.isGone) of("status").textContent = UNKNOWN;
    else of("status").textContent = runs.length === 1 ? panels[0].howFar() : `${runs.length} runs, ${running} running`;
    of("status").classList.toggle("runs", running > 0);
    const short = ({ run, isLost }) => (this.isGone ? UNKNOWN : isLost ? LOST : run.status === "running" && run.end > 0 ? `${percent(run)} %` : run.status);
    document.title = `${[...new Set(panels.map(short))].join(", ")}: ${title} - Sphorge`;
  }

  /** Fields, bodies and views of all runs. */
  #common(runs) {
    const merged = (name) => [...new Map(runs.flatMap((run) => run[name]).reverse().map((one) => [one.name, one])).values()].reverse();
    const order = new Map(runs.flatMap((run) => run.fields).map((field, k) => [field.name, k]));
    this.fields = merged("fields").filter((field) => runs.every((run) => run.times.length === 0 || run.fields.some(({ name }) => name === field.name))).sort((a, b) => order.get(a.name) - order.get(b.name));
    this.bodies = commonBodies(runs);
    const deepest = Math.max(...runs.map((run) => run.dimensions));
    this.views = runs.find((run) => run.dimensions === deepest)?.views ?? [];
    const isKnown = (asked) => this.fields.some(({ name }) => name === asked || name === asked?.split(".")[0]);
    if (this.fields.length > 0 && !isKnown(this.state.field)) this.state.field = this.fields[0].name;
    const { bodies } = this.opening.start;
    if (bodies.length > 0 && this.bodies.length > 0) {
      for (const { name } of this.bodies) if (!bodies.includes(name)) this.state.hidden.add(name);
      this.opening.start.bodies = [];
    }
    runs.forEach((run, k) => {
      const texels = new Float32Array(4 * Math.max(run.bodies.length, 1));
      run.bodies.forEach((body, at) => texels.set([body.spacing, 1, 0, 0], 4 * at));
      this.textures.bodies[k] = this.graphics.numbers(texels, texels.length / 4, 1, this.textures.bodies[k]);
    });
  }

  /** Shows the frames of the time and the field that are chosen. */
  async refresh() {
    const { state } = this;
    if (!state.field) return this.draw();
    const turn = (this.turn = (this.turn ?? 0) + 1);
    try {
      await Promise.all(this.panels.map((panel) => panel.load(panel.nearest(state.time), state.field)));
    } catch (error) {
      if (error instanceof Gone) this.say(error.message);
      else for (const panel of this.panels) panel.trouble ||= error.message;
    }
    if (turn !== this.turn) return undefined;
    for (const panel of this.panels) if (panel.frame >= 0) this.#ranges.set(`${panel.number}/${panel.frame}/${panel.field}`, panel.head);
    this.#bodies();
    this.#color();
    if (!this.#isFitted && this.panels.some(({ box }) => box)) await this.#first();
    this.controls.show();
    this.draw();
    if (this.picked) showPicked(this);
    else if (this.controls.picked.childElementCount === 0) showPicked(this);
    this.#readRanges();
    return undefined;
  }

  /** The first picture: the view, the section that was asked for, and all of the first frame and the last. */
  async #first() {
    this.#isFitted = true;
    const { start } = this.opening;
    const axes = start.view ?? this.views[0]?.[1];
    if (axes) this.camera.look(axes);
    for (const panel of this.panels) {
      if (panel.frame < 0) continue;
      const head = await this.store.range(panel.number, 0, "position");
      panel.first = Array.from(head.slice(0, 6)).map((place, k) => place + panel.run.origin[k >> 1]);
    }
    if (start.section) this.cut(start.section.normal, start.section.point);
    this.fit();
  }

  fit() {
    for (const camera of [this.camera, this.flat]) {
      const box = this.#seenBy(camera).reduce((whole, { first }) => joinedBox(whole, first), this.box(camera));
      if (box) camera.fit(box);
    }
    this.draw();
  }

  /** Cuts along a plane across a normal, at a point or in the middle, where a plane of symmetry is if there is one; none without a normal. */
  cut(normal, point = null) {
    const box = this.box();
    if (!normal || !box) {
      this.state.section = null;
      return;
    }
    const [low, high] = boxAlong(box, normal);
    const axis = [0, 1, 2].find((k) => Math.abs(normal[k]) > 0.999);
    const plane = this.panels.flatMap(({ run }) => run.symmetry).find(([own]) => own === axis);
    const middle = plane ? normal[axis] * plane[1] : 0.5 * (low + high);
    // The middle layer of an odd number stays whole.
    this.state.section = { normal, offset: (point ? dot(normal, point) : middle) + 1e-6 * (high - low) };
    if (plane && !point && !this.state.mirror) {
      this.state.mirror = true;
      this.fit();
    }
  }

  /** Which bodies are shown. */
  #bodies() {
    this.panels.forEach(({ run }, k) => {
      const texels = new Float32Array(4 * Math.max(run.bodies.length, 1)).fill(1);
      run.bodies.forEach((body, at) => texels.set([body.spacing, this.state.hidden.has(body.name) ? 0 : 1], 4 * at));
      this.graphics.numbers(texels, texels.length / 4, 1, this.textures.bodies[k]);
    });
  }

  /** From values to colours, for all panels the same. */
  #color() {
    const { state, opening, panels } = this;
    const heads = [...this.#ranges].filter(([key]) => {
      const [run, frame, field] = key.split("/");
      return field === state.field && (state.ranges === "all" || panels[run].frame === Number(frame));
    });
    const range = rangeOfFrames(heads.map(([, head]) => head));
    const [name, component] = (state.field ?? "").split(".");
    const field = this.fields.find((known) => known.name === state.field) ?? this.fields.find((known) => known.name === name);
    const label = component && field?.name === name ? `${field.label} ${component}` : field?.width > 1 ? `${field.label} (magnitude)` : (field?.label ?? "");
    const found = limits(range, state.map, state.ranges === "fixed" ? state.fixed : null);
    const flag = opening.flags.find((own) => own.name === name);
    let key = null;
    let table = this.maps[found.map];
    let whole = 0;
    if (name === "body") {
      key = this.panels.reduce((best, { run }) => (run.bodies.length > best.length ? run.bodies : best), []).map((body) => [body.color, body.name]);
    } else if (flag) {
      key = [1, 0].map((k) => [flag.colors[k], flag.words[k]]);
    } else if (found.isSingle && range) {
      key = [[opening.single, `${quantity(Math.abs(found.single) < Number.MIN_VALUE ? 0 : found.single, field?.unit ?? "")} everywhere`]];
    }
    if (name === "body" || flag) {
      const colors = name === "body" ? key.map(([color]) => color) : flag.colors;
      whole = Math.max(colors.length, 1);
      table = new Uint8Array(colors.length > 0 ? colors.flat() : [128, 128, 128]);
    }
    this.textures.map = this.graphics.colors(table, table.length / 3, this.textures.map ?? undefined);
    this.colors = { ...found, label, unit: field?.unit ?? "", key, whole, isSingle: Boolean(key) && whole === 0, table };
  }

  /** Reads the ranges of all frames, one after the other, where the bar is to have one scale, and says how far it is. */
  async #readRanges() {
    if (this.isReading) return;
    this.isReading = true;
    const began = performance.now();
    try {
      // Another field may be chosen meanwhile.
      while (!(await this.#readRangesOf(this.state.field, began)));
    } catch {
      // What could not be read is read with the next frame that is shown.
    }
    this.isReading = false;
    if (this.reading) {
      this.reading = null;
      this.#bar();
    }
  }

  /** The same of one field; false if another one was chosen meanwhile. */
  async #readRangesOf(field, began) {
    const all = this.panels.reduce((sum, { run }) => sum + run.times.length, 0);
    let count = 0;
    for (const { number, run } of this.panels) {
      for (let frame = run.times.length - 1; frame >= 0; frame -= 1) {
        if (this.state.ranges !== "all") return true;
        count += 1;
        const key = `${number}/${frame}/${field}`;
        if (this.#ranges.has(key)) continue;
        const head = await this.store.range(number, frame, field);
        this.#ranges.set(key, head);
        if (field !== this.state.field) return false;
        const { low, high } = this.colors;
        this.#color();
        // What is done at once need not be told.
        if (performance.now() - began > PATIENCE) this.reading = { field, words: `reading frames, ${count} of ${all}` };
        if (low !== this.colors.low || high !== this.colors.high) {
          this.controls.show();
          this.draw();
        } else if (this.reading) this.#bar();
      }
    }
    return true;
  }

  ahead(time) {
    for (const panel of this.panels) panel.ahead(panel.nearest(time), this.state.field);
  }

  /** The picture moves: it is drawn in less detail if it must, and in full when it has come to rest. */
  moving() {
    this.isMoving = true;
    clearTimeout(this.#settle);
    this.#settle = setTimeout(() => {
      this.isMoving = false;
      this.draw();
    }, 180);
    this.draw();
  }

  draw() {
    if (this.#isDue) return;
    this.#isDue = true;
    requestAnimationFrame(() => {
      this.#isDue = false;
      this.paint();
    });
  }

  /** Draws all panels, the bar and the cursors of the curves. */
  paint() {
    const { graphics, colors } = this;
    const { gl, canvas } = graphics;
    // A curve has an axis in its place. Before all else: it takes room from the panels.
    const hasBar = !this.panels.some(({ run }) => run.dimensions === 1);
    document.getElementById("bar").hidden = !hasBar;
    const { width, height } = canvas.getBoundingClientRect();
    const isMoving = this.isMoving || this.timeline.isPlaying;
    // More pixels than two of the screen's own are not seen.
    const fine = isMoving ? DETAIL[this.detail] * Math.min(window.devicePixelRatio || 1, 2) : AT_REST;
    const size = [Math.max(Math.round(width * fine), 1), Math.max(Math.round(height * fine), 1)];
    if (canvas.width !== size[0] || canvas.height !== size[1]) [canvas.width, canvas.height] = size;
    gl.disable(gl.SCISSOR_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.clearColor(1, 1, 1, 1);
    gl.clearStencil(1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT | gl.STENCIL_BUFFER_BIT);
    gl.enable(gl.SCISSOR_TEST);
    const began = performance.now();
    if (colors) for (const panel of this.panels) panel.draw(isMoving);
    this.#measure(began, isMoving);
    if (colors && hasBar) this.#bar();
    this.curves.draw();
    this.pictures = (this.pictures ?? 0) + 1;
  }

  /** Learns from pictures in full detail how long they take; the card works on after the calls have returned. */
  #measure(began, isMoving) {
    if (!isMoving || this.detail === COARSEST) return;
    const { gl } = this.graphics;
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, this.#pixel);
    if (performance.now() - began > 1000 * SLOW) this.detail += 1;
  }

  /** The bar of colours, drawn again when it is another one. */
  #bar() {
    const element = document.getElementById("bar");
    if (element.hidden) return;
    const { table, ...rest } = this.colors;
    // The count of a field is not that of one that is chosen meanwhile.
    const reading = this.reading?.field === this.state.field ? this.reading.words : "";
    const key = JSON.stringify([rest, reading, element.clientWidth, element.clientHeight, window.devicePixelRatio]);
    if (key === this.barKey) return;
    this.barKey = key;
    drawBar(element, { ...rest, map: table, reading });
  }

  /** Picks the particle at a place of a panel, or beside it as far as a finger is wide, pixels. */
  pick(panel, x, y, wide = 0) {
    if (!this.colors) return;
    let found = panel.at(x, y);
    for (let k = 0; k < 8 && found < 0 && wide > 0; k += 1) found = panel.at(x + wide * Math.cos((k * Math.PI) / 4), y + wide * Math.sin((k * Math.PI) / 4));
    pickParticle(this, panel, found);
  }
}

const app = new App();
app.open().catch((error) => app.say(error.message));
