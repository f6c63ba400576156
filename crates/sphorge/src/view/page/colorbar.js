// The bar or key that says which colour is which value: upright beside the picture, level below it on a phone.
"use strict";

const BAR_FONT = "13px system-ui, -apple-system, 'Segoe UI', 'DejaVu Sans', sans-serif";
const BAR_INK = "#22262c";

/** A canvas as large as its place on the page, in pixels of the screen. */
function cleared(canvas) {
  const { width, height } = canvas.getBoundingClientRect();
  const fine = window.devicePixelRatio || 1;
  canvas.width = Math.round(width * fine);
  canvas.height = Math.round(height * fine);
  const context = canvas.getContext("2d");
  context.setTransform(fine, 0, 0, fine, 0, 0);
  context.font = BAR_FONT;
  return { context, width, height };
}

/** Draws the bar of a field; `key` has words and colours where there are but these. */
function drawBar(canvas, { label, unit, map, low, high, least, most, key, reading }) {
  const { context, width, height } = cleared(canvas);
  const upright = height > width;
  const [scale, text] = scaledUnit(Math.max(Math.abs(low), Math.abs(high)), unit);
  const field = key || !text ? label : `${label} (${text})`;
  // Limits may be others when all is read.
  const title = reading ? `${field}, ${reading}` : field;
  canvas.setAttribute("aria-label", key ? `${field}: ${key.map(([, word]) => word).join(", ")}` : `${title}: ${quantity(low, unit)} to ${quantity(high, unit)}`);
  context.fillStyle = BAR_INK;
  if (key) drawKey(context, title, key, upright, width, height);
  else if (upright) drawUpright(context, { title, map, low, high, least, most, scale, width, height });
  else drawLevel(context, { title, map, low, high, least, most, scale, width, height });
}

function fillBar(context, map, place, isUpright, x, y, wide, high) {
  for (let k = 0; k < 256; k += 1) {
    context.fillStyle = css(map.subarray(3 * k, 3 * k + 3));
    // Each a little longer than its share, so that no gap is left.
    if (isUpright) context.fillRect(x, y + high - (high * (k + 1)) / 256, wide, high / 256 + 0.6);
    else context.fillRect(x + (wide * k) / 256, y, wide / 256 + 0.6, high);
  }
  context.strokeStyle = "#667080";
  context.strokeRect(x + 0.5, y + 0.5, wide - 1, high - 1);
  context.fillStyle = BAR_INK;
}

/** Smallest and largest value, where they are beyond the ends. */
function beyond({ low, high, least, most, scale }) {
  const slack = 1e-6 * (high - low);
  return [least < low - slack ? `min ${fourDigits(least / scale)}` : "", most > high + slack ? `max ${fourDigits(most / scale)}` : ""];
}

function drawUpright(context, bar) {
  const { title, map, low, high, scale, width, height } = bar;
  const length = Math.min(Math.max(height - 110, 80), 420);
  const [x, y, wide] = [6, (height - length) / 2, 16];
  fillBar(context, map, 0, true, x, y, wide, length);
  const places = ticks(low, high, Math.min(Math.max(length / 45, 2), 12));
  let widest = 0;
  tickLabels(places, scale).forEach((text, k) => {
    const at = y + length - (length * (places[k] - low)) / (high - low);
    context.fillRect(x + wide, at - 0.5, 5, 1);
    context.fillText(text, x + wide + 8, at + 4.5);
    widest = Math.max(widest, context.measureText(text).width);
  });
  const [least, most] = beyond(bar);
  arrow(context, most, x + wide / 2, y - 3, -1, wide, map.subarray(765, 768));
  arrow(context, least, x + wide / 2, y + length + 3, 1, wide, map.subarray(0, 3));
  context.save();
  context.translate(Math.min(x + wide + 8 + widest + 16, width - 4), height / 2);
  context.rotate(-Math.PI / 2);
  context.textAlign = "center";
  context.fillText(title, 0, 0, height - 10);
  context.restore();
}

/** An arrow beyond an end, with the value there. */
function arrow(context, text, x, y, down, wide, color) {
  if (!text) return;
  context.fillStyle = css(color);
  context.beginPath();
  context.moveTo(x - wide / 2, y);
  context.lineTo(x + wide / 2, y);
  context.lineTo(x, y + 10 * down);
  context.fill();
  context.fillStyle = BAR_INK;
  context.fillText(text, x - wide / 2, y + (down > 0 ? 26 : -16), 88);
}

function drawLevel(context, bar) {
  const { title, map, low, high, scale, width } = bar;
  const [x, y, high_] = [24, 20, 12];
  const wide = width - 48;
  context.textAlign = "center";
  const [least, most] = beyond(bar);
  context.fillText([least, title, most].filter(Boolean).join("   "), width / 2, 14, width - 12);
  fillBar(context, map, 0, false, x, y, wide, high_);
  const places = ticks(low, high, Math.min(Math.max(wide / 70, 2), 12));
  tickLabels(places, scale).forEach((text, k) => {
    const at = x + (wide * (places[k] - low)) / (high - low);
    context.fillRect(at - 0.5, y + high_, 1, 4);
    context.fillText(text, at, y + high_ + 17);
  });
}

function drawKey(context, title, key, upright, width, height) {
  let [x, y] = upright ? [4, Math.max((height - 20 * (key.length + 1)) / 2, 16)] : [12, 16];
  context.fillText(title, x, y, width - x - 4);
  y += 20;
  for (const [color, word] of key) {
    const wide = Math.min(context.measureText(word).width + 34, width - 8);
    if (!upright && x + wide > width && x > 12) [x, y] = [12, y + 18];
    context.fillStyle = css(color);
    context.fillRect(x, y - 11, 13, 13);
    context.strokeStyle = "#667080";
    context.strokeRect(x + 0.5, y - 10.5, 12, 12);
    context.fillStyle = BAR_INK;
    context.fillText(word, x + 18, y, width - (upright ? 22 : x + 20));
    if (upright) y += 20;
    else x += wide;
    if (y > height) break;
  }
}
