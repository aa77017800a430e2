// What the view shows of a case: rows of spheres with their colours, faces of other bodies, and the legend.
"use strict";

// Decades of the ramp below its top.
const DECADES = { speed: 2, load: 2 };

function turned([w, x, y, z], v) {
  const t = cross([x, y, z], v).map((c) => 2 * c);
  const again = cross([x, y, z], t);
  return v.map((c, k) => c + w * t[k] + again[k]);
}

function boxFaces([a, b, c]) {
  const corners = [], normals = [];
  for (const axis of [0, 1, 2]) {
    for (const end of [-1, 1]) {
      const [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
      const corner = (p, q) => {
        const at = [0, 0, 0];
        [at[axis], at[u], at[v]] = [end, p, q];
        return [at[0] * a, at[1] * b, at[2] * c];
      };
      const normal = [0, 1, 2].map((k) => (k === axis ? end : 0));
      for (const [p, q] of [[-1, -1], [1, -1], [1, 1], [-1, -1], [1, 1], [-1, 1]]) {
        corners.push(...corner(p, q));
        normals.push(...normal);
      }
    }
  }
  return { corners, normals };
}

function triangleFaces(triangles) {
  const normal = ([a, b, c]) => {
    const up = cross(minus(b, a), minus(c, a));
    return dot(up, up) > 0 ? unit(up) : [0, 0, 1];
  };
  const points = triangles.map((t) => [t.slice(0, 3), t.slice(3, 6), t.slice(6, 9)]);
  return { corners: triangles.flat(), normals: points.flatMap((t) => [...normal(t), ...normal(t), ...normal(t)]) };
}

// Faces of a body about its own point; none of a sphere or a plane. An endless bar is as long as `length`.
function facesOf(body, length) {
  const radius = 0.5 * body.diameter;
  switch (body.shape) {
    case "cylinder": return barFaces(body.axis, radius, 0.5 * (body.length ?? length));
    case "drum": return { ...barFaces(body.axis, radius, 0.5 * body.length), inside: true };
    case "capsule": return barFaces(body.axis, radius, body.half_length);
    case "box": return boxFaces(body.half);
    case "mesh": return triangleFaces(body.triangles);
    default: return null;
  }
}

// A picture of a case: its scene, and the rows and poses of a state.
function makePicture(spec, state) {
  const { lo, hi } = extent(spec, state);
  const length = Math.hypot(...minus(hi, lo));
  const solid = (spec.obstacles ?? []).map((body, k) => ({ body, k, faces: facesOf(body, length) }));
  // An endless bar is drawn from edge to edge of the box along its axis, which is x, y or z there.
  for (const one of solid) {
    const { body } = one;
    if (body.shape !== "cylinder" || body.length) continue;
    const along = body.axis.findIndex((x) => x !== 0);
    if (body.axis.every((x, a) => a === along || x === 0)) {
      one.faces = barFaces(body.axis, 0.5 * body.diameter, 0.5 * (hi[along] - lo[along]));
      one.along = along;
    }
  }
  const withFaces = solid.filter(({ faces }) => faces);
  const balls = solid.flatMap(({ body, k }) => {
    if (body.shape === "sphere") return [{ k, off: [0, 0, 0], radius: 0.5 * body.diameter }];
    if (body.shape !== "capsule") return [];
    const ends = [-1, 1].map((end) => unit(body.axis).map((x) => end * body.half_length * x));
    return ends.map((off) => ({ k, off, radius: 0.5 * body.diameter }));
  });
  const motion = new Map(spec.grains.map((grain) => [grain.id, grain.motion ?? "free"]));
  const isFixed = Array.from(state.ids, (id) => motion.get(id) === "frozen");
  const rows = new Float32Array(5 * (state.count + balls.length));
  const scene = { lo, hi, faces: withFaces.map(({ faces }) => faces) };

  // `top` is the value at the end of the ramp.
  function update(now, bodies, { colour, top }) {
    const decades = DECADES[colour];
    for (let i = 0; i < now.count; i++) {
      const [at, to] = [4 * i, 5 * i];
      for (let a = 0; a < 4; a++) rows[to + a] = now.positions[at + a];
      const value = colour === "speed" ? speed(now, i) : now.loads[i];
      const place = 1 + Math.log10(value / top) / decades;
      rows[to + 4] = isFixed[i] && colour === "speed" ? FIXED : Math.min(1, Math.max(0, place || 0));
    }
    balls.forEach(({ k, off, radius }, n) => {
      const { point, orientation } = bodies[k];
      const at = turned(orientation, off).map((x, a) => x + point[a]);
      rows.set([...at, radius, BODY], 5 * (now.count + n));
    });
    const poses = withFaces.map(({ k, along }) => {
      const { point, orientation } = bodies[k];
      const shown = point.map((x, a) => (a === along ? 0.5 * (lo[a] + hi[a]) : x));
      return { point: shown, orientation };
    });
    return { rows, poses };
  }
  return { scene, update, hasFixed: isFixed.includes(true) };
}

const speed = ({ velocities }, i) => Math.hypot(velocities[4 * i], velocities[4 * i + 1], velocities[4 * i + 2]);

// The box of a case as far as it is filled.
function extent(spec, { count, positions }) {
  const [lo, hi] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  const add = (point, radius) => point.forEach((x, a) => {
    lo[a] = Math.min(lo[a], x - radius);
    hi[a] = Math.max(hi[a], x + radius);
  });
  for (let i = 0; i < count; i++) add(Array.from(positions.subarray(4 * i, 4 * i + 3)), positions[4 * i + 3]);
  for (const body of spec.obstacles ?? []) {
    const size = body.diameter ?? Math.max(...(body.half ?? [0]));
    if (body.center && !(body.shape === "cylinder" && !body.length)) add(body.center, 0.5 * size);
  }
  for (const a of [0, 1, 2]) {
    if (!spec.box) continue;
    // Along a periodic axis all of the box is there.
    if (spec.box.periodic[a]) [lo[a], hi[a]] = [spec.box.lo[a], spec.box.hi[a]];
    else [lo[a], hi[a]] = [Math.max(lo[a], spec.box.lo[a]), Math.min(hi[a], spec.box.hi[a])];
  }
  return { lo, hi };
}

function legend(holder, { colour, top, unit: sign, body, hasFixed }) {
  const bar = `linear-gradient(to right,${RAMP.map((rgb) => `rgb(${rgb})`).join(",")})`;
  const low = top / 10 ** DECADES[colour];
  const dot = (colour, name) => `<span><span class="dot" style="background:${colour}"></span>${name}</span>`;
  const name = colour === "speed" ? "speed" : "sum of normal forces";
  const parts = [`<span>${name}: ${quantity(low, sign)} or less<span class="bar" style="background:${bar}"></span>` +
    `${quantity(top, sign)} or more</span>`];
  if (body) parts.push(dot("rgb(219,107,26)", body));
  if (hasFixed && colour === "speed") parts.push(dot("rgb(143,140,133)", "frozen base"));
  const text = parts.join("");
  if (holder.innerHTML !== text) holder.innerHTML = text;
}
