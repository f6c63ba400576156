// Cells of particles that share corners: which nodes are corners of which cell, and the faces that are seen in a frame.
"use strict";

/** Corners of the faces of a cell in space, in order around each; bit k of a corner is its side along axis k. */
const FACE_CORNERS = new Uint8Array([0, 2, 6, 4, 1, 3, 7, 5, 0, 4, 5, 1, 2, 6, 7, 3, 0, 1, 3, 2, 4, 5, 7, 6]);
/** The same of a cell in a plane. */
const PLANE_CORNERS = new Uint8Array([0, 1, 3, 2]);
/** Edges of a cell in space. */
const CELL_EDGES = new Uint8Array([0, 1, 2, 3, 4, 5, 6, 7, 0, 2, 1, 3, 4, 6, 5, 7, 0, 4, 1, 5, 2, 6, 3, 7]);
/** How far before a plane cells are cut, in their spacing: a face in the plane is cut, too. */
const ON_CUT = 2e-3;
/** How wide slivers between cut cells may be, in spacings. */
const SLIVER = 0.4;

/** An array that is at least so long, and no other one as long as that does. */
function grown(array, length) {
  return array.length >= length ? array : new array.constructor(Math.ceil(1.2 * length));
}

/** Four-cornered faces, as the graphics card gets them. */
class Faces {
  count = 0;
  /** How many are in no plane of symmetry: they come first. */
  open = 0;
  /** Three numbers a corner. */
  places = new Float32Array(0);
  /** Outward, of length 127; the fourth is above zero where edges are drawn. */
  normals = new Int8Array(0);
  /** The particle, at each corner. */
  numbers = new Uint32Array(0);

  reserve(count) {
    const [places, normals, numbers] = [this.places, this.normals, this.numbers];
    this.places = grown(places, 12 * count);
    this.normals = grown(normals, 16 * count);
    this.numbers = grown(numbers, 4 * count);
    for (const [now, before] of [[this.places, places], [this.normals, normals], [this.numbers, numbers]]) if (now !== before) now.set(before);
  }

  /** Turns the next face over: its corners go around the other way. */
  turnOver() {
    const { places } = this;
    const [b, d] = [12 * this.count + 3, 12 * this.count + 9];
    for (let axis = 0; axis < 3; axis += 1) [places[b + axis], places[d + axis]] = [places[d + axis], places[b + axis]];
  }

  /** Corners of the next face, which is counted only if it is kept. */
  corner(k, source, at) {
    this.places[12 * this.count + 3 * k] = source[3 * at];
    this.places[12 * this.count + 3 * k + 1] = source[3 * at + 1];
    this.places[12 * this.count + 3 * k + 2] = source[3 * at + 2];
  }

  keep(particle, x, y, z, edges) {
    const at = this.count;
    for (let k = 4 * at; k < 4 * at + 4; k += 1) {
      this.numbers[k] = particle;
      this.normals[4 * k] = x;
      this.normals[4 * k + 1] = y;
      this.normals[4 * k + 2] = z;
      this.normals[4 * k + 3] = edges;
    }
    this.count += 1;
  }

  isFinite() {
    const { places, count } = this;
    let sum = 0;
    for (let k = 12 * count; k < 12 * count + 12; k += 1) sum += places[k];
    return sum - sum === 0;
  }
}

/** A polygon as quadrilaterals around its first corner. */
function fan(faces, cell, polygon, order, points, x, y, z) {
  faces.reserve(faces.count + points);
  for (let k = 1; k + 1 < points; k += 2) {
    faces.corner(0, polygon, order[0]);
    faces.corner(1, polygon, order[k]);
    faces.corner(2, polygon, order[k + 1]);
    faces.corner(3, polygon, order[Math.min(k + 2, points - 1)]);
    if (faces.isFinite()) faces.keep(cell, 127 * x, 127 * y, 127 * z, 0);
  }
}

class Cells {
  /** Nodes of the corners in the frame that is shown. */
  #now;
  #parted = new Uint32Array(0);
  /** Fillers that have come apart. */
  #torn = new Set();
  #depths = new Float32Array(0);
  #normal = new Float32Array(3);

  constructor(bytes) {
    const [count, corners, faces, fillers] = new Uint32Array(bytes, 0, 4);
    Object.assign(this, { count, corners });
    this.of = new Uint32Array(bytes, 16, count * corners);
    this.surface = new Uint32Array(bytes, 16 + 4 * count * corners, faces);
    this.fillers = new Uint32Array(bytes, 16 + 4 * (count * corners + faces), 4 * fillers);
    this.#now = this.of;
  }

  /** Takes the nodes of a frame. */
  take({ places, parted, torn }) {
    if (this.#parted.length > 0) this.#now.set(this.of);
    if (parted.length > 0 && this.#now === this.of) this.#now = this.of.slice();
    for (let k = 0; k < parted.length; k += 2) this.#now[parted[k]] = parted[k + 1];
    this.#parted = parted;
    this.#torn = new Set(torn);
    this.places = places;
  }

  /** Faces that are outside: those at the start, and those at corners where cells have come apart. */
  #faces() {
    if (this.corners === 4 || this.#parted.length === 0) return this.surface;
    const faces = new Set(this.surface);
    for (let k = 0; k < this.#parted.length; k += 2) {
      const [cell, corner] = [Math.floor(this.#parted[k] / 8), this.#parted[k] % 8];
      for (let axis = 0; axis < 3; axis += 1) faces.add(6 * cell + 2 * axis + ((corner >> axis) & 1));
    }
    return Uint32Array.from(faces);
  }

  /** Finds the outward normal of the next face from its diagonals, of length 127; true if its corners go around it as seen from inside. */
  #turn(faces, cell, positions) {
    const { places, count } = faces;
    const a = 12 * count;
    const [b, c, d] = [a + 3, a + 6, a + 9];
    const [ux, uy, uz] = [places[c] - places[a], places[c + 1] - places[a + 1], places[c + 2] - places[a + 2]];
    const [vx, vy, vz] = [places[d] - places[b], places[d + 1] - places[b + 1], places[d + 2] - places[b + 2]];
    const [x, y, z] = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
    const from = (axis) => 0.25 * (places[a + axis] + places[b + axis] + places[c + axis] + places[d + axis]) - positions[3 * cell + axis];
    const out = x * from(0) + y * from(1) + z * from(2) < 0 ? -127 : 127;
    const scale = out / (Math.sqrt(x * x + y * y + z * z) || 1);
    this.#normal[0] = x * scale;
    this.#normal[1] = y * scale;
    this.#normal[2] = z * scale;
    return out < 0;
  }

  /** Whether all corners of the next face are in one of the planes: axes, places along them, and how near is in it. */
  #isHeld(faces, planes) {
    const { places, count } = faces;
    const isOn = ([axis, at, near], corner) => Math.abs(places[12 * count + 3 * corner + axis] - at) <= near;
    return planes.some((plane) => isOn(plane, 0) && isOn(plane, 1) && isOn(plane, 2) && isOn(plane, 3));
  }

  /** Fills in the faces that are seen of all cells, those in `planes` last: which of them are none is `faces.open`. */
  outside(faces, positions, planes) {
    const isFlat = this.corners === 4;
    const list = isFlat ? null : this.#faces();
    const count = isFlat ? this.count : list.length;
    const corners = isFlat ? PLANE_CORNERS : FACE_CORNERS;
    const { places, fillers } = this;
    const now = this.#now;
    faces.count = 0;
    faces.reserve(count + fillers.length / 4);
    const normal = this.#normal;
    normal.set([0, 0, 127]);
    const all = (isHeld) => {
      // Without planes there is nothing to be told apart.
      const isOther = () => (planes.length === 0 ? isHeld : this.#isHeld(faces, planes) !== isHeld);
      for (let k = 0; k < count; k += 1) {
        const cell = isFlat ? k : Math.floor(list[k] / 6);
        const at = isFlat ? 0 : 4 * (list[k] % 6);
        for (let corner = 0; corner < 4; corner += 1) faces.corner(corner, places, now[this.corners * cell + corners[at + corner]]);
        if (!faces.isFinite() || isOther()) continue;
        if (!isFlat && this.#turn(faces, cell, positions)) faces.turnOver();
        faces.keep(cell, normal[0], normal[1], normal[2], 127);
      }
      for (let k = 0; k < fillers.length; k += 4) {
        if (this.#torn.has(k / 4)) continue;
        const cell = Math.floor(fillers[k] / 6);
        faces.corner(0, places, fillers[k + 1]);
        faces.corner(1, places, fillers[k + 2]);
        faces.corner(2, places, fillers[k + 3]);
        faces.corner(3, places, fillers[k + 3]);
        if (!faces.isFinite() || isOther()) continue;
        if (!isFlat && this.#turn(faces, cell, positions)) faces.turnOver();
        faces.keep(cell, normal[0], normal[1], normal[2], 0);
      }
    };
    all(false);
    faces.open = faces.count;
    if (planes.length > 0) all(true);
  }

  /**
   * Fills in where a plane (normal and offset in the place of the particles) cuts cells; `before` is how far before it, m. `wide` gets the same, larger by a
   * share of the spacing all around and a little behind, for slivers between cells.
   */
  cut(faces, wide, [x, y, z, offset], before) {
    const { places, count } = this;
    const now = this.#now;
    const nodes = places.length / 3;
    this.#depths = grown(this.#depths, nodes);
    const depths = this.#depths;
    for (let k = 0; k < nodes; k += 1) depths[k] = x * places[3 * k] + y * places[3 * k + 1] + z * places[3 * k + 2] - offset + before;
    faces.count = 0;
    wide.count = 0;
    const polygon = new Float32Array(3 * 12);
    const spacing = before / ON_CUT;
    const order = [];
    for (let cell = 0; cell < count; cell += 1) {
      let [low, high] = [Infinity, -Infinity];
      for (let k = 8 * cell; k < 8 * cell + 8; k += 1) {
        const depth = depths[now[k]];
        if (depth < low) low = depth;
        if (depth > high) high = depth;
      }
      if (!(low < 0 && high > 0)) continue;
      let points = 0;
      for (let edge = 0; edge < 24; edge += 2) {
        const [a, b] = [now[8 * cell + CELL_EDGES[edge]], now[8 * cell + CELL_EDGES[edge + 1]]];
        const [da, db] = [depths[a], depths[b]];
        if (da < 0 === db < 0) continue;
        const share = da / (da - db);
        for (let axis = 0; axis < 3; axis += 1) polygon[3 * points + axis] = places[3 * a + axis] + share * (places[3 * b + axis] - places[3 * a + axis]);
        points += 1;
      }
      if (points < 3) continue;
      this.#around(polygon, points, order, x, y, z);
      fan(faces, cell, polygon, order, points, x, y, z);
      fan(wide, cell, this.#widened(polygon, points, order, [x, y, z], spacing), order, points, x, y, z);
    }
  }

  /** A polygon whose edges are pushed out by a share of the spacing, however flat it is, and all of it a little behind the plane. */
  #widened(polygon, points, order, normal, spacing) {
    const point = (k) => Array.from(polygon.subarray(3 * order[k % points], 3 * order[k % points] + 3));
    const outward = Array.from({ length: points }, (_, k) => {
      const out = cross(minus(point(k + 1), point(k)), normal);
      const length = Math.hypot(...out);
      return length > 1e-6 * spacing ? times(out, 1 / length) : null;
    });
    const wide = new Float32Array(3 * points);
    for (let k = 0; k < points; k += 1) {
      const [before, after] = [outward[(k + points - 1) % points], outward[k]];
      const [a, b] = [before ?? after ?? [0, 0, 0], after ?? before ?? [0, 0, 0]];
      // Where both edges are pushed out; no farther than twice that at a sharp corner.
      const longer = (SLIVER * spacing) / Math.max(1 + dot(a, b), 0.5);
      const at = point(k);
      for (let axis = 0; axis < 3; axis += 1) wide[3 * order[k] + axis] = at[axis] + longer * (a[axis] + b[axis]) - 0.01 * spacing * normal[axis];
    }
    return wide;
  }

  /** The order of points of a plane around their middle. */
  #around(polygon, points, order, x, y, z) {
    const middle = [0, 0, 0];
    for (let k = 0; k < points; k += 1) for (let axis = 0; axis < 3; axis += 1) middle[axis] += polygon[3 * k + axis] / points;
    const first = [0, 1, 2].map((axis) => polygon[axis] - middle[axis]);
    const second = cross([x, y, z], first);
    const angles = [];
    order.length = 0;
    for (let k = 0; k < points; k += 1) {
      const from = [0, 1, 2].map((axis) => polygon[3 * k + axis] - middle[axis]);
      angles.push(Math.atan2(dot(from, second), dot(from, first)));
      order.push(k);
    }
    order.sort((a, b) => angles[a] - angles[b]);
  }
}
