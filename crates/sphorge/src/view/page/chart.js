// Curves over time or place, with a cursor.
"use strict";

class Chart {
  #canvas;
  /** `{ name, color, x, y }` each. */
  curves = [];
  quantity = "";
  unit = "";
  along = ["time", "s"];
  /** Limits upwards, if they are given. */
  limits = null;
  /** Where the cursor is; none if there is none. */
  cursor = null;
  /** Pixels that are left free above. */
  headroom = 0;

  constructor(canvas, onPick) {
    this.#canvas = canvas;
    if (!onPick) return;
    const pick = (event) => {
      const { left } = canvas.getBoundingClientRect();
      const share = (event.clientX - left - this.area.x) / this.area.wide;
      if (this.range) onPick(this.range[0] + Math.min(Math.max(share, 0), 1) * (this.range[1] - this.range[0]));
    };
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      pick(event);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (canvas.hasPointerCapture(event.pointerId)) pick(event);
    });
  }

  #extent(name) {
    let [low, high] = [Infinity, -Infinity];
    for (const curve of this.curves) {
      for (const value of curve[name]) {
        if (value < low) low = value;
        if (value > high) high = value;
      }
    }
    if (low > high) return null;
    if (low === high) {
      const room = Math.abs(low) || 1;
      return name === "x" ? [low, low + room] : [low - 0.5 * room, low + 0.5 * room];
    }
    return [low, high];
  }

  draw() {
    const { context, width, height } = cleared(this.#canvas);
    context.clearRect(0, 0, width, height);
    context.fillStyle = BAR_INK;
    context.font = "12px system-ui, -apple-system, 'Segoe UI', 'DejaVu Sans', sans-serif";
    const [x, y] = [this.#extent("x"), this.limits ?? this.#extent("y")];
    this.range = x;
    this.area = { x: 0, wide: width };
    if (!x || !y) {
      context.textAlign = "center";
      context.fillText(this.curves.length > 0 ? "no values yet" : "", width / 2, height / 2);
      return;
    }
    const room = this.limits ? 0 : 0.05 * (y[1] - y[0]);
    const [low, high] = [y[0] - room, y[1] + room];
    const [scaleY, textY] = scaledUnit(Math.max(Math.abs(y[0]), Math.abs(y[1])), this.unit);
    const [scaleX, textX] = scaledUnit(Math.max(Math.abs(x[0]), Math.abs(x[1])), this.along[1]);
    const [top, bottom] = [18 + this.headroom, height - 32];
    const placesY = ticks(low, high, Math.max(2, (bottom - top) / 32));
    const labelsY = tickLabels(placesY, scaleY);
    const left = 10 + Math.max(24, ...labelsY.map((text) => context.measureText(text).width));
    const right = width - 20;
    this.area = { x: left, wide: right - left };
    const onX = (value) => left + ((right - left) * (value - x[0])) / (x[1] - x[0]);
    const onY = (value) => bottom - ((bottom - top) * (value - low)) / (high - low);

    context.strokeStyle = "#e3e6ea";
    context.lineWidth = 1;
    context.textAlign = "right";
    placesY.forEach((place, k) => {
      context.beginPath();
      context.moveTo(left, Math.round(onY(place)) + 0.5);
      context.lineTo(right, Math.round(onY(place)) + 0.5);
      context.stroke();
      context.fillText(labelsY[k], left - 5, onY(place) + 4);
    });
    context.textAlign = "center";
    const placesX = ticks(x[0], x[1], Math.max(2, (right - left) / 80));
    tickLabels(placesX, scaleX).forEach((text, k) => {
      const at = Math.round(onX(placesX[k])) + 0.5;
      context.beginPath();
      context.moveTo(at, bottom);
      context.lineTo(at, top);
      context.stroke();
      context.fillText(text, at, bottom + 14);
    });
    context.fillText(textX ? `${this.along[0]} (${textX})` : this.along[0], (left + right) / 2, height - 4);
    context.textAlign = "left";
    context.fillText(textY ? `${this.quantity} (${textY})` : this.quantity, left, top - 6, right - left);
    context.strokeStyle = "#8a93a0";
    context.strokeRect(left + 0.5, top + 0.5, right - left - 1, bottom - top - 1);

    context.save();
    context.beginPath();
    context.rect(left, top - 1, right - left, bottom - top + 2);
    context.clip();
    for (const curve of this.curves) this.#curve(context, curve, onX, onY);
    if (this.cursor !== null) {
      context.strokeStyle = "#c03020";
      context.lineWidth = 1.5;
      context.beginPath();
      context.moveTo(onX(this.cursor), top);
      context.lineTo(onX(this.cursor), bottom);
      context.stroke();
    }
    context.restore();
  }

  #curve(context, { color, x, y }, onX, onY) {
    context.strokeStyle = css(color);
    context.fillStyle = css(color);
    context.lineWidth = 1.6;
    context.beginPath();
    let isDrawn = false;
    for (let k = 0; k < x.length; k += 1) {
      // An empty cell of the history is a gap.
      if (!Number.isFinite(y[k])) isDrawn = false;
      else if (isDrawn) context.lineTo(onX(x[k]), onY(y[k]));
      else {
        context.moveTo(onX(x[k]), onY(y[k]));
        isDrawn = true;
      }
    }
    context.stroke();
  }

  /** The value of each curve at a place, of what is nearest to it; none where it has no value. */
  at(cursor) {
    if (cursor === null) return [];
    return this.curves.map(({ name, color, x, y }) => {
      let best = -1;
      for (let k = 0; k < x.length; k += 1) {
        if (Number.isFinite(y[k]) && (best < 0 || Math.abs(x[k] - cursor) < Math.abs(x[best] - cursor))) best = k;
      }
      return { name, color, y: best < 0 ? null : y[best] };
    });
  }
}
