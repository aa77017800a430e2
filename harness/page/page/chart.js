// Numbers with their units, and the chart of force against travel.
"use strict";

const PREFIXES = [[1e6, "M"], [1e3, "k"], [1, ""], [1e-3, "m"], [1e-6, "µ"], [1e-9, "n"]];

// Three digits of a number, with a prefix if it has a unit.
function quantity(value, unit) {
  if (!unit || value === 0 || !Number.isFinite(value)) return `${short(value)}${unit ? ` ${unit}` : ""}`;
  const size = Math.abs(value);
  const [factor, prefix] = PREFIXES.find(([least]) => size >= 0.9995 * least) ?? PREFIXES.at(-1);
  return `${short(value / factor)} ${prefix}${unit}`;
}

function short(value) {
  const size = Math.abs(value);
  if (value === 0 || !Number.isFinite(value)) return String(value);
  if (size >= 1e5 || size < 1e-3) return value.toExponential(2).replace("-", "\u2212");
  return String(Number(value.toPrecision(3))).replace("-", "\u2212");
}

const grouped = (n) => String(n).replace(/\B(?=(\d{3})+$)/g, ",");

// The least of 1, 2 and 5 times a power of ten that is at least `value`.
function roundUp(value) {
  if (!(value > 0) || !Number.isFinite(value)) return 1;
  const power = 10 ** Math.floor(Math.log10(value));
  return [1, 2, 5, 10].map((n) => n * power).find((n) => n >= value * (1 - 1e-9));
}

// Most points of the curve: then every two become one.
const POINTS = 1500;

// A curve in `holder`; lengths and forces are shown with these units, or without.
function makeChart(holder) {
  let points = [], together = 1, pending = [];
  const clear = () => { [points, together, pending] = [[], 1, []]; };
  const mean = (some) => [0, 1].map((k) => some.reduce((sum, point) => sum + point[k], 0) / some.length);
  function add(travel, force) {
    pending.push([travel, force]);
    if (pending.length < together) return;
    points.push(mean(pending));
    pending = [];
    if (points.length >= POINTS) {
      points = points.filter((_, k) => k % 2 === 0).map((_, k) => mean(points.slice(2 * k, 2 * k + 2)));
      together *= 2;
    }
  }
  function draw(lengthUnit, forceUnit) {
    const [width, height, left, right, top, bottom] = [420, 250, 58, 14, 10, 40];
    const span = (k) => [Math.min(0, ...points.map((p) => p[k])), Math.max(0, ...points.map((p) => p[k]))];
    const axis = (k, unit) => {
      let [low, high] = span(k);
      if (high === low) high = low + (unit ? 1e-3 : 1);
      const step = roundUp((high - low) / 5);
      const size = Math.max(-low, high);
      const [factor, prefix] = unit ? PREFIXES.find(([least]) => size >= least) ?? PREFIXES.at(-1) : [1, ""];
      const from = Math.floor(low / step + 1e-9), to = Math.ceil(high / step - 1e-9);
      const ticks = Array.from({ length: to - from + 1 }, (_, n) => (from + n) * step);
      const [lo, hi] = [ticks[0], ticks.at(-1)];
      const at = k === 0 ? (x) => left + (width - left - right) * (x - lo) / (hi - lo)
        : (y) => height - bottom - (height - top - bottom) * (y - lo) / (hi - lo);
      const label = (x) => short(Number((x / factor).toPrecision(6)));
      return { at, ticks, label, unit: `${prefix}${unit}` || "case" };
    };
    const [x, y] = [axis(0, lengthUnit), axis(1, forceUnit)];
    const line = (d, kind) => `<path class="${kind}" d="${d}"/>`;
    const parts = [];
    for (const tick of x.ticks) {
      parts.push(line(`M${x.at(tick)} ${top}V${height - bottom}`, tick === 0 ? "zero" : "axis"));
      parts.push(`<text x="${x.at(tick)}" y="${height - bottom + 15}" text-anchor="middle">${x.label(tick)}</text>`);
    }
    for (const tick of y.ticks) {
      parts.push(line(`M${left} ${y.at(tick)}H${width - right}`, tick === 0 ? "zero" : "axis"));
      parts.push(`<text x="${left - 5}" y="${y.at(tick) + 4}" text-anchor="end">${y.label(tick)}</text>`);
    }
    const way = points.map(([a, b]) => `${x.at(a).toFixed(1)} ${y.at(b).toFixed(1)}`).join("L");
    if (points.length) parts.push(line(`M${way}`, "curve"));
    const middle = 0.5 * (top + height - bottom);
    parts.push(`<text x="${0.5 * (left + width)}" y="${height - 6}" text-anchor="middle">travel (${x.unit})</text>`);
    const upright = `translate(13 ${middle}) rotate(-90)`;
    parts.push(`<text transform="${upright}" text-anchor="middle">force along x (${y.unit})</text>`);
    holder.innerHTML = `<svg viewBox="0 0 ${width} ${height}" role="img" aria-label="Force of the grains on the body ` +
      `along x, against its travel">${parts.join("")}</svg>`;
  }
  return { add, clear, draw };
}
