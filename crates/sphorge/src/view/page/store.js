// What was read of a run, kept as far as memory allows: a frame that was written does not change.
"use strict";

/** Bytes of arrays that are kept of all runs. */
const MOST_KEPT = 600e6;

class Store {
  #source;
  /** Promises by name, the ones used last at the end. */
  #kept = new Map();
  #bytes = 0;

  constructor(source) {
    this.#source = source;
  }

  #get(key, read) {
    let entry = this.#kept.get(key);
    if (entry) {
      this.#kept.delete(key);
    } else {
      entry = { bytes: 0, promise: read() };
      entry.promise.then(
        (value) => {
          if (this.#kept.get(key) !== entry) return;
          entry.bytes = value.byteLength ?? value.values?.byteLength ?? value.places?.byteLength ?? 0;
          this.#bytes += entry.bytes;
          this.#forget();
        },
        // What could not be read is asked for again.
        () => this.#drop(key, entry),
      );
    }
    this.#kept.set(key, entry);
    return entry.promise;
  }

  #drop(key, entry) {
    if (this.#kept.get(key) !== entry) return;
    this.#kept.delete(key);
    this.#bytes -= entry.bytes;
  }

  #forget() {
    for (const [key, entry] of this.#kept) {
      if (this.#bytes <= MOST_KEPT) break;
      if (entry.bytes > 1000) this.#drop(key, entry);
    }
  }

  /** Forgets a run: another one has its folder now. */
  reset(run) {
    for (const [key, entry] of this.#kept) {
      if (key.startsWith(`${run}/`)) this.#drop(key, entry);
    }
  }

  array(run, frame, name) {
    return this.#get(`${run}/${frame}/${name}`, () => this.#source.array(run, frame, name));
  }

  range(run, frame, name) {
    return this.#get(`${run}/${frame}/range ${name}`, () => this.#source.range(run, frame, name));
  }

  nodes(run, frame) {
    return this.#get(`${run}/${frame}/nodes`, () => this.#source.nodes(run, frame));
  }

  cells(run) {
    return this.#get(`${run}/cells`, () => this.#source.cells(run));
  }

  /** A column of the history, which grows: that of so many rows. */
  column(run, rows, column) {
    return this.#get(`${run}/history ${column} ${rows}`, () => this.#source.column(run, column));
  }

  particle(run, frame, particle) {
    return this.#source.particle(run, frame, particle);
  }
}
