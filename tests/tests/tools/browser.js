// What can be wrong with how a page looks, as texts in `finds`.

const finds = [];
const say = (what) => finds.push(what.replace(/\s+/g, " "));
const name = (text) => `"${text.textContent.trim().slice(0, 40)}"`;

function checkWidth(view) {
  const root = view.document.documentElement;
  if (root.scrollWidth > root.clientWidth) {
    say(`wider than the window: ${root.scrollWidth} of ${root.clientWidth} px`);
  }
  for (const element of view.document.body.querySelectorAll("*")) {
    const box = element.getBoundingClientRect();
    const seen = box.width > 0 && box.height > 0;
    if (seen && (box.right > root.clientWidth + 1 || box.left < -1) && !scrolls(view, element)) {
      say(`beyond the window: <${element.tagName} class="${element.getAttribute("class")}">`);
    }
  }
}

// Whether the element is inside one that scrolls by itself, or cut to a drawing on purpose.
function scrolls(view, element) {
  for (let e = element; e; e = e.parentElement) {
    const style = view.getComputedStyle(e);
    if (["auto", "scroll"].includes(style.overflowX) || e.hasAttribute("clip-path")) {
      return true;
    }
  }
  return false;
}

function checkTextSizes(view) {
  const seen = new Set();
  const walker = view.document.createTreeWalker(view.document.body, NodeFilter.SHOW_TEXT);
  for (let node = walker.nextNode(); node; node = walker.nextNode()) {
    const parent = node.parentElement;
    const hidden = ["TITLE", "SCRIPT", "STYLE"].includes(parent.tagName.toUpperCase());
    if (!node.data.trim() || hidden || seen.has(parent)) continue;
    seen.add(parent);
    let size = parseFloat(view.getComputedStyle(parent).fontSize);
    if (parent.getScreenCTM) {
      const m = parent.getScreenCTM();
      size *= Math.hypot(m.a, m.b);
    }
    if (size < SMALLEST) {
      say(`small text: ${size.toFixed(1)} px ${name(parent)}`);
    }
  }
}

function checkDrawing(svg) {
  const title = `in "${svg.getAttribute("aria-label")}"`;
  const frame = svg.getBoundingClientRect();
  const texts = [...svg.querySelectorAll("text")].map((text) => {
    const m = text.getScreenCTM();
    return { text, box: text.getBoundingClientRect(), level: Math.abs(m.b) < 1e-6 };
  });
  for (const { text, box } of texts) {
    const out = [frame.left - box.left, box.right - frame.right,
      frame.top - box.top, box.bottom - frame.bottom];
    if (Math.max(...out) > 0.5) {
      say(`outside its drawing: ${name(text)} ${title}`);
    }
  }
  for (const [k, one] of texts.entries()) {
    for (const other of texts.slice(k + 1)) {
      const [a, b] = [letters(one.box), letters(other.box)];
      const across = Math.min(a.right, b.right) - Math.max(a.left, b.left);
      const down = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
      if (across > 0 && down > 0) {
        say(`texts overlap: ${name(one.text)} and ${name(other.text)} ${title}`);
      }
    }
  }
  for (const [level, word] of [[true, "level"], [false, "upright"]]) {
    const label = (t) => t.level === level && /\S \(.+\)$/.test(t.text.textContent.trim());
    if (!texts.some(label)) {
      say(`no ${word} axis label with a unit ${title}`);
    }
  }
}

// The box of a line of text without the font's room above and below its letters.
function letters({ left, right, top, bottom }) {
  const level = right - left > bottom - top;
  const [x, y] = level ? [0, 0.15 * (bottom - top)] : [0.15 * (right - left), 0];
  return { left: left + x, right: right - x, top: top + y, bottom: bottom - y };
}

// Looks through all of a page.
function look(view) {
  checkWidth(view);
  checkTextSizes(view);
  const drawings = [...view.document.querySelectorAll("svg:not(.key)")];
  drawings.forEach(checkDrawing);
  const texts = view.document.querySelectorAll("svg text").length;
  say(`looked at ${drawings.length} drawings with ${texts} texts`);
}
