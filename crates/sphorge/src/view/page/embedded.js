// Where the data of a single page come from: the page itself.
"use strict";

const NOT_FINITE = 65535;

class EmbeddedSource {
  isLive = false;
  #data;
  #bytes;

  constructor(data, text) {
    this.#data = data;
    this.#bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    this.leftOut = data.left_out;
  }

  async #unpacked({ at, length }) {
    const part = new Blob([this.#bytes.subarray(at, at + length)]).stream();
    return new Response(part.pipeThrough(new DecompressionStream("deflate"))).arrayBuffer();
  }

  #entry(run, frame, name) {
    // What never changes is there once.
    const of = (frame) => this.#data.arrays.find((entry) => entry.run === run && entry.frame === frame && entry.name === name);
    return of(frame) ?? of(0);
  }

  async opening() {
    return this.#data.opening;
  }

  async runs() {
    return this.#data.runs;
  }

  async array(run, frame, name) {
    const entry = this.#entry(run, frame, name);
    if (!entry) return { head: new Float64Array(8), values: new Float32Array(0) };
    const planes = new Uint8Array(await this.#unpacked(entry));
    const width = entry.ranges.length;
    const count = planes.length / (2 * width);
    const values = new Float32Array(width * count);
    entry.ranges.forEach(([low, high], component) => {
      const start = 2 * component * count;
      const step = (high - low) / (NOT_FINITE - 1);
      let now = 0;
      for (let k = 0; k < count; k += 1) {
        // Differences, first all low bytes, then all high ones.
        now = (now + planes[start + k] + 256 * planes[start + count + k]) & 0xffff;
        values[k * width + component] = now === NOT_FINITE ? NaN : low + step * now;
      }
    });
    return { head: Float64Array.from(entry.head), values };
  }

  async range(run, frame, name) {
    return Float64Array.from(this.#entry(run, frame, name)?.head ?? []);
  }

  async #plain(run, name) {
    const entry = this.#data.plain.find((entry) => entry.run === run && entry.name === name);
    return entry ? this.#unpacked(entry) : new ArrayBuffer(0);
  }

  async cells(run) {
    return this.#plain(run, "cells");
  }

  async nodes(run, frame) {
    const { values } = await this.array(run, frame, "nodes");
    const numbers = async (name) => new Uint32Array(await this.#plain(run, `${name}/${frame}`));
    return { places: values, parted: await numbers("parted"), torn: await numbers("torn") };
  }

  async column(run, column) {
    return new Float64Array(await this.#plain(run, `history/${column}`));
  }

  /** What the page has of a particle. */
  async particle(run, frame, particle) {
    const described = this.#data.runs[run];
    const position = (await this.array(run, frame, "position")).values.subarray(3 * particle, 3 * particle + 3);
    const fields = [];
    for (const { name } of described.fields) {
      fields.push({ name, values: [(await this.array(run, frame, name)).values[particle]] });
    }
    const body = fields.find((field) => field.name === "body")?.values[0];
    return { particle, position: plus(Array.from(position), described.origin), body: described.bodies[body]?.name ?? null, fields };
  }
}

/** The data in the page, or those of the server. */
function openSource() {
  const data = document.getElementById("data");
  return data ? new EmbeddedSource(JSON.parse(data.textContent), document.getElementById("bytes").textContent) : new LiveSource();
}
