// Steps through the frames of each figure of the class "played". A frame is a string of seven signs a
// circle: two for each of x, y and radius, one for the group of its colour.
"use strict";
{
  const signs = "SIGNS";
  const value = new Map([...signs].map((sign, k) => [sign, k]));
  for (const figure of document.querySelectorAll("figure.played")) {
    const data = JSON.parse(figure.querySelector("script").textContent);
    const clip = figure.querySelector("svg > g[clip-path]");
    const groups = [...clip.querySelectorAll(":scope > g")].slice(0, data.groups);
    const overlays = [...clip.querySelectorAll(":scope > path")];
    const bar = figure.querySelector(".controls");
    const [back, play, on] = bar.querySelectorAll("button");
    const slider = bar.querySelector("input");
    const said = bar.querySelector("output");
    let timer = 0;
    const show = (k) => {
      const text = data.frames[k];
      const at = (i) => value.get(text[i]);
      const length = (i) => ((signs.length * at(i) + at(i + 1)) / 9).toFixed(1);
      const parts = groups.map(() => "");
      for (let i = 0; i < text.length; i += 7) {
        const [x, y] = [length(i) - 30, length(i + 2) - 30];
        parts[at(i + 6)] += `<circle cx="${x}" cy="${y}" r="${length(i + 4)}"/>`;
      }
      groups.forEach((group, g) => { group.innerHTML = parts[g]; });
      overlays.forEach((path) => { path.style.display = k === data.home ? "" : "none"; });
      slider.value = k;
      said.textContent = data.labels[k];
    };
    const stop = () => {
      clearInterval(timer);
      timer = 0;
      play.textContent = "\u25b6";
      play.setAttribute("aria-label", "play");
    };
    const step = (by) => {
      const count = data.frames.length;
      show((Number(slider.value) + by + count) % count);
    };
    back.onclick = () => { stop(); step(-1); };
    on.onclick = () => { stop(); step(1); };
    slider.oninput = () => { stop(); show(Number(slider.value)); };
    play.onclick = () => {
      if (timer) return stop();
      timer = setInterval(() => step(1), 100);
      play.textContent = "\u23f8";
      play.setAttribute("aria-label", "pause");
    };
    said.textContent = data.labels[data.home];
    bar.hidden = false;
  }
}
