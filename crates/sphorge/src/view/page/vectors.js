// Vectors of three numbers, and boxes around points.
"use strict";

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const plus = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const times = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => times(a, 1 / (Math.hypot(...a) || 1));

/** A vector turned about an axis of length one. */
function turned(v, axis, angle) {
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  return plus(plus(times(v, c), times(cross(axis, v), s)), times(axis, dot(axis, v) * (1 - c)));
}

/** Lowest and highest place along each axis: `[x, X, y, Y, z, Z]`. */
function joinedBox(a, b) {
  if (!a || !b) return a ?? b;
  return a.map((place, k) => (k % 2 === 0 ? Math.min(place, b[k]) : Math.max(place, b[k])));
}

/** Lowest and highest place of a box along a direction. */
function boxAlong(box, direction) {
  let [low, high] = [0, 0];
  for (let axis = 0; axis < 3; axis += 1) {
    const ends = [direction[axis] * box[2 * axis], direction[axis] * box[2 * axis + 1]];
    low += Math.min(...ends);
    high += Math.max(...ends);
  }
  return [low, high];
}
