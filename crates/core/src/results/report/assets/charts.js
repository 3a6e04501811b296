"use strict";
// Charts as SVG: axes with round ticks, lines, bars, a marked row, picking by pointer and keys.

const SVG = "http://www.w3.org/2000/svg";

function make(name, attributes, parent, text) {
  const node = document.createElementNS(SVG, name);
  for (const key in attributes) node.setAttribute(key, attributes[key]);
  if (text !== undefined) node.textContent = text;
  if (parent) parent.appendChild(node);
  return node;
}

/** Four significant digits; an exponent only if necessary. */
function brief(value) {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-4) return value.toExponential(2);
  return String(+value.toPrecision(4));
}

/** Round ticks within a range. */
function ticks(low, high, most) {
  const raw = (high - low) / Math.max(1, most);
  const decade = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((f) => f * decade).find((s) => s >= raw * 0.999);
  const list = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i++) list.push(i * step);
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  return list.map((value) => ({ value, text: digits > 4 ? brief(value) : value.toFixed(digits).replace(/^-(0\.?0*)$/, "$1") }));
}

/** A range around values, and zero on request, with a margin. */
function span(values, zero) {
  let low = zero ? 0 : Infinity, high = zero ? 0 : -Infinity;
  for (const v of values) if (Number.isFinite(v)) { if (v < low) low = v; if (v > high) high = v; }
  if (!(low < high)) { low = Number.isFinite(low) ? low : 0; return low === 0 ? [0, 1] : [Math.min(0, 2 * low), Math.max(0, 2 * low)]; }
  const air = 0.07 * (high - low);
  return [zero && low === 0 ? 0 : low - air, zero && high === 0 ? 0 : high + (zero ? 1.6 : 1) * air];
}

/**
 * A chart in a box.
 * spec: { label, x: {name, values}, y: {name, log?}, lines: [{values, x?, colour, width?, dash?, dots?}], bars?: [{values, colours}],
 *   marks?: [{x, y, text, colour}], flags?: [x], keys?: [{text, colour, dash?}], zero?, tip?: (row) => text, pick?: (row) => void, step?: (by) => void }
 * Returns { now(row) }.
 */
function chart(box, spec) {
  let now = -1, place = null;
  const tip = document.createElement("div");
  tip.className = "tip";
  tip.hidden = true;
  if (spec.keys && spec.keys.length) {
    const keys = document.createElement("div");
    keys.className = "keys";
    for (const key of spec.keys) {
      const item = document.createElement("span"), mark = document.createElement("i");
      item.className = "key";
      mark.className = key.dash ? "dash" : spec.bars ? "" : "bar-line";
      if (key.dash) mark.style.color = key.colour; else mark.style.background = key.colour;
      item.append(mark, key.text);
      keys.append(item);
    }
    box.after(keys);
  }
  const log = spec.y.log ? (v) => Math.log10(v) : (v) => v;

  function draw() {
    const width = box.clientWidth, height = box.clientHeight;
    if (width < 40) return;
    box.replaceChildren(tip);
    const svg = make("svg", { viewBox: `0 0 ${width} ${height}`, role: spec.step ? "slider" : "img", "aria-label": spec.label }, null);
    if (spec.pick) { svg.classList.add("pick"); if (spec.step) svg.setAttribute("tabindex", "0"); }
    box.prepend(svg);
    const left = 58, right = width - 12, top = 12, bottom = height - 42;
    const [x0, x1] = spec.x.range || span([spec.x.values, ...spec.lines.map((l) => l.x || [])].flatMap((v) => [...v]), spec.x.zero);
    const ys = spec.lines.flatMap((l) => [...l.values]).concat((spec.bars || []).flatMap((b) => [...b.values]));
    let [y0, y1] = span(ys.map(log), !spec.y.log);
    if (spec.y.log) { y0 = Math.floor(y0); y1 = Math.ceil(y1); if (y0 === y1) y1 += 1; }
    const X = (v) => left + ((v - x0) / (x1 - x0)) * (right - left);
    const Y = (v) => bottom - ((log(v) - y0) / (y1 - y0)) * (bottom - top);
    place = { X, Y, left, right, top, bottom, svg };
    for (const t of ticks(x0, x1, Math.max(2, width / 110))) {
      make("line", { x1: X(t.value), x2: X(t.value), y1: top, y2: bottom, class: "grid" }, svg);
      make("text", { x: X(t.value), y: bottom + 17, "text-anchor": "middle" }, svg, t.text);
    }
    if (spec.y.log) {
      const every = Math.max(1, Math.ceil((y1 - y0) / Math.max(2, (bottom - top) / 34)));
      for (let e = y0; e <= y1; e += every) {
        const at = Y(10 ** e);
        make("line", { x1: left, x2: right, y1: at, y2: at, class: "grid" }, svg);
        const text = make("text", { x: left - 8, y: at + 4, "text-anchor": "end" }, svg, "10");
        make("tspan", { dy: "-5", "font-size": "9" }, text, String(e).replace("-", "−"));
      }
    } else {
      for (const t of ticks(y0, y1, Math.max(2, (bottom - top) / 48))) {
        make("line", { x1: left, x2: right, y1: Y(t.value), y2: Y(t.value), class: t.value === 0 ? "axis" : "grid" }, svg);
        make("text", { x: left - 8, y: Y(t.value) + 4, "text-anchor": "end" }, svg, t.text);
      }
    }
    make("text", { x: (left + right) / 2, y: height - 6, "text-anchor": "middle" }, svg, spec.x.name);
    make("text", { transform: `translate(13 ${(top + bottom) / 2}) rotate(-90)`, "text-anchor": "middle" }, svg, spec.y.name);
    for (const bar of spec.bars || []) {
      const wide = Math.max(0.7, Math.min(14, (0.8 * (right - left)) / Math.max(1, bar.values.length)));
      // One path per colour: thousands of rectangles would be slow.
      const paths = new Map();
      for (let i = 0; i < bar.values.length; i++) {
        if (!(bar.values[i] > 0)) continue;
        const path = `M${(X(spec.x.values[i]) - wide / 2).toFixed(1)} ${bottom}V${Y(bar.values[i]).toFixed(1)}h${wide.toFixed(1)}V${bottom}z`;
        paths.set(bar.colours[i], (paths.get(bar.colours[i]) || "") + path);
      }
      for (const [colour, d] of paths) make("path", { d, style: `fill:${colour}` }, svg);
    }
    for (const x of spec.flags || []) make("path", { d: `M${X(x) - 4} ${top - 7}h8l-4 7z`, style: "fill:var(--peak)" }, svg);
    for (const line of spec.lines) {
      const xs = line.x || spec.x.values;
      let d = "", pen = false;
      for (let i = 0; i < line.values.length; i++) {
        const y = line.values[i];
        const fine = Number.isFinite(xs[i]) && Number.isFinite(y) && (!spec.y.log || y > 0) && (!line.show || line.show[i]);
        if (fine) d += `${pen ? "L" : "M"}${X(xs[i]).toFixed(1)} ${Y(y).toFixed(1)}`;
        pen = fine;
      }
      const style = `stroke:${line.colour};stroke-width:${line.width || 2}${line.dash ? `;stroke-dasharray:${line.dash}` : ""}`;
      make("path", { d, class: "line", style }, svg);
      if (line.dots || line.values.length === 1) for (let i = 0; i < line.values.length; i++) {
        if (Number.isFinite(line.values[i])) make("circle", { cx: X(xs[i]), cy: Y(line.values[i]), r: 2.5, style: `fill:${line.colour}` }, svg);
      }
    }
    for (const mark of spec.marks || []) {
      make("circle", { cx: X(mark.x), cy: Y(mark.y), r: 5, style: `fill:${mark.colour};stroke:var(--card);stroke-width:2` }, svg);
      const end = X(mark.x) > left + 0.6 * (right - left), high = Y(mark.y) - 12 < top + 4;
      make("text", { x: X(mark.x) + (end ? -9 : 9), y: Y(mark.y) + (high ? 20 : -9), "text-anchor": end ? "end" : "start", class: "peak-text" }, svg, mark.text);
    }
    place.now = make("g", { "aria-hidden": "true" }, svg);
    if (spec.pick) listen(svg);
    mark();
  }

  function mark() {
    if (!place) return;
    place.now.replaceChildren();
    if (spec.step) {
      const set = { "aria-valuemin": 0, "aria-valuemax": Math.max(0, spec.x.values.length - 1), "aria-valuenow": Math.max(0, now), "aria-valuetext": now >= 0 ? spec.tip(now) : "at rest" };
      for (const key in set) place.svg.setAttribute(key, set[key]);
    }
    const x = spec.x.values[now];
    if (!Number.isFinite(x)) return;
    make("line", { x1: place.X(x), x2: place.X(x), y1: place.top, y2: place.bottom, class: "now" }, place.now);
    const y = spec.lines.length ? spec.lines[spec.main || 0].values[now] : NaN;
    if (Number.isFinite(y) && (!spec.y.log || y > 0)) make("circle", { cx: place.X(x), cy: place.Y(y), r: 5.5, style: "fill:var(--card);stroke:var(--accent);stroke-width:3" }, place.now);
  }

  function nearest(event) {
    const at = place.svg.getBoundingClientRect();
    const px = event.clientX - at.left, py = event.clientY - at.top;
    const ys = spec.lines.length ? spec.lines[spec.main || 0] : null;
    let best = -1, least = Infinity;
    for (let i = 0; i < spec.x.values.length; i++) {
      if (ys && ys.show && !ys.show[i]) continue;
      const dx = place.X(spec.x.values[i]) - px;
      const dy = spec.both && ys ? place.Y(ys.values[i]) - py : 0;
      const distance = dx * dx + dy * dy;
      if (distance < least) { least = distance; best = i; }
    }
    return best;
  }

  function listen(svg) {
    svg.addEventListener("pointermove", (event) => {
      const row = nearest(event);
      if (row < 0 || !spec.tip) return;
      tip.textContent = spec.tip(row);
      tip.hidden = false;
      const y = spec.lines.length ? place.Y(spec.lines[spec.main || 0].values[row]) : place.top;
      const x = Math.min(Math.max(place.X(spec.x.values[row]) + 12, 0), box.clientWidth - tip.offsetWidth);
      tip.style.transform = `translate(${x}px, ${Math.max(0, (Number.isFinite(y) ? y : 20) - 34)}px)`;
    });
    svg.addEventListener("pointerleave", () => { tip.hidden = true; });
    svg.addEventListener("click", (event) => { const row = nearest(event); if (row >= 0) spec.pick(row); });
    svg.addEventListener("keydown", (event) => {
      const by = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 5, PageDown: -5, Home: -Infinity, End: Infinity }[event.key];
      if (by === undefined || !spec.step) return;
      spec.step(by);
      event.preventDefault();
    });
  }

  let wide = 0;
  new ResizeObserver(() => { if (box.clientWidth !== wide) { wide = box.clientWidth; draw(); } }).observe(box);
  draw();
  return { now(row) { now = row; mark(); } };
}

function empty(box, text) {
  const note = document.createElement("p");
  note.className = "empty";
  note.textContent = text;
  box.style.height = "auto";
  box.replaceChildren(note);
}
