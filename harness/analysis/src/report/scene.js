// Draws the figures of the class "scene". A grain is a string of eight signs: two for each of x, y and z, one for its
// radius, one for the group of its colour.
{
  const signs = "SIGNS";
  const value = new Map([...signs].map((sign, k) => [sign, k]));
  for (const figure of document.querySelectorAll("figure.scene")) {
    const { lo, hi, radius, centre, body, half, rows } = JSON.parse(figure.querySelector("script").textContent);
    const at = (k) => value.get(rows[k]);
    const most = signs.length * signs.length - 1;
    const spheres = [];
    for (let k = 0; k < rows.length; k += 8) {
      for (let a = 0; a < 3; a++) {
        spheres.push(lo[a] + (hi[a] - lo[a]) * (signs.length * at(k + 2 * a) + at(k + 2 * a + 1)) / most);
      }
      const group = at(k + 7);
      spheres.push(radius * at(k + 6) / (signs.length - 1), group < RAMP.length ? group / (RAMP.length - 1) : FIXED);
    }
    if (half === null) spheres.push(...centre, body, BODY);
    const faces = half === null ? [] : [barFaces([0, 1, 0], body, half)];
    const poses = faces.map(() => ({ point: centre, orientation: [1, 0, 0, 0] }));
    const canvas = figure.querySelector("canvas"), note = figure.querySelector(".none");
    const bar = figure.querySelector(".controls"), open = bar.querySelector("input");
    canvas.hidden = false;
    try {
      const viewer = makeViewer(canvas, { lo, hi, faces });
      const draw = () => {
        viewer.draw({ rows: new Float32Array(spheres), poses, cut: open.checked ? centre[1] : null });
      };
      open.onchange = draw;
      orbitBy(canvas, viewer, () => requestAnimationFrame(draw));
      window.addEventListener("resize", draw);
      note.hidden = true;
      bar.hidden = false;
      draw();
    } catch (error) {
      canvas.hidden = true;
      note.textContent = `There is no picture: ${error.message}.`;
    }
  }
}
