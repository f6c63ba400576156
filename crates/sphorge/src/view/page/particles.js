// The particles of a frame on the graphics card: as faces of their cells, or as balls.
"use strict";

/** A table of numbers of the particles on the card, which is filled only when they are other ones. */
class Table {
  #size = 0;
  #values = null;

  constructor(graphics, width) {
    this.graphics = graphics;
    const { gl } = graphics;
    [this.inside, this.format] = width === 3 ? [gl.RGB32F, gl.RGB] : [gl.R32F, gl.RED];
    this.width = width;
  }

  fill(values) {
    if (this.#values === values) return;
    this.#values = values;
    const { gl } = this.graphics;
    const count = values.length / this.width;
    const rows = Math.max(Math.ceil(count / TABLE_WIDE), 1);
    this.texture ??= gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    if (this.#size !== rows) {
      this.#size = rows;
      gl.texImage2D(gl.TEXTURE_2D, 0, this.inside, TABLE_WIDE, rows, 0, this.format, gl.FLOAT, null);
      this.graphics.plain();
    }
    const whole = Math.floor(count / TABLE_WIDE);
    const put = (row, wide, high, from) => {
      if (wide * high > 0) gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, row, wide, high, this.format, gl.FLOAT, values, from * this.width);
    };
    put(0, TABLE_WIDE, whole, 0);
    put(whole, count - whole * TABLE_WIDE, 1, whole * TABLE_WIDE);
  }
}

/** Faces on the card. */
class Surface {
  faces = new Faces();
  #sizes = new Map();
  #array = null;
  /** The list of triangles that the array has: a longer one is another. */
  #indices = null;
  #buffers = {};

  constructor(graphics) {
    this.graphics = graphics;
  }

  /** Sends them. */
  send() {
    const { gl } = this.graphics;
    const { faces } = this;
    gl.bindVertexArray(null);
    for (const [name, each] of [["places", 12], ["normals", 16], ["numbers", 4]]) {
      this.#buffers[name] ??= gl.createBuffer();
      gl.bindBuffer(gl.ARRAY_BUFFER, this.#buffers[name]);
      const values = faces[name];
      if (this.#sizes.get(name) !== values.length) gl.bufferData(gl.ARRAY_BUFFER, values.byteLength, gl.DYNAMIC_DRAW);
      this.#sizes.set(name, values.length);
      gl.bufferSubData(gl.ARRAY_BUFFER, 0, values, 0, each * faces.count);
    }
    this.graphics.reserve(faces.count);
  }

  #bind() {
    const { gl, indices } = this.graphics;
    this.#array ??= gl.createVertexArray();
    gl.bindVertexArray(this.#array);
    if (this.#indices === indices) return;
    this.#indices = indices;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.#buffers.places);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.#buffers.normals);
    gl.enableVertexAttribArray(1);
    gl.vertexAttribPointer(1, 4, gl.BYTE, true, 0, 0);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.#buffers.numbers);
    gl.enableVertexAttribArray(2);
    gl.vertexAttribIPointer(2, 1, gl.UNSIGNED_INT, 0, 0);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, indices);
  }

  /** Draws so many of them: all if not said otherwise. */
  draw(look, count = this.faces.count) {
    const { gl, programs } = this.graphics;
    if (count === 0) return;
    this.#bind();
    this.graphics.use(programs.cells, look);
    gl.drawElements(gl.TRIANGLES, 6 * count, gl.UNSIGNED_INT, 0);
  }
}

class Particles {
  #graphics;
  #data = null;
  #cells = null;
  #nodes = null;
  #sentNodes = null;
  #sentParts = null;
  /** Cuts by the image they are of. */
  #cuts = [];
  count = 0;
  hasCells = false;

  constructor(graphics) {
    this.#graphics = graphics;
    this.surface = new Surface(graphics);
    this.tables = { u_positions: new Table(graphics, 3), u_values: new Table(graphics, 1), u_body_of: new Table(graphics, 1) };
  }

  /** Which corners cells have in common. */
  setCells(bytes) {
    this.#cells = bytes.byteLength > 16 ? new Cells(bytes) : null;
  }

  /** The numbers of a frame. */
  set(data) {
    this.#data = data;
    this.count = data.positions.length / 3;
    const { places } = data.nodes;
    this.hasCells = this.#cells !== null && this.#cells.count === this.count && places.length > 0;
    this.#nodes = this.hasCells ? data.nodes : null;
  }

  #sendFaces() {
    if (this.#sentNodes === this.#nodes) return;
    this.#sentNodes = this.#nodes;
    this.#cells.take(this.#nodes);
    this.#cells.outside(this.surface.faces, this.#data.positions, this.#data.planes);
    this.surface.send();
    for (const cut of this.#cuts) cut.key = null;
  }

  /** The cut of an image, made when its plane or the frame is another one. */
  #cut(image, plane, before) {
    this.#cuts[image] ??= { surface: new Surface(this.#graphics), wide: new Surface(this.#graphics), key: null };
    const cut = this.#cuts[image];
    const key = plane.join();
    if (cut.key !== key) {
      cut.key = key;
      this.#cells.cut(cut.surface.faces, cut.wide.faces, plane, before);
      cut.surface.send();
      cut.wide.send();
    }
    return cut;
  }

  /**
   * Draws a part of a body that is cut, of all images before the next part: what is outside, the cut, and where the inside is still seen, in slivers between
   * cells whose corners are not the same, the cut of cells that are larger.
   */
  #drawPart(part, look, cut, { isMirrored, hasImages, picks }) {
    const { gl } = this.#graphics;
    look.u_is_cut = part === "outside" ? 0 : 1;
    const drawn = { outside: this.surface, cut: cut.surface, slivers: cut.wide }[part];
    // An image goes on where its plane is.
    const count = part === "outside" && hasImages ? this.surface.faces.open : drawn.faces.count;
    if (picks) return part === "slivers" ? undefined : drawn.draw(look, count);
    gl.enable(gl.STENCIL_TEST);
    // Zero where a face is seen from inside, one elsewhere.
    gl.frontFace(isMirrored ? gl.CW : gl.CCW);
    gl.stencilFunc(part === "slivers" ? gl.EQUAL : gl.ALWAYS, part === "slivers" ? 0 : 1, 255);
    gl.stencilOp(gl.KEEP, gl.KEEP, part === "slivers" ? gl.KEEP : gl.REPLACE);
    if (part === "outside") gl.stencilOpSeparate(gl.BACK, gl.KEEP, gl.KEEP, gl.ZERO);
    drawn.draw(look, count);
    return gl.disable(gl.STENCIL_TEST);
  }

  /** Draws them as `cells`, `balls` or `points`; `look` has the uniforms, `plane` where a section is in the place of this image. */
  draw(how, look, { isFlat, image, plane, before, part, isMirrored, hasImages, picks }) {
    const graphics = this.#graphics;
    const { gl } = graphics;
    if (this.count === 0) return;
    const { positions, values, bodies } = this.#data;
    this.tables.u_values.fill(values);
    this.tables.u_body_of.fill(bodies);
    look.u_values = this.tables.u_values.texture;
    look.u_body_of = this.tables.u_body_of.texture;
    if (how === "cells") this.#sendFaces();
    if (how !== "cells") {
      this.tables.u_positions.fill(positions);
      look.u_positions = this.tables.u_positions.texture;
    }
    if (how === "cells") {
      // What is turned away is hidden by what is not, unless a section opens it.
      look.u_back = isFlat || plane ? 1 : 0;
      if (!plane || isFlat) this.surface.draw(look, hasImages ? this.surface.faces.open : this.surface.faces.count);
      else this.#drawPart(part, look, this.#cut(image, plane, before), { isMirrored, hasImages, picks });
    } else {
      gl.bindVertexArray(graphics.nothing);
      graphics.use(graphics.programs[how], look);
      if (how === "points") gl.drawArrays(gl.POINTS, 0, this.count);
      else gl.drawArrays(gl.TRIANGLES, 0, 6 * this.count);
    }
    gl.bindVertexArray(null);
  }
}
