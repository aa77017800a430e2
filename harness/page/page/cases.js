// Cases as the command reads them: the start of a bed, the same with other numbers, and one from a present state.
"use strict";

// Young's modulus (Pa) and the time step (s) that goes with it: at most 0.11 of the Rayleigh time.
const STIFFNESS = [[1e6, 4e-5], [2e6, 2.8e-5], [4e6, 2e-5], [8e6, 1.4e-5], [1.6e7, 1e-5]];

// The number of the body that is dragged: the first obstacle that is no plane, or -1.
const bodyNumber = (spec) => (spec.obstacles ?? []).findIndex((body) => body.shape !== "plane");

// The case with another friction, stiffness (a place in `STIFFNESS`) and velocity of its body along x (m/s).
function withSettings(spec, { mu, young, velocity }) {
  const body = bodyNumber(spec);
  const moved = (one, k) => (k === body ? { ...one, velocity: [velocity, 0, 0] } : one);
  const [modulus, dt] = STIFFNESS[young];
  return { ...spec, law: { ...spec.law, mu, young: modulus }, dt, obstacles: spec.obstacles.map(moved) };
}

// The case that begins with the present state of an opened one: places, velocities and spins of its grains, and places
// of its bodies. What contacts remember is not part of a case.
function caseNow(spec, state, bodies) {
  const triple = (rows, k) => Array.from(rows.subarray(4 * k, 4 * k + 3));
  const byName = new Map(spec.grains.map((grain) => [grain.id, grain]));
  const grain = (id, k) => ({
    ...byName.get(id),
    position: triple(state.positions, k),
    velocity: triple(state.velocities, k),
    spin: triple(state.spins, k),
  });
  const body = (one, k) => (one.shape === "plane" ? one : { ...one, center: bodies[k].point });
  return { ...spec, grains: Array.from(state.ids, grain), obstacles: spec.obstacles.map(body) };
}

// What the part of an address after `#` says. `runs` are the cases of a bed one after the other, with steps of each.
//
// bed=ball&start=1234abcd&run=0.5,2,0.1,1200;0.5,2,0,300&digest=...&bits=1, or case=...&steps=1200&digest=...&bits=1
function readAddress(text) {
  const parts = new URLSearchParams(text.replace(/^#/, ""));
  const given = (key) => parts.get(key) ?? "";
  const wrong = (what) => new Error(`the address is not whole: ${what}; copy it again`);
  if (!parts.has("bed") && !parts.has("case")) return null;
  const common = { digest: given("digest"), bits: Number(given("bits")) };
  if (!/^[0-9a-f]{64}$/.test(common.digest)) throw wrong("it has no digest of 64 hexadecimal digits");
  const whole = (n) => Number.isSafeInteger(n) && n >= 0;
  if (parts.has("case")) {
    const steps = Number(given("steps"));
    if (!whole(steps)) throw wrong("its number of steps is none");
    return { ...common, packed: given("case"), steps };
  }
  const runs = given("run").split(";").map((run) => {
    const [mu, young, velocity, steps, ...more] = run.split(",").map(Number);
    const sound = mu >= 0 && mu <= 1 && STIFFNESS[young] && Math.abs(velocity) <= 1 && whole(steps);
    if (!sound || more.length) throw wrong(`"${run.slice(0, 60)}" is no friction, stiffness, velocity and steps`);
    return { mu, young, velocity, steps };
  });
  return { ...common, bed: given("bed"), start: given("start"), runs };
}

function writeAddress({ bed, start, runs, packed, steps, digest, bits }) {
  const run = ({ mu, young, velocity, steps }) => [mu, young, velocity, steps].join(",");
  const what = packed ? `case=${packed}&steps=${steps}` : `bed=${bed}&start=${start}&run=${runs.map(run).join(";")}`;
  return `#${what}&digest=${digest}&bits=${bits}`;
}

// Most letters of a case in an address: longer ones are cut by programs that pass them on.
const ADDRESS_MAX = 16000;

async function through(bytes, stream) {
  return new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer());
}

const inflated = (bytes) => through(bytes, new DecompressionStream("deflate-raw"));

function fromBase64(text) {
  const letters = atob(text.replaceAll("-", "+").replaceAll("_", "/"));
  return Uint8Array.from(letters, (letter) => letter.charCodeAt(0));
}

async function packed(text) {
  const bytes = await through(new TextEncoder().encode(text), new CompressionStream("deflate-raw"));
  const letters = Array.from(bytes, (byte) => String.fromCharCode(byte)).join("");
  return btoa(letters).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
}

async function unpacked(text) {
  try {
    return new TextDecoder("utf-8", { fatal: true }).decode(await inflated(fromBase64(text)));
  } catch {
    throw new Error("the address is not whole: its case cannot be unpacked; copy it again");
  }
}

// Most bytes of a file: some 200,000 grains.
const FILE_MAX = 64e6;

// The text of a file that was opened or dropped; plain or gzip, as the command reads them.
async function textOf(file) {
  if (file.size > FILE_MAX) {
    throw new Error(`${file.name}: has ${file.size} bytes; this page reads at most ${FILE_MAX}`);
  }
  let bytes = new Uint8Array(await file.arrayBuffer());
  if (bytes[0] === 0x1f && bytes[1] === 0x8b) bytes = await through(bytes, new DecompressionStream("gzip"));
  return new TextDecoder().decode(bytes);
}

// The digests by step, if a text is what `bitgrain replay` printed; none if it is not.
function digestLines(text) {
  const found = new Map();
  for (const line of text.split("\n")) {
    if (!line.trim()) continue;
    let said = null;
    try {
      said = JSON.parse(line);
    } catch {
      return null;
    }
    if (!Number.isSafeInteger(said?.step) || !/^[0-9a-f]{64}$/.test(said.digest)) return null;
    found.set(said.step, said.digest);
  }
  return found.size ? found : null;
}
