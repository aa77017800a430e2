// The WebAssembly module behind plain functions.
"use strict";

// Numbers of a body in the module's rows.
const BODY_NUMBERS = 13;

// The shortest module with a 128-bit instruction: whether this browser takes it says which build it is given.
const WIDE = new Uint8Array([0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 8, 1, 6, 0, 65, 0,
  253, 15, 11]);

const hasWide = () => WebAssembly.validate(WIDE);

async function instantiate(bytes) {
  const { instance } = await WebAssembly.instantiate(bytes, {});
  const wasm = instance.exports;
  const answer = () => {
    const bytes = new Uint8Array(wasm.memory.buffer, wasm.answer(), wasm.answer_length());
    return new TextDecoder().decode(bytes);
  };
  // Once the module has failed its memory may be in any state: all that follows says so.
  let broken = "";
  const checked = (act) => {
    if (broken) throw new Error(broken);
    let done = 0;
    try {
      done = act();
    } catch (error) {
      broken = `the module failed: ${answer() || error.message}; load the page again`;
      throw new Error(broken);
    }
    if (!done) throw new Error(answer());
  };
  const numbers = (at, count) => new Float64Array(wasm.memory.buffer, at, count);
  return {
    bitsVersion: wasm.bits_version(),
    // Opens a case by its text. Throws an `Error` that says what is wrong with it.
    open(text) {
      const bytes = new TextEncoder().encode(text);
      checked(() => {
        const at = wasm.room(bytes.length);
        new Uint8Array(wasm.memory.buffer, at, bytes.length).set(bytes);
        return wasm.open();
      });
    },
    // Makes so many steps. Throws an `Error` that says why the case cannot go on.
    advance: (steps, body) => checked(() => wasm.advance(steps, body)),
    digest() {
      checked(() => wasm.digest());
      return answer();
    },
    step: () => wasm.step_count(),
    // Rows in the module's memory, until its next call.
    state() {
      const count = wasm.count();
      return {
        count,
        ids: new Uint32Array(wasm.memory.buffer, wasm.ids(), count),
        positions: numbers(wasm.positions(), 4 * count),
        velocities: numbers(wasm.velocities(), 4 * count),
        spins: numbers(wasm.spins(), 4 * count),
        loads: numbers(wasm.loads(), count),
      };
    },
    // Point, orientation (w, x, y, z), velocity and force of each body.
    bodies() {
      const all = numbers(wasm.bodies(), BODY_NUMBERS * wasm.body_count());
      return Array.from({ length: wasm.body_count() }, (_, k) => {
        const row = all.subarray(BODY_NUMBERS * k, BODY_NUMBERS * (k + 1));
        const part = (from, to) => Array.from(row.subarray(from, to));
        return { point: part(0, 3), orientation: part(3, 7), velocity: part(7, 10), force: part(10, 13) };
      });
    },
    meanForce: () => Array.from(numbers(wasm.mean_force(), 3)),
  };
}
