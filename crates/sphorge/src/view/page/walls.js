// Rigid walls of the deck, where they are at the time of a frame.
"use strict";

const WALL_EDGE = [70 / 255, 78 / 255, 90 / 255, 1];
const WALL_FACE = [0.86, 0.875, 0.9, 1];
/** How far the part of a wall that is drawn goes beyond the bodies, as a share of their extent. */
const BEYOND = 0.12;

/** Draws the walls of a run near the bodies, which are in a box (m). */
function drawWalls(graphics, camera, walls, frame, box, scale, pixel) {
  const { gl } = graphics;
  const largest = Math.max(...[0, 1, 2].map((axis) => box[2 * axis + 1] - box[2 * axis]));
  for (const { point, normal, to, moved } of walls) {
    const shift = moved[frame] ?? [0, 0, 0];
    if (to) {
      drawBand(graphics, camera.seen(plus(point, shift)), camera.seen(plus(to, shift)), 1.5 * pixel, scale);
      continue;
    }
    const place = plus(point, shift);
    // Material that has not reached the wall yet, or has left it for good, is shown without.
    if (boxAlong(box, normal)[0] - dot(place, normal) > largest) continue;
    const facing = dot(normal, camera.towards);
    if (Math.abs(facing) < 0.02) drawEdge(graphics, camera, place, normal, box, largest, scale, pixel);
    else drawFace(graphics, camera, place, normal, box, largest, scale, facing > 0);
  }
  gl.lineWidth(1);
}

/** A plane seen from its edge: a line, with hatches on the side without material. */
function drawEdge(graphics, camera, place, normal, box, largest, scale, pixel) {
  const along = cross(normal, camera.towards);
  const middle = [0, 1, 2].map((axis) => 0.5 * (box[2 * axis] + box[2 * axis + 1]));
  const foot = plus(middle, times(normal, dot(minus(place, middle), normal)));
  const [low, high] = boxAlong(box, along).map((end) => end - dot(middle, along));
  const at = (t) => camera.seen(plus(foot, times(along, t)));
  const [from, to] = [low - BEYOND * largest, high + BEYOND * largest];
  drawBand(graphics, at(from), at(to), 1.25 * pixel, scale);
  const hatch = 8 * pixel;
  const lines = [];
  for (let t = from + 0.5 * hatch; t < to && lines.length < 4000; t += hatch) {
    const start = plus(foot, times(along, t));
    lines.push(camera.seen(start), camera.seen(plus(start, plus(times(normal, -hatch), times(along, 0.8 * hatch)))));
  }
  graphics.flat(graphics.gl.LINES, lines, WALL_EDGE, scale);
}

/** A line as wide as is asked for: those of graphics cards are one pixel. */
function drawBand(graphics, from, to, half, scale) {
  const length = Math.hypot(to[0] - from[0], to[1] - from[1]) || 1;
  const across = [(-(to[1] - from[1]) / length) * half, ((to[0] - from[0]) / length) * half, 0];
  graphics.flat(graphics.gl.TRIANGLE_STRIP, [plus(from, across), minus(from, across), plus(to, across), minus(to, across)], WALL_EDGE, scale);
}

/** The part of a plane near the bodies; filled where material is before it. */
function drawFace(graphics, camera, place, normal, box, largest, scale, filled) {
  const axis = [0, 1, 2].reduce((best, k) => (Math.abs(normal[k]) < Math.abs(normal[best]) ? k : best), 0);
  const first = unit(minus([0, 1, 2].map((k) => Number(k === axis)), times(normal, normal[axis])));
  const second = cross(normal, first);
  const [a, b] = boxAlong(box, first);
  const [c, d] = boxAlong(box, second);
  const room = BEYOND * largest;
  const height = dot(place, normal);
  const at = (u, v) => camera.seen(plus(times(normal, height), plus(times(first, u), times(second, v))));
  const corners = [at(a - room, c - room), at(b + room, c - room), at(b + room, d + room), at(a - room, d + room)];
  const { gl } = graphics;
  if (filled) {
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(2, 2);
    graphics.flat(gl.TRIANGLE_FAN, corners, WALL_FACE, scale);
    gl.disable(gl.POLYGON_OFFSET_FILL);
  }
  graphics.flat(gl.LINE_LOOP, corners, WALL_EDGE, scale);
}
