// Time: the slider, playing, and the curves of the history under the picture.
"use strict";

/** Charts at most; those that have no room are beside the others, to be scrolled to. */
const MOST_CHARTS = 12;
/** Seconds that all frames take, and the shortest time of one. */
const FILM = 6;
const SHORTEST = 1 / 30;

class Timeline {
  #app;
  #times = [];
  isPlaying = false;

  constructor(app) {
    this.#app = app;
    const of = (id) => document.getElementById(id);
    [this.slider, this.button, this.output] = [of("time"), of("play"), of("now")];
    this.slider.addEventListener("input", () => this.go(Number(this.slider.value)));
    this.button.addEventListener("click", () => this.play(!this.isPlaying));
    of("back").addEventListener("click", () => this.step(-1));
    of("on").addEventListener("click", () => this.step(1));
    document.addEventListener("keydown", (event) => {
      if (event.target.matches("input[type=text], select") || event.ctrlKey || event.metaKey || event.altKey) return;
      const keys = { " ": () => this.play(!this.isPlaying), ArrowLeft: () => this.step(-1), ArrowRight: () => this.step(1), Home: () => this.go(0), End: () => this.go(this.#times.length - 1), f: () => app.fit() };
      const act = keys[event.key];
      // A button and a tick are pressed by the space bar; other sliders than that of the time are moved by arrows.
      const isOwn = event.key === " " ? event.target.matches("button, input[type=checkbox]") : event.key !== "f" && event.target.matches("input[type=range]:not(#time)");
      if (!act || isOwn) return;
      event.preventDefault();
      act();
    });
  }

  /** Takes the times of all runs; who looks at the last frame goes on to a newer one. */
  setTimes(runs) {
    const all = [...new Set(runs.flatMap((run) => run.times))].sort((a, b) => a - b);
    const wasLast = this.#times.length === 0 || this.index >= this.#times.length - 1;
    const isFirst = this.#times.length === 0;
    this.#times = all;
    this.slider.max = Math.max(all.length - 1, 0);
    if (all.length === 0) return;
    const { state } = this.#app;
    if (isFirst && state.time !== null) this.index = this.#nearest(state.time);
    else if (wasLast && !this.isPlaying) this.index = all.length - 1;
    else this.index = this.#nearest(state.time);
    state.time = all[this.index];
    this.show();
  }

  #nearest(time) {
    return this.#times.reduce((best, own, k) => (Math.abs(own - time) < Math.abs(this.#times[best] - time) ? k : best), 0);
  }

  show() {
    this.slider.value = this.index ?? 0;
    const time = this.#times[this.index];
    // Of several runs each has numbers of its own.
    const frame = this.#app.panels.length > 1 ? "" : `  (frame ${this.index})`;
    this.output.textContent = time === undefined ? "" : `${quantity(time, "s")}${frame}`;
  }

  goTo(time) {
    if (this.#times.length > 0) this.go(this.#nearest(time));
  }

  async go(index) {
    this.index = Math.min(Math.max(index, 0), this.#times.length - 1);
    this.#app.state.time = this.#times[this.index];
    this.show();
    await this.#app.refresh();
  }

  step(by) {
    this.play(false);
    return this.go(this.index + by);
  }

  play(isPlaying) {
    if (isPlaying === this.isPlaying) return;
    this.isPlaying = isPlaying;
    this.button.textContent = isPlaying ? "Pause" : "Play";
    if (isPlaying) this.#film();
    else this.#app.draw();
  }

  async #film() {
    if (this.index >= this.#times.length - 1) this.index = -1;
    while (this.isPlaying) {
      const began = performance.now();
      if (this.index >= this.#times.length - 1) return this.play(false);
      await this.go(this.index + 1);
      this.#app.ahead(this.#times[Math.min(this.index + 1, this.#times.length - 1)]);
      const each = Math.max(FILM / this.#times.length, SHORTEST) * 1000;
      // A picture at least is drawn in between.
      await new Promise((done) => setTimeout(done, Math.max(each - (performance.now() - began), 1)));
      await new Promise((done) => requestAnimationFrame(done));
    }
  }
}

/** The curves of the history: some charts beside each other, each with columns to choose from. */
class Curves {
  #app;
  #element;
  #charts = [];
  #names = "";
  #version = 0;
  #drawn = "";

  constructor(app, element) {
    this.#app = app;
    this.#element = element;
  }

  /** Columns that the runs have, those of measures first. */
  #columns() {
    const all = new Map();
    for (const { run } of this.#app.panels) for (const column of run.columns) if (!all.has(column.name)) all.set(column.name, column);
    const rank = ({ is_measure: isMeasure, name }) => (isMeasure ? 0 : ["time", "step", "dt_reason"].includes(name) ? 2 : 1);
    return [...all.values()].filter(({ name }) => name !== "time" && name !== "dt_reason").sort((a, b) => rank(a) - rank(b));
  }

  #build(columns) {
    const { opening } = this.#app;
    const asked = opening.start.columns.filter((name) => columns.some((column) => column.name === name));
    const measures = columns.filter((column) => column.is_measure).map(({ name }) => name);
    const usual = [...measures, "kinetic_energy", "plastic_work", "total_energy"].filter((name) => columns.some((column) => column.name === name));
    const chosen = (asked.length > 0 ? asked : usual).slice(0, window.innerWidth > 760 ? MOST_CHARTS : 1);
    this.#charts = chosen.map((name, k) => {
      const canvas = made("canvas", {});
      const select = made("select", { id: `column-${k}`, ariaLabel: "column of the history" }, ...columns.map((column) => made("option", { value: column.name, textContent: column.unit ? `${column.name} (${column.unit})` : column.name, title: column.meaning })));
      select.value = name;
      const fits = () => select.style.setProperty("--letters", select.selectedOptions[0]?.textContent.length ?? 0);
      fits();
      // Of each run that has the column, in the colour of its curve.
      const value = made("output", {});
      const element = made("div", { className: "chart" }, made("div", { className: "head" }, select, value), made("div", { className: "body" }, canvas));
      const chart = new Chart(canvas, (time) => this.#app.timeline.goTo(time));
      select.addEventListener("change", () => {
        fits();
        this.read();
      });
      return { element, chart, select, value };
    });
    const { panels, opening: { lines } } = this.#app;
    // Which curve is of which run, for all charts.
    const runs = panels.map(({ run, number }) => {
      const element = made("span", { textContent: run.name, title: run.name });
      element.style.setProperty("--line", css(lines[number % lines.length]));
      return element;
    });
    const key = made("div", { className: "key", hidden: panels.length < 2 }, ...runs);
    this.#element.replaceChildren(key, made("div", { className: "charts" }, ...this.#charts.map(({ element }) => element)));
  }

  /** Reads the curves as far as the runs have them now. */
  async read() {
    const { panels, store, opening } = this.#app;
    const columns = this.#columns();
    const names = columns.map(({ name }) => name).join();
    if (names !== this.#names) {
      this.#names = names;
      this.#build(columns);
    }
    for (const { chart, select } of this.#charts) {
      const curves = [];
      for (const { run, number } of panels) {
        const [time, column] = ["time", select.value].map((name) => run.columns.findIndex((known) => known.name === name));
        if (time < 0 || column < 0) continue;
        try {
          const [x, y] = await Promise.all([time, column].map((k) => store.column(number, run.rows, k)));
          curves.push({ name: run.name, color: opening.lines[number % opening.lines.length], x, y });
        } catch {
          // The folder has vanished; the panel says so.
        }
      }
      const described = columns.find(({ name }) => name === select.value);
      chart.curves = curves;
      chart.quantity = select.value.replace(/^measure\./, "").replaceAll("_", " ");
      chart.unit = described?.unit ?? "";
    }
    this.#version += 1;
    this.draw();
  }

  draw() {
    if (this.#element.offsetParent === null) return;
    // Drawn again when the curves, the time or the room are others.
    const { clientWidth, clientHeight } = this.#element;
    const key = [this.#version, this.#app.state.time, clientWidth, clientHeight, window.devicePixelRatio].join();
    if (key === this.#drawn) return;
    this.#drawn = key;
    for (const { chart, value } of this.#charts) {
      chart.cursor = this.#app.state.time;
      value.replaceChildren(...chart.at(chart.cursor).map(({ name, color, y }) => {
        const text = y === null ? "-" : quantity(y, chart.unit);
        const element = made("span", { textContent: text, title: `${name}: ${text}` });
        if (this.#app.panels.length > 1) element.style.setProperty("--line", css(color));
        return element;
      }));
      // After the values, which take some of its room.
      chart.draw();
    }
  }
}
