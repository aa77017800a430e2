// The page: one case that is open, what moves it on, and what is shown of it.
"use strict";

const $ = (id) => document.getElementById(id);
const PACES = [1, 2, 5, 10, 20, 50, 100, 200];
// Milliseconds of a frame that steps may take while an address is followed.
const BUDGET = 25;

const page = {
  module: null, starts: {}, viewer: null, chart: makeChart($("chart")),
  // The bed, or null for the case of a file; what its settings are; the cases of the bed so far.
  bed: "ball", settings: { mu: 0.5, young: 2, velocity: 0.1 }, runs: [],
  // The open case, as data and as the text that the module was given.
  spec: null, text: "", picture: null, body: -1,
  // How far the body went along x since the start, and the time of the cases before this one.
  travel: 0, before: 0,
  // Digests of the command by step, and what they said so far.
  expected: new Map(), agreed: [], parted: [],
  running: false, changed: true, aim: null, top: { speed: 0, load: 0 }, following: null,
  shown: 0, rate: { frames: 0, since: 0, steps: 0, computing: 0, text: "" },
};

function fail(error) {
  page.running = false;
  page.aim = null;
  $("error").textContent = error.message ?? String(error);
  $("error").hidden = false;
  showRun();
}

const clearError = () => { $("error").hidden = true; };
const say = (text) => { $("said").textContent = text; };
const speedOf = () => Number($("speed").value);
const runNow = () => page.runs.at(-1);
const settingsOf = ({ mu, young, velocity }) => ({ mu, young, velocity });

// Opens a case by its text; the one before stays if it is refused.
function openCase(text, spec) {
  page.module.open(text);
  Object.assign(page, { text, spec, body: bodyNumber(spec), expected: new Map(), agreed: [], parted: [] });
  const state = page.module.state();
  page.picture = makePicture(spec, state);
  page.viewer?.setScene(page.picture.scene);
  page.changed = true;
}

// Opens the bed round a body from its start.
function openBed(bed, settings) {
  const spec = withSettings(page.starts[bed].spec, settings);
  openCase(JSON.stringify(spec), spec);
  Object.assign(page, { bed, settings, runs: [{ ...settings, steps: 0 }] });
  forget();
  const own = page.starts[bed];
  // The command's digests that came with the page are of the case as the bed brings it.
  if (page.text === own.text) page.expected = new Map(own.digests);
  compare();
  showSettings();
}

function forget() {
  Object.assign(page, { travel: 0, before: 0, top: { speed: 0, load: 0 } });
  page.chart.clear();
}

// Goes on from the present state as a new case with other settings.
function change(settings) {
  const next = { ...page.settings, ...settings };
  if (runNow().steps === 0 && page.runs.length === 1) return openBed(page.bed, next);
  const before = page.before + page.spec.dt * page.module.step();
  const spec = withSettings(caseNow(page.spec, page.module.state(), page.module.bodies()), next);
  openCase(JSON.stringify(spec), spec);
  if (runNow().steps === 0) page.runs.pop();
  page.runs.push({ ...next, steps: 0 });
  Object.assign(page, { settings: next, before });
  showSettings();
}

// Opens the text of a file. Its case is replayed as it is.
function openFile(name, text) {
  const digests = digestLines(text);
  if (digests) {
    Object.assign(page, { expected: digests, agreed: [], parted: [] });
    compare();
    return say(`${name}: digests of ${digests.size} steps. They are compared as the case comes to them.`);
  }
  let spec = null;
  try {
    spec = JSON.parse(text);
  } catch {
    // The module says where it is wrong.
  }
  openCase(text, spec);
  Object.assign(page, { bed: null, runs: [], aim: null });
  forget();
  showSettings();
  say(`${name}: ${grouped(page.module.state().count)} grains.`);
}

// Steps on by so many, but not past a step of which the command's digest is known.
function advance(steps) {
  const at = page.module.step();
  const next = Math.min(...[...page.expected.keys()].filter((step) => step > at), at + steps);
  const place = () => page.module.bodies()[page.body]?.point[0] ?? 0;
  const from = place();
  page.module.advance(next - at, page.body < 0 ? 0xffffffff : page.body);
  const period = page.spec.box?.periodic[0] ? page.spec.box.hi[0] - page.spec.box.lo[0] : Infinity;
  const way = place() - from;
  // Through the edge of a periodic box, if that is the shorter way.
  page.travel += Math.abs(way) > 0.5 * period ? way - Math.sign(way) * period : way;
  page.rate.steps += next - at;
  if (page.bed) runNow().steps = next;
  if (page.body >= 0) page.chart.add(page.travel, page.module.meanForce()[0]);
  if (page.expected.has(next)) compare();
  page.changed = true;
}

// Compares the present digest with the command's.
function compare() {
  const step = page.module.step(), said = page.expected.get(step);
  if (said === undefined || page.agreed.includes(step) || page.parted.includes(step)) return;
  (said === page.module.digest() ? page.agreed : page.parted).push(step);
}

// One frame: steps, then what is shown.
function frame(now) {
  requestAnimationFrame(frame);
  const began = performance.now();
  try {
    if (page.following) follow();
    else if (page.running) {
      if (page.aim !== null) steer();
      advance(PACES[$("pace").value]);
    }
  } catch (error) {
    page.following = null;
    fail(error);
  }
  page.rate.computing += performance.now() - began;
  measure(now);
  if (!page.changed) return;
  page.changed = false;
  draw();
  // Ten times a second is as often as numbers can be read.
  const due = now - page.shown > 100;
  if (due || !(page.running || page.following)) {
    page.shown = now;
    showNumbers();
  }
}

// Turns the body towards the place that a pointer asks for, or stops it there.
function steer() {
  const off = page.aim - page.travel;
  const step = speedOf() * page.spec.dt * PACES[$("pace").value];
  const moving = page.settings.velocity !== 0;
  // It stops within a step of the place and goes again once the pointer has left it by more.
  const wanted = Math.abs(off) < (moving ? step : 3 * step) ? 0 : Math.sign(off) * speedOf();
  if (wanted !== page.settings.velocity) change({ velocity: wanted });
}

// Follows the runs of an address, some each frame.
function follow() {
  const { runs, bed } = page.following;
  const until = performance.now() + BUDGET;
  while (performance.now() < until) {
    const at = page.following.run;
    const left = runs[at].steps - page.module.step();
    if (left > 0) {
      advance(Math.min(left, 20));
    } else if (at + 1 < runs.length) {
      page.following.run += 1;
      if (bed) change(settingsOf(runs[at + 1]));
    } else {
      return arrive();
    }
  }
  say(`Going to step ${grouped(runs.at(-1).steps)} of the address: at ${grouped(page.module.step())}` +
    `${runs.length > 1 ? `, case ${page.following.run + 1} of ${runs.length}` : ""}.`);
}

function arrive() {
  const { digest, bits } = page.following;
  page.following = null;
  // The numbers of the last step may not have been due for show yet.
  page.changed = true;
  const own = page.module.digest();
  const agrees = own === digest;
  const why = bits === page.module.bitsVersion ? "this browser or the address does not keep the bits"
    : `the address was made with arithmetic version ${bits}, and this page has ${page.module.bitsVersion}`;
  const step = grouped(page.module.step());
  say(agrees ? `Step ${step}, as in the address, and the digest is the same.`
    : `Step ${step}, as in the address, but the digest is another: ${why}.`);
  $("said").className = agrees ? "good" : "bad";
}

function measure(now) {
  const { rate } = page;
  rate.frames += 1;
  const took = now - rate.since;
  if (took < 1000) return;
  const frames = 1e3 * rate.frames / took, computing = rate.computing / rate.frames;
  rate.text = "";
  if (rate.steps > 0) {
    const slower = took / 1e3 / (rate.steps * page.spec.dt), seconds = page.bed ? "s" : "";
    const whose = page.bed ? "Slow motion: 1 s of the bed takes" : "A unit of its time takes";
    rate.text = `${whose} ${short(slower)} s here: ${PACES[$("pace").value]} steps of ` +
      `${quantity(page.spec.dt, seconds)} a frame, ${short(frames)} frames a second, ${short(computing)} ms of each ` +
      `for the steps.`;
    // Where drawing holds up the steps, as without a graphics processor, fewer pixels are drawn.
    const drawing = 1e3 / frames - computing;
    if (frames < 24 && drawing > 20) page.sharpness = Math.max(0.6, 0.8 * (page.sharpness ?? 1));
  }
  Object.assign(rate, { frames: 0, steps: 0, computing: 0, since: now });
  page.changed ||= rate.text !== "";
}

// The value at the end of the ramp.
function rampTop(state, colour) {
  if (colour === "speed" && page.bed) return speedOf();
  let most = page.top[colour];
  for (let i = 0; i < state.count; i++) most = Math.max(most, colour === "speed" ? speed(state, i) : state.loads[i]);
  page.top[colour] = most;
  return roundUp(most);
}

function draw() {
  const state = page.module.state(), bodies = page.module.bodies(), colour = $("colour").value;
  const ramp = { colour, top: rampTop(state, colour) };
  const { rows, poses } = page.picture.update(state, bodies, ramp);
  const sign = page.bed ? { speed: "m/s", load: "N" }[colour] : "";
  const body = page.body < 0 ? "" : (page.bed ?? page.spec.obstacles[page.body].shape);
  legend($("legend"), { ...ramp, unit: sign, body, hasFixed: page.picture.hasFixed });
  const { lo, hi } = page.picture.scene;
  const through = page.body < 0 ? 0.5 * (lo[1] + hi[1]) : bodies[page.body].point[1];
  const cut = $("cut").checked ? through : null;
  page.viewer?.draw({ rows, poses, cut, sharpness: page.sharpness });
}

function showNumbers() {
  const step = page.module.step(), [length, force] = page.bed ? ["m", "N"] : ["", ""];
  const time = page.before + step * page.spec.dt;
  const earlier = page.runs.length > 1 ? ` of case ${page.runs.length} since the start` : "";
  $("clock").textContent = `Step ${grouped(step)}${earlier}; ${quantity(time, page.bed ? "s" : "")} of the bed. ` +
    (page.running ? page.rate.text : "It stands still.");
  if (page.body >= 0) {
    const [x, , z] = page.module.meanForce();
    $("force").textContent = `Mean of the last frame: ${quantity(x, force)} along x, ${quantity(z, force)} upwards, ` +
      `after a travel of ${quantity(page.travel, length)}.`;
  } else {
    $("force").textContent = "This case has no body but planes.";
  }
  page.chart.draw(length, force);
  $("digest").textContent = page.module.digest();
  showAgreement();
  $("command").textContent = `bitgrain replay case.json --steps ${step} --digests`;
}

function showAgreement() {
  const last = page.parted.at(-1) ?? page.agreed.at(-1);
  $("expected").textContent = last === undefined ? "" : page.expected.get(last);
  const agrees = $("agrees");
  const steps = (n) => (n === 1 ? "1 step" : `${n} steps`);
  agrees.className = page.parted.length ? "bad" : "good";
  if (page.parted.length) agrees.textContent = `step ${grouped(page.parted[0])}: another digest than here`;
  else if (last !== undefined) agrees.textContent = `step ${grouped(last)}: the same as here, as at all ` +
    `${steps(page.agreed.length)} so far`;
  else agrees.textContent = page.expected.size ? "no step of it has come yet"
    : "not known here: run the line below and drop what it prints on this page";
  if (last === undefined) agrees.className = "";
}

function showSettings() {
  const { mu, young, velocity } = page.settings;
  const own = page.bed !== null;
  $("physics").disabled = !own;
  for (const button of $("drag").querySelectorAll("button")) button.disabled = !own;
  if (own) {
    [$("body").value, $("mu").value, $("young").value] = [page.bed, mu, young];
    for (const name of document.querySelectorAll(".body-name")) name.textContent = page.bed;
  }
  const pressed = { left: velocity < 0, stop: velocity === 0, right: velocity > 0 };
  for (const [id, on] of Object.entries(pressed)) $(id).setAttribute("aria-pressed", own && on);
  showOutputs();
}

function showOutputs() {
  const beside = (id, text) => {
    let element = $(id).nextElementSibling;
    element.textContent = text;
    $(id).setAttribute("aria-valuetext", text);
  };
  beside("mu", Number($("mu").value).toFixed(2));
  beside("young", quantity(STIFFNESS[$("young").value][0], "Pa"));
  beside("speed", quantity(speedOf(), "m/s"));
  beside("pace", String(PACES[$("pace").value]));
}

function showRun() {
  $("run").textContent = page.running ? "Pause" : "Run";
  $("run").setAttribute("aria-pressed", page.running);
  page.changed = page.module !== null;
}

function setRunning(running) {
  page.running = running;
  Object.assign(page.rate, { since: performance.now(), frames: 0, steps: 0, computing: 0, text: "" });
  showRun();
}
