// The direction of view, what is in the middle, and how much is seen. The view is parallel, as in pictures.
"use strict";

/** Room around bodies. */
const ROOM = 1.12;

class Camera {
  right = [1, 0, 0];
  up = [0, 1, 0];
  towards = [0, 0, 1];
  /** The middle of the picture, m. */
  middle = [0, 0, 0];
  /** What is to be seen at least, across and up, m: a picture of another shape shows all of it, and more beside it. */
  sides = [1, 1];

  /** Half of the longer of both, m. */
  get half() {
    return 0.5 * Math.max(...this.sides);
  }

  look([right, up, towards]) {
    Object.assign(this, { right, up, towards });
  }

  /** Shows a box, m. */
  fit(box) {
    this.middle = [0, 1, 2].map((axis) => 0.5 * (box[2 * axis] + box[2 * axis + 1]));
    const size = (direction) => {
      const [low, high] = boxAlong(box, direction);
      return ROOM * (high - low);
    };
    this.sides = [size(this.right), size(this.up)];
    if (this.half === 0) this.sides = [2, 2];
  }

  /** Turns what is seen, by angles to the right and down. */
  turn(right, down) {
    const about = (axis, angle) => {
      for (const name of ["right", "up", "towards"]) this[name] = turned(this[name], axis, angle);
    };
    about(this.up, -right);
    about(this.right, -down);
    // Rounding must not add up.
    this.towards = unit(this.towards);
    this.right = unit(cross(this.up, this.towards));
    this.up = cross(this.towards, this.right);
  }

  /** Metres of a pixel in a panel. */
  pixel(width, height) {
    return Math.max(this.sides[0] / width, this.sides[1] / height);
  }

  /** Moves what is seen by pixels to the right and down. */
  pan(right, down, pixel) {
    this.middle = plus(this.middle, plus(times(this.right, -right * pixel), times(this.up, down * pixel)));
  }

  /** Zooms, so that what is at a place, pixels from the middle to the right and down, stays there. */
  zoom(factor, right, down, pixel) {
    const next = Math.min(Math.max(this.half / factor, 1e-12), 1e6);
    const share = 1 - next / this.half;
    this.sides = this.sides.map((side) => side * (1 - share));
    this.middle = plus(this.middle, plus(times(this.right, right * pixel * share), times(this.up, -down * pixel * share)));
  }

  /** Right, up, towards of a place from the middle of the picture, m. */
  seen(place) {
    const from = minus(place, this.middle);
    return [dot(from, this.right), dot(from, this.up), dot(from, this.towards)];
  }
}
