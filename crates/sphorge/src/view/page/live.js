// Where the data of a live page come from: the server that the page came from.
"use strict";

class LiveSource {
  isLive = true;
  leftOut = [];

  async #answer(address) {
    let response;
    try {
      response = await fetch(address);
    } catch {
      throw new Gone("Sphorge does not answer: the program that shows this page has ended.");
    }
    if (!response.ok) throw new Error((await response.text()).trim() || `answer ${response.status}`);
    return response;
  }

  async opening() {
    return (await this.#answer("start.json")).json();
  }

  async runs() {
    return (await this.#answer("runs.json")).json();
  }

  /** Head and values of an array of a frame. */
  async array(run, frame, name) {
    const bytes = await (await this.#answer(`run/${run}/frame/${frame}/array/${name}`)).arrayBuffer();
    return { head: new Float64Array(bytes, 0, 8), values: new Float32Array(bytes, 64) };
  }

  /** The head alone. */
  async range(run, frame, name) {
    return new Float64Array(await (await this.#answer(`run/${run}/frame/${frame}/range/${name}`)).arrayBuffer());
  }

  async cells(run) {
    return (await this.#answer(`run/${run}/cells`)).arrayBuffer();
  }

  /** Where corners of cells are in a frame, and those that have come apart. */
  async nodes(run, frame) {
    const bytes = await (await this.#answer(`run/${run}/frame/${frame}/nodes`)).arrayBuffer();
    const [places, parted, torn] = new Uint32Array(bytes, 0, 3);
    const after = 12 + 12 * places;
    return {
      places: new Float32Array(bytes, 12, 3 * places),
      parted: new Uint32Array(bytes, after, 2 * parted),
      torn: new Uint32Array(bytes, after + 8 * parted, torn),
    };
  }

  async column(run, column) {
    return new Float64Array(await (await this.#answer(`run/${run}/history/${column}`)).arrayBuffer());
  }

  async particle(run, frame, particle) {
    return (await this.#answer(`run/${run}/frame/${frame}/particle/${particle}`)).json();
  }
}

/** The server is not there any more. */
class Gone extends Error {}
