// One run on the page: its frame, where it is drawn, what stands over it.
"use strict";

/** Fewer balls than these are drawn as they are while they move. */
const MANY = 20000;
/** What is drawn of a body that is cut, of all images one after the other. */
const PARTS = ["outside", "cut", "slivers"];
/** How far from a plane of symmetry what is in it may be, spacings. */
const IN_PLANE = 5e-3;
/** Less height than this, pixels, leaves no room for all that is said of one of several runs, and for the arrows along the axes. */
const LOW_PANEL = 210;
const LOWEST_PANEL = 110;
const NO_NODES = { places: new Float32Array(0), parted: new Uint32Array(0), torn: new Uint32Array(0) };

class Panel {
  /** Position of a particle that is picked, from the origin of the run, m. */
  picked = null;
  frame = -1;
  trouble = "";
  #turn = 0;
  #identity = null;

  constructor(app, number) {
    this.app = app;
    this.number = number;
    this.element = document.createElement("div");
    this.element.className = "panel";
    this.element.innerHTML = '<canvas></canvas><div class="heading"></div><div class="card" role="status" hidden></div>';
    [this.overlay, this.heading, this.card] = this.element.children;
    this.particles = new Particles(app.graphics);
  }

  /** Through which it is seen: a run in a plane does not turn with those in space beside it. */
  get camera() {
    return this.run?.dimensions < 3 && this.app.isSolid() ? this.app.flat : this.app.camera;
  }

  /** Takes what there is of the run now; true if it is another run than before. */
  describe(run) {
    const isOther = this.#identity !== null && run.identity !== this.#identity && run.identity !== "";
    if (isOther) {
      this.app.store.reset(this.number);
      this.particles = new Particles(this.app.graphics);
      this.frame = -1;
      this.picked = null;
      this.box = null;
      this.hasSentCells = false;
    }
    if (run.identity !== "") this.#identity = run.identity;
    this.trouble = run.error ?? "";
    this.isLost = Boolean(run.error);
    // What was read of a folder that has vanished is still there to be seen.
    if (!run.error || !this.run) this.run = run;
    this.isOpen = run.is_open;
    return isOther;
  }

  /** How far the run is, in words, or that nobody knows. */
  howFar() {
    return this.app.isGone ? UNKNOWN : this.isLost ? LOST : howFar(this.run);
  }

  /** The frame nearest to a time. */
  nearest(time) {
    const { times } = this.run;
    let best = times.length - 1;
    times.forEach((own, k) => {
      if (Math.abs(own - time) < Math.abs(times[best] - time)) best = k;
    });
    return best;
  }

  /** Arrays of a frame, which are asked for before it is shown. */
  #read(frame, field) {
    const { store } = this.app;
    const { run, number } = this;
    const has = (name) => run.fields.some((known) => known.name === name);
    // A single page has it without listing it.
    const deforms = run.has_cells && (has("deformation_gradient") || !this.app.source.isLive);
    const nothing = Promise.resolve({ head: [], values: new Float32Array(0) });
    return Promise.all([
      store.array(number, frame, "position"),
      store.array(number, frame, field),
      deforms ? store.nodes(number, frame) : NO_NODES,
      has("body") ? store.array(number, frame, "body") : nothing,
    ]);
  }

  ahead(frame, field) {
    if (frame < this.run.times.length) this.#read(frame, field).catch(() => {});
  }

  /** Shows a frame; false if another one was asked for meanwhile. */
  async load(frame, field) {
    this.#turn += 1;
    const turn = this.#turn;
    if (frame < 0) return true;
    const [positions, values, nodes, bodies] = await this.#read(frame, field);
    if (this.run.has_cells && !this.hasSentCells) {
      const cells = await this.app.store.cells(this.number);
      if (turn !== this.#turn) return false;
      this.particles.setCells(cells);
      this.hasSentCells = true;
    }
    if (turn !== this.#turn) return false;
    const count = positions.values.length / 3;
    const numbers = bodies.values.length === count ? bodies.values : (this.noBodies ??= new Float32Array(count));
    // Numbers of a single page are rounded.
    const near = IN_PLANE * (this.run.bodies[0]?.spacing ?? 0);
    const planes = this.run.symmetry.map(([axis, place]) => [axis, place - this.run.origin[axis], near]);
    this.particles.set({ positions: positions.values, values: values.values, nodes, bodies: numbers, planes });
    this.data = { positions: positions.values, values: values.values, bodies: numbers };
    this.head = values.head;
    this.frame = frame;
    this.field = field;
    this.place = Array.from(positions.head.slice(0, 6));
    this.box = this.place.map((place, k) => place + this.run.origin[k >> 1] + (k % 2 === 0 ? -0.5 : 0.5) * (this.run.bodies[0]?.spacing ?? 0));
    if (this.picked && 3 * this.picked.particle < positions.values.length) {
      this.picked.position = positions.values.slice(3 * this.picked.particle, 3 * this.picked.particle + 3);
    }
    return true;
  }

  /** The box of all that is drawn, images in planes of symmetry too, m. */
  whole() {
    let { box } = this;
    for (const [axis, place] of box && this.app.state.mirror ? this.run.symmetry : []) {
      const image = [...box];
      [image[2 * axis], image[2 * axis + 1]] = [2 * place - box[2 * axis + 1], 2 * place - box[2 * axis]];
      box = joinedBox(box, image);
    }
    return box;
  }

  /** Where it is on the canvas, pixels of the page. */
  rectangle() {
    const of = this.app.graphics.canvas.getBoundingClientRect();
    const own = this.element.getBoundingClientRect();
    return { left: own.left - of.left, top: own.top - of.top, width: own.width, height: own.height };
  }

  /** From metres to the window, and metres of a pixel. */
  measure() {
    const { camera } = this;
    const { width, height } = this.rectangle();
    const pixel = camera.pixel(width, height);
    const box = this.whole();
    const far = Math.hypot(box[1] - box[0], box[3] - box[2], box[5] - box[4]);
    const middle = [0, 1, 2].map((axis) => 0.5 * (box[2 * axis] + box[2 * axis + 1]));
    const depth = 0.8 * far + Math.hypot(...minus(middle, camera.middle)) + camera.half * 0.02;
    return { pixel, scale: [2 / (width * pixel), 2 / (height * pixel), 1 / (1.2 * depth)], width, height };
  }

  /** How particles are drawn now. */
  how(isMoving) {
    const { state } = this.app;
    const cells = this.particles.hasCells && !state.balls;
    const how = cells ? "cells" : "balls";
    return isMoving && how === "balls" && this.app.detail === COARSEST && this.particles.count > MANY ? "points" : how;
  }

  /** Draws the particles with each combination of mirrors. */
  #particles(how, { pixel, scale }, picks) {
    const { state, textures, colors, opening, graphics } = this.app;
    const { run, camera } = this;
    const planes = state.mirror ? run.symmetry : [];
    const isFlat = run.dimensions < 3;
    const cut = camera === this.app.camera ? state.section : null;
    const far = 1e30;
    const letters = (this.field ?? "").split(".")[1] ?? "";
    const all = Array.from({ length: 2 ** planes.length }, (_, images) => {
      const [mirror, shift] = [[1, 1, 1], [0, 0, 0]];
      let sign = 1;
      planes.forEach(([axis, place], k) => {
        if (((images >> k) & 1) === 0) return;
        mirror[axis] = -1;
        shift[axis] = 2 * (place - run.origin[axis]);
        if (letters.split("xyz"[axis]).length % 2 === 0) sign = -sign;
      });
      return { mirror, shift, sign };
    });
    const offset = cut && cut.offset - dot(cut.normal, run.origin);
    const fine = graphics.fine();
    const before = ON_CUT * Math.max(...run.bodies.map(({ spacing }) => spacing), 0);
    const parts = cut && how === "cells" && !isFlat ? PARTS : PARTS.slice(0, 1);
    const drawImage = (part, { mirror, shift, sign }, image) => {
      // The plane as it lies to the particles themselves in this image.
      const plane = cut && [...cut.normal.map((n, axis) => n * mirror[axis]), offset - dot(cut.normal, shift)];
      const look = {
        u_axes: [...camera.right, ...camera.up, ...camera.towards],
        u_middle: minus(camera.middle, run.origin),
        u_scale: scale,
        u_mirror: mirror,
        u_shift: shift,
        u_sign: sign,
        u_cut: cut ? [...cut.normal, offset] : [0, 0, 0, far],
        u_bodies: textures.bodies[this.number],
        u_map: textures.map,
        u_range: [colors.low, colors.high, colors.whole, colors.isSingle ? 1 : 0],
        u_single: opening.single.map((c) => c / 255),
        u_no_value: opening.no_value.map((c) => c / 255),
        u_light: opening.light,
        u_darkest: opening.darkest,
        u_shade: isFlat ? 0 : 1,
        u_edges: state.edges ? 1 : 0,
        u_pick: picks ? 1 : 0,
        u_pixels: fine / pixel,
        u_fine: fine,
        u_least: 1.3 * pixel,
        u_is_cut: 0,
      };
      this.particles.draw(how, look, { isFlat, image, plane, before, part, isMirrored: mirror[0] * mirror[1] * mirror[2] < 0, hasImages: planes.length > 0, picks });
    };
    for (const part of parts) all.forEach((image, k) => drawImage(part, image, k));
    graphics.gl.bindVertexArray(null);
  }

  draw(isMoving) {
    const { graphics, state } = this.app;
    const { camera } = this;
    const { gl } = graphics;
    const { left, top, width, height } = this.rectangle();
    if (width < 1 || height < 1) return;
    const fine = graphics.fine();
    const view = [left * fine, graphics.canvas.height - (top + height) * fine, width * fine, height * fine].map(Math.round);
    gl.viewport(...view);
    gl.scissor(...view);
    if (this.frame < 0 || !this.box || this.run.dimensions === 1) {
      this.#caption();
      return;
    }
    const measured = this.measure();
    const isFlat = this.run.dimensions < 3;
    if (isFlat) gl.disable(gl.DEPTH_TEST);
    else gl.enable(gl.DEPTH_TEST);
    // In a plane walls lie below, in space they are where they are.
    if (state.walls) drawWalls(graphics, camera, this.run.walls, this.frame, this.whole(), measured.scale, measured.pixel);
    this.#particles(this.how(isMoving), measured, false);
    this.#caption(measured);
  }

  /** The particle at a place of the panel, pixels from its corner; -1 if there is none. */
  at(x, y) {
    const { gl } = this.app.graphics;
    if (this.frame < 0 || !this.box || this.run.dimensions === 1) return -1;
    const measured = this.measure();
    return this.app.graphics.pick(() => {
      // The pixel is the whole picture, and all else beside it.
      gl.viewport(Math.round(-x), Math.round(y - measured.height), Math.round(measured.width), Math.round(measured.height));
      if (this.run.dimensions < 3) gl.disable(gl.DEPTH_TEST);
      else gl.enable(gl.DEPTH_TEST);
      this.#particles(this.how(false), measured, true);
    });
  }

  /** What stands over the picture: name, time, how far the run is; length, directions. */
  #caption(measured) {
    const { run, frame } = this;
    const several = this.app.panels.length > 1;
    const isLow = several && this.element.clientHeight < LOW_PANEL;
    const lines = [];
    if (several) lines.push(["name", run.name]);
    const status = this.app.isGone ? UNKNOWN : this.isLost ? LOST : run.status;
    if (frame >= 0 && isLow) lines.push(["", [`${quantity(run.times[frame] ?? 0, "s")}, frame ${frame}`, ...(status === "completed" ? [] : [status])].join(", ")]);
    else if (frame >= 0) lines.push(["", `${quantity(run.times[frame] ?? 0, "s")}, frame ${frame} of 0 to ${run.times.length - 1}, ${grouped(run.count)} particles`]);
    if ((several && !isLow) || frame < 0) lines.push(["", this.howFar()]);
    if (this.trouble) lines.push(["trouble", this.trouble]);
    // Written again only when it says something else.
    const told = JSON.stringify(lines);
    if (told !== this.told) {
      this.told = told;
      const { lines: colors } = this.app.opening;
      const line = ([kind, text]) => {
        const element = made("div", { className: kind, textContent: text, title: text });
        if (kind === "name") element.style.setProperty("--line", css(colors[this.number % colors.length]));
        return element;
      };
      this.heading.replaceChildren(...lines.map(line));
    }
    if (run.dimensions === 1 && frame >= 0) this.#line();
    else if (measured) this.#overlay(measured);
  }

  /** A problem of one dimension: values over x. */
  #line() {
    const { app, data, run } = this;
    this.chart ??= new Chart(this.overlay);
    this.chart.headroom = 10 + this.heading.offsetHeight;
    const order = Array.from({ length: data.values.length }, (_, k) => k).sort((a, b) => data.positions[3 * a] - data.positions[3 * b]);
    this.chart.along = ["x", "m"];
    this.chart.quantity = app.colors.label;
    this.chart.unit = app.colors.unit;
    const { low, high, isSingle } = app.colors;
    const room = 0.05 * (high - low);
    this.chart.limits = isSingle ? null : [low - room, high + room];
    const x = order.map((k) => data.positions[3 * k] + run.origin[0]);
    this.chart.curves = [{ name: run.name, color: app.opening.lines[this.number % app.opening.lines.length], x, y: order.map((k) => data.values[k]) }];
    this.chart.draw();
  }

  #overlay({ pixel, width, height }) {
    const { camera } = this;
    const { context } = cleared(this.overlay);
    context.clearRect(0, 0, width, height);
    context.fillStyle = BAR_INK;
    context.strokeStyle = BAR_INK;
    // A round length of at most a quarter of the width.
    const length = ticks(0, 0.25 * width * pixel, 2).at(-1) ?? 0;
    const wide = length / pixel;
    if (wide > 8 && wide < width) {
      const [x, y] = [width - 14 - wide, height - 14];
      context.fillStyle = "rgb(255 255 255 / 80%)";
      context.fillRect(x - 6, y - 22, wide + 12, 32);
      context.fillStyle = BAR_INK;
      context.fillRect(x, y, wide, 2);
      context.fillRect(x, y - 4, 1.5, 10);
      context.fillRect(x + wide - 1.5, y - 4, 1.5, 10);
      context.textAlign = "center";
      context.fillText(quantity(length, "m"), x + wide / 2, y - 8);
    }
    if (height >= LOWEST_PANEL) this.#directions(context, 34, height - 34);
    const body = this.picked && this.run.bodies[this.data.bodies[this.picked.particle]];
    if (this.picked && !this.app.state.hidden.has(body?.name)) {
      const [right, up] = camera.seen(plus(Array.from(this.picked.position), this.run.origin));
      const [x, y] = [width / 2 + right / pixel, height / 2 - up / pixel];
      for (const [color, thick] of [["#fff", 4], ["#c0106a", 1.8]]) {
        context.strokeStyle = color;
        context.lineWidth = thick;
        context.beginPath();
        context.arc(x, y, 9, 0, 7);
        context.moveTo(x - 14, y);
        context.lineTo(x - 5, y);
        context.moveTo(x + 5, y);
        context.lineTo(x + 14, y);
        context.stroke();
      }
    }
  }

  /** Arrows along the axes. */
  #directions(context, x, y) {
    const { camera } = this;
    const ends = ["x", "y", "z"].map((name, axis) => ({ name, right: camera.right[axis], up: camera.up[axis], towards: camera.towards[axis] }));
    ends.sort((a, b) => a.towards - b.towards);
    context.lineWidth = 1.6;
    for (const { name, right, up, towards } of ends) {
      if (Math.hypot(right, up) < 0.05) continue;
      context.globalAlpha = towards < -0.3 ? 0.5 : 1;
      context.strokeStyle = { x: "#b03a2e", y: "#2e7d32", z: "#1f5fa8" }[name];
      context.fillStyle = context.strokeStyle;
      context.beginPath();
      context.moveTo(x, y);
      context.lineTo(x + 22 * right, y - 22 * up);
      context.stroke();
      context.textAlign = "center";
      context.fillText(name, x + 30 * right, y - 30 * up + 4);
    }
    context.globalAlpha = 1;
  }
}
