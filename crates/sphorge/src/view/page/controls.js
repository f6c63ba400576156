// What the picture shows, to be chosen: field, colours, view, section, bodies.
"use strict";

/** An element with its properties and what is in it. */
function made(kind, properties = {}, ...inside) {
  const element = document.createElement(kind);
  for (const [name, value] of Object.entries(properties)) {
    if (name in element) element[name] = value;
    else element.setAttribute(name, value);
  }
  element.append(...inside.filter((part) => part !== null));
  return element;
}

/** Whether a component can be other than zero: in a plane, vectors and shear have none out of it. */
function counts(component, dimensions) {
  const axes = [...component].map((letter) => "xyz".indexOf(letter));
  if (axes.length === 0 || axes.includes(-1) || (axes.length === 2 && axes[0] === axes[1])) return true;
  return axes.every((axis) => axis < dimensions);
}

class Controls {
  #app;
  #element;
  #made = "";
  /** Unit that limits are shown and typed in: divisor, text, and of which field. */
  #scale = null;
  /** What brings each tick up to date. */
  #ticks = [];

  constructor(app, element) {
    this.#app = app;
    this.#element = element;
    this.picked = made("fieldset", { id: "picked" });
    this.low = made("input", { type: "text", inputMode: "decimal", id: "low", ariaLabel: "lowest value of the colour bar" });
    this.high = made("input", { type: "text", inputMode: "decimal", id: "high", ariaLabel: "highest value of the colour bar" });
    this.unit = made("span");
    this.wrong = made("p", { className: "note wrong", role: "alert", hidden: true });
    for (const input of [this.low, this.high]) input.addEventListener("change", () => this.#readRange());
  }

  /** Makes them again if the runs have other fields or bodies than before. */
  build() {
    const app = this.#app;
    const key = JSON.stringify([app.fields, app.bodies, app.isSolid(), app.hasSymmetry(), app.hasWalls(), app.warnings(), app.panels.map(({ run }) => run.dimensions)]);
    if (key === this.#made) return this.show();
    this.#made = key;
    this.#ticks = [];
    this.#element.replaceChildren(...[this.#field(), this.picked, this.#view(), this.#section(), this.#bodies(), this.#look(), this.#notes()].filter(Boolean));
    return this.show();
  }

  #group(title, ...inside) {
    return made("fieldset", {}, made("legend", { textContent: title }), ...inside);
  }

  #row(name, control) {
    return made("label", {}, made("span", { textContent: name }), control);
  }

  /** A box to tick for what `is` tells; it follows what else changes that. */
  #tick(text, id, is, change) {
    const input = made("input", { type: "checkbox", id, checked: is() });
    this.#ticks.push(() => (input.checked = is()));
    input.addEventListener("change", () => {
      change(input.checked);
      this.#app.refresh();
    });
    return made("label", { className: "tick" }, input, made("span", { textContent: text, title: text }));
  }

  #choice(id, options, change) {
    const select = made("select", { id }, ...options.map(([value, text]) => made("option", { value, textContent: text })));
    select.addEventListener("change", () => {
      change(select.value);
      this.#app.refresh();
    });
    return select;
  }

  #field() {
    const { state, fields } = this.#app;
    const dimensions = Math.max(...this.#app.panels.map(({ run }) => run.dimensions));
    const options = fields.flatMap(({ name, label, width, components: all }) => {
      const components = all.filter((component) => counts(component, dimensions));
      const whole = [name, width > 1 ? `${label} (magnitude)` : label];
      return [whole, ...components.map((component) => [`${name}.${component}`, `${label} ${component}`])];
    });
    this.field = this.#choice("field", options, (value) => {
      this.#refuse(null);
      state.field = value;
      if (state.ranges === "fixed") state.ranges = "all";
    });
    this.map = this.#choice("map", [["", "automatic"], ["viridis", "viridis"], ["inferno", "inferno"], ["diverging", "diverging"]], (value) => {
      state.map = value || null;
    });
    this.ranges = this.#choice("ranges", [["all", "of all frames"], ["frame", "of each frame"], ["fixed", "these:"]], (value) => {
      this.#refuse(null);
      state.ranges = value;
      if (value === "fixed") state.fixed = [this.#app.colors.low, this.#app.colors.high];
    });
    return this.#group("Field", this.#row("show", this.field), this.#row("colours", this.map), this.#row("limits", this.ranges), made("div", { className: "pair" }, this.low, this.high, this.unit), this.wrong);
  }

  /** Says what is wrong with limits that are typed; nothing if nothing is. */
  #refuse(reason) {
    this.wrong.textContent = reason ?? "";
    this.wrong.hidden = !reason;
    for (const input of [this.low, this.high]) input.setAttribute("aria-invalid", String(Boolean(reason)));
  }

  /** Writes limits into the boxes, in the unit beside them. */
  #write(...limits) {
    [this.low, this.high].forEach((input, k) => {
      input.value = fourDigits(limits[k] / this.#scale[0]);
      input.shown = input.value;
    });
  }

  /** Limits as they are typed: in the unit beside them, or in one that is typed, too. */
  #readRange() {
    const { state, colors } = this.#app;
    let low;
    let high;
    try {
      // What is not typed keeps the digits that are not shown.
      const read = (input, value) => (input.value === input.shown ? value : readQuantity(input.value, this.#scale, colors.unit));
      [low, high] = [read(this.low, colors.low), read(this.high, colors.high)];
      if (low >= high) throw new Error(`The smaller one comes first: ${quantity(low, colors.unit)} is not below ${quantity(high, colors.unit)}.`);
    } catch (error) {
      return this.#refuse(error.message);
    }
    this.#refuse(null);
    this.#write(low, high);
    state.ranges = "fixed";
    state.fixed = [low, high];
    return this.#app.refresh();
  }

  #view() {
    const app = this.#app;
    const button = (text, id, press) => {
      const element = made("button", { type: "button", textContent: text, id });
      element.addEventListener("click", press);
      return element;
    };
    const look = (axes) => () => {
      app.camera.look(axes);
      app.fit();
    };
    const views = app.isSolid() ? app.views.map(([name, axes]) => button(name, `view-${name}`, look(axes))) : [];
    return this.#group("View", made("div", { className: "buttons" }, ...views, button("fit", "fit", () => app.fit())));
  }

  #section() {
    const app = this.#app;
    if (!app.isSolid()) return null;
    const { state } = app;
    const normals = { x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1] };
    this.cut = this.#choice("section", [["", "none"], ["x", "across x"], ["y", "across y"], ["z", "across z"], ["view", "across the view"]], (value) => {
      const normal = value === "view" ? app.camera.towards : normals[value];
      app.cut(normal ? (dot(normal, app.camera.towards) < 0 ? times(normal, -1) : normal) : null);
    });
    this.place = made("input", { type: "range", id: "place", min: 0, max: 1000, step: 1, ariaLabel: "place of the section" });
    this.place.addEventListener("input", () => {
      const [low, high] = boxAlong(app.box(), state.section.normal);
      state.section.offset = low + (high - low) * (this.place.value / 1000);
      app.moving();
      this.show();
    });
    this.turn = made("button", { type: "button", id: "turn", textContent: "other side" });
    this.turn.addEventListener("click", () => {
      const { normal, offset } = state.section;
      state.section = { normal: times(normal, -1), offset: -offset };
      app.refresh();
    });
    this.where = made("span", { className: "note" });
    this.cutting = made("div", {}, this.#row("place", this.place), made("div", { className: "buttons" }, this.turn, this.where));
    return this.#group("Section", this.#row("cut", this.cut), this.cutting);
  }

  #bodies() {
    const { state, bodies } = this.#app;
    if (bodies.length === 0) return null;
    const ticks = bodies.map(({ name, material }, k) => {
      const text = material ? `${name} (${material})` : name;
      return this.#tick(text, `body-${k}`, () => !state.hidden.has(name), (isShown) => state.hidden[isShown ? "delete" : "add"](name));
    });
    return this.#group("Bodies", ...ticks);
  }

  #look() {
    const app = this.#app;
    const { state } = app;
    const set = (name) => (value) => {
      state[name] = value;
    };
    const ticks = [
      app.hasWalls() ? this.#tick("walls", "walls", () => state.walls, set("walls")) : null,
      app.hasSymmetry() ? this.#tick("images in planes of symmetry", "mirror", () => state.mirror, set("mirror")) : null,
      app.hasCells() ? this.#tick("edges of cells", "edges", () => state.edges, set("edges")) : null,
      app.hasCells() ? this.#tick("particles as balls, not as cells", "balls", () => state.balls, set("balls")) : null,
    ].filter(Boolean);
    return ticks.length > 0 ? this.#group("Show", ...ticks) : null;
  }

  #notes() {
    const { source, opening } = this.#app;
    const notes = [...this.#app.warnings(), ...source.leftOut];
    if (notes.length === 0) return made("p", { className: "note", textContent: `Sphorge ${opening.version}` });
    return this.#group(source.isLive ? "Warnings" : "This page", ...notes.map((text) => made("p", { className: "note", textContent: text })));
  }

  /** Brings them to what is shown now. */
  show() {
    for (const bring of this.#ticks) bring();
    const { state, colors } = this.#app;
    if (!this.field) return;
    this.field.value = state.field;
    this.map.value = state.map ?? "";
    this.ranges.value = state.ranges;
    if (colors) {
      const hasFocus = [this.low, this.high].includes(document.activeElement);
      const isTyped = state.ranges === "fixed" || hasFocus || !this.wrong.hidden;
      const isOther = this.#scale?.[2] !== state.field;
      // A unit that changed with every number would be another one for the next.
      if (!isTyped || isOther) this.#scale = [...scaledUnit(Math.max(Math.abs(colors.low), Math.abs(colors.high)), colors.unit), state.field];
      this.unit.textContent = this.#scale[1];
      this.unit.parentElement.hidden = Boolean(colors.key);
      if (isOther || (!hasFocus && this.wrong.hidden)) this.#write(colors.low, colors.high);
    }
    if (this.cut) {
      const { section } = state;
      this.cutting.hidden = !section;
      if (!section) this.cut.value = "";
      else if (this.cut.value === "") this.cut.value = ["x", "y", "z"].find((_, k) => Math.abs(section.normal[k]) > 0.999) ?? "view";
      const box = section && this.#app.box();
      if (box) {
        const [low, high] = boxAlong(box, section.normal);
        this.place.value = Math.round((1000 * (section.offset - low)) / (high - low || 1));
        // Along the axis, whatever side is cut away.
        const axis = [0, 1, 2].find((k) => Math.abs(section.normal[k]) > 0.999);
        const place = Math.abs(section.offset) < 1e-5 * (high - low) ? 0 : section.offset;
        this.where.textContent = axis === undefined ? quantity(place, "m") : `${"xyz"[axis]} = ${quantity(place * Math.sign(section.normal[axis]), "m")}`;
      }
    }
  }
}
