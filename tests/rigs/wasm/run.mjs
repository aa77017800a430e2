// Runs a module that imports nothing and prints the text that it leaves in its memory.
import { readFileSync, writeSync } from "node:fs";

const { instance } = await WebAssembly.instantiate(readFileSync(process.argv[2]), {});
const { memory, run, text } = instance.exports;
const length = run();
const bytes = new Uint8Array(memory.buffer, text(), length);
for (let sent = 0; sent < length; ) {
  sent += writeSync(1, bytes, sent);
}
