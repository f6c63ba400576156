// A thin layer over WebGL 2: programs with their uniforms, buffers, textures.
"use strict";

class Graphics {
  constructor(canvas) {
    this.canvas = canvas;
    // Pictures at rest have more pixels than the screen, which is as smooth, and less is drawn while they move.
    const options = { antialias: false, alpha: false, stencil: true, powerPreference: "high-performance" };
    this.gl = canvas.getContext("webgl2", options);
    if (!this.gl) throw new Error("This browser has no WebGL 2, by which particles are drawn. Any browser since 2021 has it, unless it is switched off.");
    this.build();
  }

  /** All that a lost card has forgotten. */
  build() {
    this.programs = {
      cells: this.#program(CELL_VERTEX, CELL_FRAGMENT),
      balls: this.#program(BALL_VERTEX, BALL_FRAGMENT),
      points: this.#program(POINT_VERTEX, POINT_FRAGMENT),
      flat: this.#program(FLAT_VERTEX, FLAT_FRAGMENT),
    };
    this.lines = this.gl.createBuffer();
    this.picking = null;
    /** For what is drawn without attributes. */
    this.nothing = this.gl.createVertexArray();
    this.indices = null;
    this.reserve(1024);
  }

  #program(vertex, fragment) {
    const { gl } = this;
    const program = gl.createProgram();
    const compiled = [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]].map(([kind, text]) => {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
      return shader;
    });
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
      throw new Error(`The graphics driver refuses a program: ${compiled.map((shader) => gl.getShaderInfoLog(shader)).join(" ")}${gl.getProgramInfoLog(program)}`);
    }
    const uniforms = {};
    const count = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS) ?? 0;
    for (let k = 0; k < count; k += 1) {
      const { name, type } = gl.getActiveUniform(program, k);
      uniforms[name] = [gl.getUniformLocation(program, name), type];
    }
    return { program, uniforms };
  }

  /** Takes a program into use; uniforms that it does not have are passed over. */
  use({ program, uniforms }, values) {
    const { gl } = this;
    gl.useProgram(program);
    let unit = 0;
    for (const [name, value] of Object.entries(values)) {
      const [place, type] = uniforms[name] ?? [];
      if (place === undefined) continue;
      if (type === gl.FLOAT) gl.uniform1f(place, value);
      else if (type === gl.FLOAT_VEC3) gl.uniform3fv(place, value);
      else if (type === gl.FLOAT_VEC4) gl.uniform4fv(place, value);
      else if (type === gl.FLOAT_MAT3) gl.uniformMatrix3fv(place, false, value);
      else {
        gl.activeTexture(gl.TEXTURE0 + unit);
        gl.bindTexture(gl.TEXTURE_2D, value);
        gl.uniform1i(place, unit);
        unit += 1;
      }
    }
  }

  /** Makes the list of the triangles of so many faces with four corners, if it is not that long yet. */
  reserve(faces) {
    const { gl } = this;
    if (this.indices && this.reserved >= faces) return;
    this.reserved = Math.ceil(1.2 * faces);
    const list = new Uint32Array(6 * this.reserved);
    for (let k = 0; k < this.reserved; k += 1) list.set([4 * k, 4 * k + 1, 4 * k + 2, 4 * k, 4 * k + 2, 4 * k + 3], 6 * k);
    gl.bindVertexArray(null);
    if (this.indices) gl.deleteBuffer(this.indices);
    this.indices = gl.createBuffer();
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.indices);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, list, gl.STATIC_DRAW);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, null);
  }

  /** Numbers by texel, four each. */
  numbers(values, width, height, texture = this.gl.createTexture()) {
    const { gl } = this;
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, width, height, 0, gl.RGBA, gl.FLOAT, values);
    this.plain();
    return texture;
  }

  /** Colours by texel. */
  colors(bytes, count, texture = this.gl.createTexture()) {
    const { gl } = this;
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB8, count, 1, 0, gl.RGB, gl.UNSIGNED_BYTE, bytes);
    this.plain();
    return texture;
  }

  /** Of the texture that is bound, the texels as they are. */
  plain() {
    const { gl } = this;
    for (const [name, value] of [[gl.TEXTURE_MIN_FILTER, gl.NEAREST], [gl.TEXTURE_MAG_FILTER, gl.NEAREST], [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE], [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE]]) {
      gl.texParameteri(gl.TEXTURE_2D, name, value);
    }
  }

  /** Pixels of the picture in one of the page. */
  fine() {
    return this.canvas.width / (this.canvas.getBoundingClientRect().width || 1);
  }

  /** Draws triangles or lines of one colour. */
  flat(kind, places, color, scale) {
    const { gl } = this;
    if (places.length === 0) return;
    gl.bindVertexArray(null);
    this.use(this.programs.flat, { u_scale: scale, u_color: color });
    gl.bindBuffer(gl.ARRAY_BUFFER, this.lines);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(places.flat()), gl.STREAM_DRAW);
    for (let place = 0; place < 8; place += 1) gl.disableVertexAttribArray(place);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    gl.drawArrays(kind, 0, places.length);
  }

  /** Draws into a picture of one pixel and returns the number that it shows; -1 if it shows nothing. */
  pick(draw) {
    const { gl } = this;
    if (!this.picking) {
      this.picking = gl.createFramebuffer();
      gl.bindFramebuffer(gl.FRAMEBUFFER, this.picking);
      const attach = (format, point) => {
        const buffer = gl.createRenderbuffer();
        gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
        gl.renderbufferStorage(gl.RENDERBUFFER, format, 1, 1);
        gl.framebufferRenderbuffer(gl.FRAMEBUFFER, point, gl.RENDERBUFFER, buffer);
      };
      attach(gl.RGBA8, gl.COLOR_ATTACHMENT0);
      attach(gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT);
    }
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.picking);
    gl.disable(gl.SCISSOR_TEST);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    draw();
    const [r, g, b, a] = this.#pixel();
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    return r + 256 * (g + 256 * (b + 256 * a)) - 1;
  }

  #pixel() {
    const pixel = new Uint8Array(4);
    this.gl.readPixels(0, 0, 1, 1, this.gl.RGBA, this.gl.UNSIGNED_BYTE, pixel);
    return pixel;
  }
}
