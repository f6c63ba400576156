// Mouse, pen and fingers: turn, move, zoom, pick.
"use strict";

/** Pixels that a pointer may move and still pick: a mouse, and a finger. */
const STEADY = 5;
const STEADY_FINGER = 12;

class Pointers {
  #app;
  #down = new Map();
  #moved = 0;
  #steady = STEADY;

  constructor(app, element) {
    this.#app = app;
    this.element = element;
    element.addEventListener("pointerdown", (event) => this.#press(event));
    element.addEventListener("pointermove", (event) => this.#move(event));
    for (const name of ["pointerup", "pointercancel"]) element.addEventListener(name, (event) => this.#lift(event));
    element.addEventListener("wheel", (event) => this.#wheel(event), { passive: false });
    element.addEventListener("contextmenu", (event) => event.preventDefault());
    element.addEventListener("dblclick", () => app.fit());
  }

  #press(event) {
    // Its buttons are pressed, and nothing behind it.
    if (event.target.closest(".card")) return;
    if (this.#down.size === 0) this.#moved = 0;
    this.#steady = event.pointerType === "touch" ? STEADY_FINGER : STEADY;
    this.#down.set(event.pointerId, { x: event.clientX, y: event.clientY });
    this.element.setPointerCapture(event.pointerId);
    this.element.classList.add("dragged");
    // Two fingers zoom, whatever they do first.
    if (this.#down.size > 1) this.#moved = 2 * this.#steady;
  }

  #panel(event) {
    const { panels } = this.#app;
    const inside = ({ element }) => {
      const { left, right, top, bottom } = element.getBoundingClientRect();
      return event.clientX >= left && event.clientX < right && event.clientY >= top && event.clientY < bottom;
    };
    return panels.find(inside) ?? panels[0];
  }

  #move(event) {
    const before = this.#down.get(event.pointerId);
    if (!before) return;
    const panel = this.#panel(event);
    const { camera } = panel;
    const { width, height } = panel.rectangle();
    const pixel = camera.pixel(width, height);
    const [right, down] = [event.clientX - before.x, event.clientY - before.y];
    this.#moved += Math.hypot(right, down);
    if (this.#down.size > 1) this.#pinch(event, pixel);
    else if (this.#moved > this.#steady) {
      const pans = panel.run.dimensions < 3 || event.shiftKey || event.ctrlKey || (event.buttons & 6) !== 0;
      if (pans) camera.pan(right, down, pixel);
      else camera.turn(0.008 * right, 0.008 * down);
      this.#app.moving();
    }
    this.#down.set(event.pointerId, { x: event.clientX, y: event.clientY });
  }

  /** Two fingers: what is between them stays between them. */
  #pinch(event, pixel) {
    const others = [...this.#down].filter(([id]) => id !== event.pointerId).map(([, place]) => place);
    const before = this.#down.get(event.pointerId);
    const [other] = others;
    const apart = (place) => Math.hypot(place.x - other.x, place.y - other.y) || 1;
    const now = { x: event.clientX, y: event.clientY };
    const { element, camera } = this.#panel(event);
    camera.pan(0.5 * (now.x - before.x), 0.5 * (now.y - before.y), pixel);
    const { left, top, width, height } = element.getBoundingClientRect();
    const middle = [0.5 * (now.x + other.x) - left - width / 2, 0.5 * (now.y + other.y) - top - height / 2];
    camera.zoom(apart(now) / apart(before), ...middle, pixel);
    this.#app.moving();
  }

  #lift(event) {
    if (!this.#down.delete(event.pointerId) || this.#down.size > 0) return;
    this.element.classList.remove("dragged");
    if (event.type === "pointerup" && this.#moved <= this.#steady && event.button === 0) {
      const panel = this.#panel(event);
      const { left, top } = panel.element.getBoundingClientRect();
      this.#app.pick(panel, event.clientX - left, event.clientY - top, this.#steady === STEADY ? 0 : STEADY_FINGER);
    }
  }

  #wheel(event) {
    event.preventDefault();
    const { element, camera } = this.#panel(event);
    const { left, top, width, height } = element.getBoundingClientRect();
    const lines = event.deltaMode === 1 ? 30 : 1;
    const factor = Math.exp(-0.0015 * Math.max(-400, Math.min(400, event.deltaY * lines)));
    camera.zoom(factor, event.clientX - left - width / 2, event.clientY - top - height / 2, camera.pixel(width, height));
    this.#app.moving();
  }
}
