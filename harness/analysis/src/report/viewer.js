// Grains and bodies in three dimensions, by WebGL 2 alone: spheres are quads on which each pixel finds its own
// place on the sphere, so that they are round at any size. Reports and the live page share this file.
"use strict";

// ColorBrewer's YlGnBu, as in the other pictures: distinct to the colour-blind, and darker with every step in grey too.
const RAMP = [[255, 255, 212], [161, 218, 180], [65, 182, 196], [44, 127, 184], [37, 52, 148]];
// Values of a grain that is not coloured: frozen or carried, and a body.
const FIXED = -1, BODY = -2;

const SPHERES = `#version 300 es
in vec2 corner;
in vec4 sphere;
in float value;
uniform mat4 view, projection;
out vec3 place, centre;
out float radius;
flat out float shown;
void main() {
  centre = (view * vec4(sphere.xyz, 1.0)).xyz;
  radius = sphere.w;
  shown = value;
  // The outline seen from nearby is larger than the sphere.
  float far2 = dot(centre, centre);
  float size = radius * sqrt(far2 / max(far2 - radius * radius, 1e-6 * far2));
  vec3 ahead = normalize(centre);
  vec3 side = normalize(cross(ahead, vec3(0.0, 1.0, 1e-4)));
  place = centre + size * (corner.x * side + corner.y * cross(side, ahead));
  gl_Position = projection * vec4(place, 1.0);
}`;

const COLOUR = `
uniform vec3 ramp[5];
uniform vec3 fixedColour, bodyColour;
vec3 colour(float value) {
  if (value < -1.5) return bodyColour;
  if (value < 0.0) return fixedColour;
  float at = clamp(value, 0.0, 1.0) * 4.0;
  int low = int(min(at, 3.0));
  return mix(ramp[low], ramp[low + 1], at - float(low));
}
vec3 lit(vec3 base, vec3 normal, vec3 ahead) {
  float light = 0.5 + 0.5 * max(dot(normal, vec3(-0.35, 0.7, 0.62)), 0.0);
  // A dark rim parts grains of one colour.
  float rim = smoothstep(0.0, 0.42, -dot(normal, ahead));
  return base * light * mix(0.45, 1.0, rim);
}`;

const ON_SPHERES = `#version 300 es
precision highp float;
in vec3 place, centre;
in float radius;
flat in float shown;
uniform mat4 projection;
out vec4 pixel;
${COLOUR}
void main() {
  vec3 ahead = normalize(place);
  float along = dot(centre, ahead);
  float inside = along * along - dot(centre, centre) + radius * radius;
  if (inside < 0.0) discard;
  vec3 at = ahead * (along - sqrt(inside));
  vec4 clip = projection * vec4(at, 1.0);
  gl_FragDepth = 0.5 + 0.5 * clip.z / clip.w;
  pixel = vec4(lit(colour(shown), (at - centre) / radius, ahead), 1.0);
}`;

const FACES = `#version 300 es
in vec3 corner;
in vec3 facing;
uniform mat4 view, projection;
uniform vec3 point;
uniform vec4 turn;
out vec3 place, normal;
vec3 turned(vec3 v) { return v + 2.0 * cross(turn.yzw, cross(turn.yzw, v) + turn.x * v); }
void main() {
  place = (view * vec4(point + turned(corner), 1.0)).xyz;
  normal = mat3(view) * turned(facing);
  gl_Position = projection * vec4(place, 1.0);
}`;

const ON_FACES = `#version 300 es
precision highp float;
in vec3 place, normal;
uniform float shown;
out vec4 pixel;
${COLOUR}
void main() {
  vec3 ahead = normalize(place), up = normalize(normal);
  if (dot(up, ahead) > 0.0) up = -up;
  pixel = vec4(lit(colour(shown), up, ahead), 1.0);
}`;

const LINES = `#version 300 es
in vec3 corner;
uniform mat4 view, projection;
void main() { gl_Position = projection * view * vec4(corner, 1.0); }`;

const ON_LINES = `#version 300 es
precision highp float;
uniform vec3 ink;
out vec4 pixel;
void main() { pixel = vec4(ink, 1.0); }`;

function compiled(gl, vertex, fragment) {
  const program = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
    throw new Error(`WebGL refuses a program: ${gl.getProgramInfoLog(program)}`);
  }
  const at = (name) => gl.getUniformLocation(program, name);
  return { program, at };
}

const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => a.map((x) => x / Math.hypot(...a));

// Columns of the matrix that turns and moves the world to the camera's axes.
function cameraMatrix(eye, target) {
  const back = unit(minus(eye, target));
  const side = unit(cross([0, 0, 1], back));
  const up = cross(back, side);
  const column = (k) => [side[k], up[k], back[k], 0];
  return [...column(0), ...column(1), ...column(2), -dot(side, eye), -dot(up, eye), -dot(back, eye), 1];
}

function perspective(aspect, near, far) {
  const f = 1 / Math.tan(0.3);
  // A narrow window shows the whole width.
  const [x, y] = aspect < 1.4 ? [f / 1.4, f * aspect / 1.4] : [f / aspect, f];
  const depth = 1 / (near - far);
  return [x, 0, 0, 0, 0, y, 0, 0, 0, 0, (far + near) * depth, -1, 0, 0, 2 * far * near * depth, 0];
}

// The faces of a bar about the origin as corners and normals, nine numbers of each for a triangle.
function barFaces(axis, radius, half) {
  const along = unit(axis);
  const side = unit(cross(along, Math.abs(along[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0]));
  const other = cross(along, side);
  const count = 48, corners = [], normals = [];
  const ring = (k) => {
    const [c, s] = [Math.cos(2 * Math.PI * k / count), Math.sin(2 * Math.PI * k / count)];
    return side.map((x, a) => c * x + s * other[a]);
  };
  const at = (out, end) => out.map((x, a) => radius * x + end * half * along[a]);
  for (let k = 0; k < count; k++) {
    const [a, b] = [ring(k), ring(k + 1)];
    corners.push(...at(a, -1), ...at(b, -1), ...at(b, 1), ...at(a, -1), ...at(b, 1), ...at(a, 1));
    normals.push(...a, ...b, ...b, ...a, ...b, ...a);
    for (const end of [-1, 1]) {
      const [first, last] = end > 0 ? [a, b] : [b, a];
      corners.push(...at([0, 0, 0], end), ...at(first, end), ...at(last, end));
      for (let n = 0; n < 3; n++) normals.push(...along.map((x) => end * x));
    }
  }
  return { corners, normals };
}

// A view of a scene on a canvas. Throws an `Error` if there is no WebGL 2.
//
// `scene` has the corners `lo` and `hi` of what is seen, and `faces`: one for each body that is no sphere, with
// `corners`, `normals` (nine numbers a triangle) and whether only its `inside` is drawn.
function makeViewer(canvas, scene) {
  const gl = canvas.getContext("webgl2", { antialias: false, alpha: true });
  if (!gl) throw new Error("this browser shows no WebGL 2");
  const spheres = compiled(gl, SPHERES, ON_SPHERES);
  const faces = compiled(gl, FACES, ON_FACES);
  const lines = compiled(gl, LINES, ON_LINES);
  const buffer = (values) => {
    const made = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, made);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(values), gl.STATIC_DRAW);
    return made;
  };
  const attribute = ({ program }, name, size, stride, offset, each) => {
    const at = gl.getAttribLocation(program, name);
    gl.enableVertexAttribArray(at);
    gl.vertexAttribPointer(at, size, gl.FLOAT, false, stride, offset);
    gl.vertexAttribDivisor(at, each);
  };

  const grainArray = gl.createVertexArray();
  gl.bindVertexArray(grainArray);
  buffer([-1, -1, 1, -1, -1, 1, 1, 1]);
  attribute(spheres, "corner", 2, 0, 0, 0);
  const grainBuffer = gl.createBuffer();
  gl.bindBuffer(gl.ARRAY_BUFFER, grainBuffer);
  attribute(spheres, "sphere", 4, 20, 0, 1);
  attribute(spheres, "value", 1, 20, 16, 1);

  const boxArray = gl.createVertexArray();
  gl.bindVertexArray(boxArray);
  const boxBuffer = buffer([]);
  attribute(lines, "corner", 3, 0, 0, 0);

  let meshes = [], low = [0, 0, 0], high = [1, 1, 1];
  const view = { azimuth: -0.9, elevation: 0.42, distance: 1 };
  const target = () => low.map((x, a) => 0.5 * (x + high[a]));

  function setScene({ lo, hi, faces: bodies }) {
    [low, high] = [lo, hi];
    const edge = (a, b) => [0, 1, 2].map((k) => [(a >> k) & 1, (b >> k) & 1].map((end) => (end ? hi : lo)[k]));
    const edges = [];
    // Corners by number: of two that share an edge one bit differs.
    for (let a = 0; a < 8; a++) {
      for (const bit of [1, 2, 4]) {
        if (a & bit) continue;
        const ends = edge(a, a | bit);
        for (const end of [0, 1]) edges.push(...ends.map((pair) => pair[end]));
      }
    }
    gl.bindBuffer(gl.ARRAY_BUFFER, boxBuffer);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(edges), gl.STATIC_DRAW);
    meshes = (bodies ?? []).map(({ corners, normals, inside }) => {
      const array = gl.createVertexArray();
      gl.bindVertexArray(array);
      buffer(corners);
      attribute(faces, "corner", 3, 0, 0, 0);
      buffer(normals);
      attribute(faces, "facing", 3, 0, 0, 0);
      return { array, count: corners.length / 3, inside };
    });
  }

  // Width, height and the two matrices of the present view.
  function camera() {
    const size = Math.hypot(...minus(high, low)) || 1;
    const away = 1.6 * size * view.distance;
    const [ce, se] = [Math.cos(view.elevation), Math.sin(view.elevation)];
    const out = [ce * Math.cos(view.azimuth), ce * Math.sin(view.azimuth), se];
    const eye = target().map((x, a) => x + away * out[a]);
    const [width, height] = [canvas.clientWidth || 1, canvas.clientHeight || 1];
    const near = Math.max(0.02 * size, away - 1.2 * size);
    return {
      width, height, eye,
      matrix: cameraMatrix(eye, target()),
      projection: perspective(width / height, near, away + 1.2 * size),
    };
  }

  // Where a point is in the canvas, in CSS pixels, and how many of them a length is there.
  function project(point) {
    const { width, height, matrix, projection } = camera();
    const row = (k) => [matrix[k], matrix[4 + k], matrix[8 + k]];
    const at = [0, 1, 2].map((k) => dot(row(k), point) + matrix[12 + k]);
    const [x, y] = [projection[0] * at[0] / -at[2], projection[5] * at[1] / -at[2]];
    return { x: 0.5 * width * (1 + x), y: 0.5 * height * (1 - y), scale: 0.5 * height * projection[5] / -at[2] };
  }

  // Draws rows of x, y, z, radius and value: from 0 to 1 along the ramp, `FIXED` or `BODY`. `poses` are point and
  // orientation (w, x, y, z) of each body with faces. What is nearer than the plane y = `cut` is left out.
  function draw({ rows, poses, cut, sharpness }) {
    const { width, height, eye, matrix, projection } = camera();
    const scale = sharpness ?? Math.min(2, window.devicePixelRatio || 1);
    const [w, h] = [Math.max(1, Math.round(width * scale)), Math.max(1, Math.round(height * scale))];
    if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
    gl.viewport(0, 0, w, h);
    gl.clearColor(0, 0, 0, 0);
    gl.enable(gl.DEPTH_TEST);
    gl.disable(gl.CULL_FACE);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const dark = window.matchMedia("(prefers-color-scheme: dark)").matches;
    const use = ({ program, at }) => {
      gl.useProgram(program);
      gl.uniformMatrix4fv(at("view"), false, matrix);
      gl.uniformMatrix4fv(at("projection"), false, projection);
      gl.uniform3fv(at("ramp"), RAMP.flat().map((x) => x / 255));
      gl.uniform3f(at("fixedColour"), 0.56, 0.55, 0.52);
      gl.uniform3f(at("bodyColour"), 0.86, 0.42, 0.1);
    };
    use(lines);
    gl.uniform3fv(lines.at("ink"), dark ? [0.6, 0.62, 0.66] : [0.4, 0.42, 0.45]);
    gl.bindVertexArray(boxArray);
    gl.drawArrays(gl.LINES, 0, 24);
    use(spheres);
    gl.bindVertexArray(grainArray);
    const kept = cut === null || cut === undefined ? rows : farRows(rows, cut, eye[1] < cut);
    gl.bindBuffer(gl.ARRAY_BUFFER, grainBuffer);
    gl.bufferData(gl.ARRAY_BUFFER, kept, gl.DYNAMIC_DRAW);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, kept.length / 5);
    use(faces);
    gl.uniform1f(faces.at("shown"), BODY);
    meshes.forEach(({ array, count, inside }, k) => {
      const { point, orientation } = poses[k];
      gl.uniform3fv(faces.at("point"), point);
      gl.uniform4fv(faces.at("turn"), orientation);
      if (inside) {
        gl.enable(gl.CULL_FACE);
        gl.cullFace(gl.FRONT);
      }
      gl.bindVertexArray(array);
      gl.drawArrays(gl.TRIANGLES, 0, count);
      gl.disable(gl.CULL_FACE);
    });
  }

  // Rows of bodies, and of grains beyond the plane from the eye.
  function farRows(rows, cut, fromBelow) {
    const out = new Float32Array(rows.length);
    let used = 0;
    for (let k = 0; k < rows.length; k += 5) {
      if (rows[k + 4] === BODY || (rows[k + 1] > cut) === fromBelow) {
        out.set(rows.subarray(k, k + 5), used);
        used += 5;
      }
    }
    return out.subarray(0, used);
  }

  const turn = (azimuth, elevation) => {
    view.azimuth += azimuth;
    view.elevation = Math.min(1.5, Math.max(-0.3, view.elevation + elevation));
  };
  const zoom = (factor) => { view.distance = Math.min(3, Math.max(0.25, view.distance * factor)); };
  const reset = () => Object.assign(view, { azimuth: -0.9, elevation: 0.42, distance: 1 });
  setScene(scene);
  return { draw, setScene, project, turn, zoom, reset, isLost: () => gl.isContextLost() };
}

// Pointer, touch and arrow keys turn a view, `+` and `-` bring it nearer; `changed` is called after each. A drag that
// `takes` (an event) claims is another's.
function orbitBy(canvas, viewer, changed, takes = () => false) {
  const held = new Map();
  const span = () => {
    const [a, b] = [...held.values()];
    return Math.hypot(a.x - b.x, a.y - b.y);
  };
  canvas.addEventListener("pointerdown", (event) => {
    if (held.size === 0 && takes(event)) return;
    held.set(event.pointerId, { x: event.clientX, y: event.clientY });
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    const from = held.get(event.pointerId);
    if (!from) return;
    const before = held.size === 2 ? span() : 0;
    const [dx, dy] = [event.clientX - from.x, event.clientY - from.y];
    Object.assign(from, { x: event.clientX, y: event.clientY });
    if (held.size === 2) viewer.zoom(before / Math.max(1, span()));
    else viewer.turn(-0.008 * dx, 0.008 * dy);
    changed();
  });
  for (const end of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(end, (event) => held.delete(event.pointerId));
  }
  const keys = {
    ArrowLeft: () => viewer.turn(-0.1, 0), ArrowRight: () => viewer.turn(0.1, 0),
    ArrowUp: () => viewer.turn(0, 0.1), ArrowDown: () => viewer.turn(0, -0.1),
    "+": () => viewer.zoom(0.9), "=": () => viewer.zoom(0.9), "-": () => viewer.zoom(1.1),
    Home: () => viewer.reset(),
  };
  canvas.addEventListener("keydown", (event) => {
    const act = keys[event.key];
    if (!act || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    act();
    changed();
  });
}
