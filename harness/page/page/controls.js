// What the visitor does, and the start of the page.
"use strict";

// Does something that a visitor asked for; what is wrong with it is shown.
async function asked(act) {
  clearError();
  $("said").className = "";
  page.following = null;
  try {
    await act();
  } catch (error) {
    fail(error);
  }
}

function drag(way) {
  if (!page.bed) return;
  page.aim = null;
  asked(() => {
    if (way * speedOf() !== page.settings.velocity) change({ velocity: way === 0 ? 0 : way * speedOf() });
    if (!page.running) setRunning(true);
  });
}

function listen() {
  $("run").onclick = () => asked(() => setRunning(!page.running));
  $("once").onclick = () => asked(() => {
    setRunning(false);
    advance(PACES[$("pace").value]);
  });
  $("again").onclick = () => asked(() => {
    if (page.bed) return openBed(page.bed, page.settings);
    openFile("The same case", page.text);
  });
  $("left").onclick = () => drag(-1);
  $("stop").onclick = () => drag(0);
  $("right").onclick = () => drag(1);
  $("body").onchange = () => asked(() => openBed($("body").value, page.settings));
  for (const id of ["mu", "young", "speed", "pace"]) $(id).oninput = showOutputs;
  $("mu").onchange = () => asked(() => change({ mu: Number($("mu").value) }));
  $("young").onchange = () => asked(() => change({ young: Number($("young").value) }));
  $("speed").onchange = () => asked(() => {
    const velocity = Math.sign(page.settings.velocity) * speedOf();
    if (velocity !== page.settings.velocity) change({ velocity });
    page.changed = true;
  });
  for (const id of ["colour", "cut"]) $(id).onchange = () => { page.changed = true; };
  $("save").onclick = () => save();
  $("share").onclick = () => asked(share);
  $("file").onchange = () => take($("file").files[0]);
  document.addEventListener("dragover", (event) => {
    event.preventDefault();
    document.body.classList.add("over");
  });
  document.addEventListener("dragleave", () => document.body.classList.remove("over"));
  document.addEventListener("drop", (event) => {
    event.preventDefault();
    document.body.classList.remove("over");
    take(event.dataTransfer.files[0]);
  });
  $("view").addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const acts = { a: () => drag(-1), d: () => drag(1), s: () => drag(0), " ": () => $("run").click() };
    const act = acts[event.key.toLowerCase()];
    if (!act) return;
    event.preventDefault();
    act();
  });
  window.addEventListener("resize", () => { page.changed = true; });
  window.addEventListener("hashchange", () => {
    if (location.hash !== page.written) asked(goToAddress);
  });
}

function take(file) {
  if (!file) return;
  asked(async () => {
    const text = await textOf(file);
    openFile(file.name, text);
    $("file").value = "";
  });
}

function save() {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([page.text], { type: "application/json" }));
  link.download = "case.json";
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

async function share() {
  setRunning(false);
  const common = { digest: page.module.digest(), bits: page.module.bitsVersion };
  if (page.bed) {
    page.written = writeAddress({ ...common, bed: page.bed, start: page.starts[page.bed].name, runs: page.runs });
  } else {
    page.written = writeAddress({ ...common, packed: await packed(page.text), steps: page.module.step() });
  }
  if (page.written.length > ADDRESS_MAX) {
    throw new Error(`an address of this case would have ${grouped(page.written.length)} letters, and programs that ` +
      `pass addresses on cut what is longer than ${grouped(ADDRESS_MAX)}; hand on case.json and the step instead`);
  }
  location.hash = page.written;
  $("address").value = location.href;
  $("shared").hidden = false;
  $("address").select();
  say("The address names this case, this step and its digest. Whoever opens it computes all of it again.");
}

// Opens what the address says and runs to its step.
async function goToAddress() {
  const wanted = readAddress(location.hash);
  if (!wanted) return false;
  if (wanted.packed) {
    openFile("The case of the address", await unpacked(wanted.packed));
    page.following = { ...wanted, runs: [{ steps: wanted.steps }], run: 0 };
  } else {
    const own = page.starts[wanted.bed];
    if (!own) throw new Error(`the address asks for a bed round "${wanted.bed}"; this page has ball and cylinder`);
    if (own.name !== wanted.start) {
      throw new Error("the address was made by another version of this page, whose bed was another");
    }
    $("speed").value = Math.max(...wanted.runs.map((run) => Math.abs(run.velocity))) || speedOf();
    openBed(wanted.bed, settingsOf(wanted.runs[0]));
    page.following = { ...wanted, run: 0 };
  }
  setRunning(false);
  return true;
}

// Lets a pointer drag the body: sideways, at the speed of the slider.
function dragByPointer(canvas) {
  let from = null;
  const along = (event) => {
    const { left, top } = canvas.getBoundingClientRect();
    const point = page.module.bodies()[page.body].point;
    const at = page.viewer.project(point);
    const ahead = page.viewer.project([point[0] + from.size, point[1], point[2]]);
    const [dx, dy] = [ahead.x - at.x, ahead.y - at.y];
    const [px, py] = [event.clientX - left - at.x, event.clientY - top - at.y];
    return from.size * (px * dx + py * dy) / Math.max(1, dx * dx + dy * dy);
  };
  const isOver = (event) => {
    if (!page.bed || page.following) return false;
    const { left, top } = canvas.getBoundingClientRect();
    const at = page.viewer.project(page.module.bodies()[page.body].point);
    const off = Math.hypot(event.clientX - left - at.x, event.clientY - top - at.y);
    return off <= 0.5 * page.spec.obstacles[page.body].diameter * at.scale;
  };
  canvas.addEventListener("pointermove", (event) => {
    if (from?.pointer === event.pointerId) page.aim = page.travel + along(event);
    else if (event.buttons === 0) canvas.style.cursor = isOver(event) ? "ew-resize" : "";
  });
  for (const end of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(end, (event) => {
      if (from?.pointer !== event.pointerId) return;
      [from, page.aim] = [null, null];
      if (page.settings.velocity !== 0) asked(() => change({ velocity: 0 }));
    });
  }
  return (event) => {
    if (!isOver(event)) return false;
    from = { pointer: event.pointerId, size: page.spec.obstacles[page.body].diameter };
    canvas.setPointerCapture(event.pointerId);
    page.aim = page.travel;
    if (!page.running) setRunning(true);
    return true;
  };
}

function makeView() {
  const canvas = $("view");
  const nothing = (why) => {
    page.viewer = null;
    $("stage").classList.add("blind");
    const note = document.createElement("p");
    note.textContent = `There is no picture: ${why}. All else works: the case, its force and its digests.`;
    $("stage").append(note);
  };
  try {
    page.viewer = makeViewer(canvas, page.picture.scene);
  } catch (error) {
    return nothing(error.message);
  }
  canvas.addEventListener("webglcontextlost", () => nothing("the browser took WebGL away"));
  orbitBy(canvas, page.viewer, () => { page.changed = true; }, dragByPointer(canvas));
}

// Parts of the page that are kept packed.
const part = async (id) => inflated(fromBase64($(id).textContent.trim()));
const textPart = async (id) => new TextDecoder().decode(await part(id));

async function begin() {
  const about = new URLSearchParams(location.search);
  const wide = hasWide() && !about.has("plain");
  page.module = await instantiate(await part(wide ? "module-wide" : "module-plain"));
  const digests = JSON.parse($("digests").textContent);
  for (const bed of ["ball", "cylinder"]) {
    const spec = JSON.parse(await textPart(`bed-${bed}`));
    const own = withSettings(spec, page.settings);
    const lines = digests[bed].map(({ step, digest }) => [step, digest]);
    page.starts[bed] = { spec, text: JSON.stringify(own), digests: lines, name: lines[0][1].slice(0, 8) };
  }
  $("notices").textContent = await textPart("notices-packed");
  $("about").textContent = `bitgrain, arithmetic version ${page.module.bitsVersion}; WebAssembly ` +
    `${wide ? "with" : "without"} 128-bit instructions, with the same bits. This file asks nothing of any network.`;
  openBed("ball", page.settings);
  listen();
  makeView();
  showOutputs();
  say("");
  const followed = await goToAddress().catch((error) => { fail(error); return true; });
  const still = window.matchMedia("(prefers-reduced-motion: reduce)").matches;
  if (!followed && !still) setRunning(true);
  else showRun();
  requestAnimationFrame(frame);
}

begin().catch((error) => {
  const old = typeof DecompressionStream === "undefined" ? "; this browser is older than 2023" : "";
  fail(new Error(`the page cannot start: ${error.message}${old}`));
});
