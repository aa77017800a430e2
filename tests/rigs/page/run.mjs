// Replays a case in a module of the live page: prints step and digest of each sample, a line each.
// Arguments: module, case, steps, steps between samples.
import { readFileSync } from "node:fs";

const [module, file, steps, every] = process.argv.slice(2);
const { instance } = await WebAssembly.instantiate(readFileSync(module), {});
const wasm = instance.exports;
const answer = () => Buffer.from(wasm.memory.buffer, wasm.answer(), wasm.answer_length()).toString();
const checked = (done) => {
  if (done !== 1) throw new Error(answer());
};
const text = readFileSync(file);
const room = wasm.room(text.length);
new Uint8Array(wasm.memory.buffer, room, text.length).set(text);
checked(wasm.open());
for (let step = 0; ; step += Number(every)) {
  checked(wasm.digest());
  console.log(`${wasm.step_count()} ${answer()}`);
  if (step >= Number(steps)) break;
  checked(wasm.advance(Number(every), 1));
}
