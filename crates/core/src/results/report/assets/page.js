"use strict";
// The page: the wall and all charts show the same row of the history.

(function () {
  const data = JSON.parse(document.getElementById("data").textContent);
  takeColours(data.colours);
  const by = (id) => document.getElementById(id);
  const { series, view } = data;
  const rows = series.rows;
  const column = (text) => new Float32Array(bytes(text).buffer);
  const c = {};
  for (const name in series.columns) c[name] = column(series.columns[name]);
  const method = bytes(series.method), driven = bytes(series.driven);
  const frames = view ? view.frames : [];
  const colour = (n) => `var(--c${n})`;
  const methodColours = [2, 4, 3, 6, 7, 5, 8, 1].map(colour);
  const any = (values) => values && values.some((v) => Number.isFinite(v) && v !== 0);

  // Frame −1 is the wall at rest; the slider counts it as 0.
  let now = frames.length - 1;
  const charts = [];
  let wall = null;

  function go(frame) {
    now = Math.min(frames.length - 1, Math.max(-1, frame));
    const row = now < 0 ? -1 : frames[now].row;
    for (const shown of charts) shown.now(row);
    if (wall) wall.set({ frame: now });
    const text = now < 0 ? "at rest" : describe(row);
    by("frame").value = now + 1;
    by("frame").setAttribute("aria-valuetext", text);
    by("moment").textContent = text;
  }

  function describe(row) {
    const parts = [`increment ${c.increment[row]}`];
    if (driven[row]) parts.push(`${brief(c.displacement_mm[row])} mm`, `${brief(c.force_kN[row])} kN`);
    else parts.push(`${brief(c.time[row])} s`);
    return parts.join(" · ");
  }

  /** The frame nearest to a row. */
  function toRow(row) {
    let best = -1, least = Infinity;
    frames.forEach((f, i) => { const off = Math.abs(f.row - row); if (off < least) { least = off; best = i; } });
    if (best >= 0) go(best);
  }

  const pick = frames.length ? toRow : undefined;
  const step = frames.length ? (n) => go(n === Infinity ? frames.length - 1 : n === -Infinity ? -1 : now + n) : undefined;

  function curve() {
    const box = by("curve");
    if (!driven.some((d) => d)) return undriven(box);
    by("curve-help").hidden = !frames.length;
    const lines = [], keys = [], marks = [];
    // A pause of the drive interrupts the curve, which begins at the start of the drive.
    const show = Array.from(driven, (d) => d !== 0);
    const first = show.indexOf(true);
    lines.push({ values: c.force_kN, show, colour: "var(--accent)", width: 2.5 });
    if (first === 0 || c.displacement_mm[first - 1] !== series.start[0] || c.force_kN[first - 1] !== Math.fround(series.start[1])) {
      lines.push({ x: [series.start[0], c.displacement_mm[first]], values: [series.start[1], c.force_kN[first]], colour: "var(--accent)", width: 2.5 });
    } else show[first - 1] = true;
    if (data.experiment) {
      const points = data.experiment.points;
      lines.push({ x: points.map((p) => p[0]), values: points.map((p) => p[1]), colour: "var(--measured)", width: 1.5, dash: "6 4", dots: true });
      keys.push({ text: "computed", colour: "var(--accent)" }, { text: `measured: ${data.experiment.name}`, colour: "var(--measured)", dash: true });
    }
    if (series.peak !== null) {
      const [x, y] = [c.displacement_mm[series.peak], c.force_kN[series.peak]];
      marks.push({ x, y, text: `${series.largest} ${brief(y)} kN at ${brief(x)} mm`, colour: "var(--peak)" });
    }
    charts.push(chart(box, {
      label: "Force against displacement" + (marks.length ? `; ${marks[0].text}` : ""), keys, lines, marks, pick, step, both: true,
      x: { name: "displacement [mm]", values: c.displacement_mm, zero: true }, y: { name: "force [kN]" }, tip: describe,
    }));
  }

  /** Histories of the probes, if there is no driven curve. */
  function undriven(box) {
    if (!series.probes.length || rows === 0) return empty(box, rows ? "Nothing was driven in this run, and it has no probes." : "No increment is done yet.");
    by("curve-title").textContent = "Probes over time";
    const lines = series.probes.map(([, text], i) => ({ values: column(text), colour: colour(i + 2) }));
    charts.push(chart(box, {
      label: "Probes over time", lines, pick, step, keys: series.probes.map(([text], i) => ({ text, colour: colour(i + 2) })),
      x: { name: "time [s]", values: c.time }, y: { name: "probe [mm, mm/s]" }, tip: describe,
    }));
  }

  function energies() {
    const box = by("energies");
    if (!rows) return empty(box, "No increment is done yet.");
    const kinds = [
      ["work from outside", "external_work_J", 1], ["elastic", "elastic_energy_J", 2], ["plastic and damage dissipation", "plastic_damage_dissipation_J", 3],
      ["interface dissipation", "interface_dissipation_J", 4], ["viscous dissipation", "viscous_dissipation_J", 5], ["kinetic", "kinetic_energy_J", 6],
      ["damping", "damping_dissipation_J", 7], ["numerical dissipation", "numerical_dissipation_J", 8],
    ].filter(([, name]) => name === "external_work_J" || any(c[name]));
    charts.push(chart(box, {
      label: "Energies over time", pick, lines: kinds.map(([, name, n]) => ({ values: c[name], colour: colour(n), width: n === 1 ? 2.5 : 2 })),
      keys: kinds.map(([text, , n]) => ({ text, colour: colour(n) })), x: { name: "time [s]", values: c.time }, y: { name: "energy [J]" },
      tip: (row) => `${describe(row)}: ${kinds.map(([text, name]) => `${text} ${brief(c[name][row])}`).slice(0, 2).join(", ")} J`,
    }));
  }

  function convergence() {
    if (!rows) { empty(by("solves"), "No increment is done yet."); empty(by("residuals"), "No increment is done yet."); return; }
    const used = series.methods;
    const cuts = [];
    for (let i = 0; i < rows; i++) if (c.cutbacks[i] > 0) cuts.push(c.increment[i]);
    const keys = used.map((text, i) => ({ text, colour: methodColours[i % 8] }));
    if (cuts.length) keys.push({ text: "cut back before", colour: "var(--peak)" });
    const x = { name: "increment", values: c.increment, range: [0, Math.max(2, c.increment[rows - 1] + 1)] };
    charts.push(chart(by("solves"), {
      label: `Linear solves of ${rows} increments; procedures: ${used.join(", ")}`, pick, lines: [], keys, flags: cuts, x, y: { name: "solves" },
      bars: [{ values: c.iterations, colours: Array.from(method, (m) => methodColours[m % 8]) }],
      tip: (row) => `increment ${c.increment[row]}: ${c.iterations[row]} solves, ${c.cutbacks[row]} cut-backs, ${used[method[row]]}`,
    }));
    const lines = [], names = [];
    if (c.out_of_balance.some((v) => v > 0)) { lines.push({ values: c.out_of_balance, colour: colour(4) }); names.push({ text: "all laws implicit (out_of_balance)", colour: colour(4) }); }
    if (c.residual.some((v) => v > 0)) { lines.push({ values: c.residual, colour: colour(2) }); names.push({ text: "of the equations solved (residual)", colour: colour(2) }); }
    if (!lines.length) return empty(by("residuals"), "No residuals are recorded.");
    charts.push(chart(by("residuals"), {
      label: "Out-of-balance force after each increment", pick, lines, keys: names, x, y: { name: "over the mean force [–]", log: true },
      tip: (row) => `increment ${c.increment[row]}: residual ${brief(c.residual[row])}, out of balance ${brief(c.out_of_balance[row])}`,
    }));
  }

  const FACTORS = [0, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000];

  function three() {
    if (!view) return;
    by("stage").hidden = false;
    try { wall = makeView(by("view"), view); } catch (error) { console.warn(error); }
    if (!wall) {
      by("stage").hidden = true;
      by("no-view").textContent = "This browser has no WebGL 2, so the wall is not shown; the charts need none.";
      return;
    }
    by("no-view").hidden = true;
    by("view").wall = wall;
    for (const id of ["wall-bar", "legend", "wall-checks", "view-help"]) by(id).hidden = false;
    const factors = FACTORS.filter((f) => f <= Math.max(10, view.magnification * 10));
    const slider = by("magnification");
    slider.max = factors.length - 1;
    const magnify = () => {
      const times = factors[slider.value];
      by("times").textContent = `× ${times}`;
      slider.setAttribute("aria-valuetext", `magnified ${times} times`);
      wall.set({ magnification: times });
    };
    slider.value = Math.max(0, factors.indexOf(view.magnification));
    slider.addEventListener("input", magnify);
    magnify();
    by("colour").addEventListener("change", () => { wall.set({ colour: by("colour").value }); legend(); });
    for (const id of ["joints", "outlines", "mesh"]) by(id).addEventListener("change", () => { wall.set({ [id]: by(id).checked }); legend(); });
    if (!view.facets) {
      by("joints").closest("label").remove();
      by("colour").querySelector("[value=state]").remove();
    }
    for (const button of document.querySelectorAll("[data-look]")) button.addEventListener("click", () => wall.look(button.dataset.look));
    for (const button of document.querySelectorAll("[data-zoom]")) button.addEventListener("click", () => wall.zoom(+button.dataset.zoom));
    legend();
    pointed();
  }

  /** Shows name and values of the unit below the pointer. */
  function pointed() {
    const canvas = by("view"), tip = by("pointed");
    let last = null, asked = 0;
    const tell = () => {
      asked = 0;
      const seen = last && wall.at(last.x, last.y);
      tip.hidden = !seen;
      if (!seen) return;
      const parts = [seen.unit, seen.material, ...seen.marks];
      if (seen.damage) {
        const { tensile, compressive, crack } = seen.damage;
        parts.push(`tensile damage ${tensile.toFixed(2)}`, `compressive ${compressive.toFixed(2)}`);
        if (crack > 0) parts.push(`crack ${brief(crack)} mm`);
        parts.push(`moved by (${seen.moved.map(brief).join(", ")}) mm`);
      }
      tip.textContent = parts.join(" · ");
    };
    canvas.addEventListener("pointermove", (event) => {
      last = event.buttons ? null : { x: event.offsetX, y: event.offsetY };
      if (!asked) asked = requestAnimationFrame(tell);
    });
    canvas.addEventListener("pointerleave", () => { last = null; tip.hidden = true; });
  }

  function legend() {
    const box = by("legend"), kind = by("colour").value;
    box.replaceChildren();
    const key = (text, fill) => {
      const item = document.createElement("span"), mark = document.createElement("i");
      item.className = "key";
      mark.style.background = fill;
      item.append(mark, text);
      box.append(item);
    };
    if (RAMPS[kind]) {
      const ramp = document.createElement("div"), strip = document.createElement("div"), marks = document.createElement("div");
      ramp.className = "ramp"; strip.className = "strip"; marks.className = "ticks";
      strip.style.background = `linear-gradient(90deg, ${[SOUND[1], ...RAMPS[kind]].join(", ")})`;
      const stops = kind === "crack" ? [0, 0.25, 0.5, 0.75, 1].map((s) => s * s * view.widest) : [0, 0.25, 0.5, 0.75, 1];
      for (const stop of stops) { const t = document.createElement("span"); t.textContent = +stop.toPrecision(2); marks.append(t); }
      const name = document.createElement("div");
      name.textContent = { tensile: "Tensile damage [–]", compressive: "Compressive damage [–]", crack: "Crack width [mm]" }[kind];
      ramp.append(name, strip, marks);
      box.append(ramp);
    }
    if (kind === "material") view.materials.forEach((name, i) => key(name, SOUND[i % SOUND.length]));
    if (kind === "unit") box.append("A colour of its own for each unit (representative element).");
    if (view.facets) {
      if (kind === "state") for (const i of [1, 2, 3]) key(`joint ${STATE_NAMES[i]}`, STATES[i]);
      else if (by("joints").checked) for (const i of [2, 3]) key(`joint ${STATE_NAMES[i]}`, STATES[i]);
    }
  }

  function player() {
    if (!frames.length) return;
    by("player").hidden = false;
    const slider = by("frame"), play = by("play");
    slider.max = frames.length;
    slider.addEventListener("input", () => go(+slider.value - 1));
    let clock = 0;
    const stop = () => { clearInterval(clock); clock = 0; play.textContent = "Play"; play.setAttribute("aria-pressed", "false"); };
    play.addEventListener("click", () => {
      if (clock) return stop();
      if (now === frames.length - 1) go(-1);
      play.textContent = "Pause";
      play.setAttribute("aria-pressed", "true");
      clock = setInterval(() => { if (now >= frames.length - 1) stop(); else go(now + 1); }, Math.min(400, Math.max(80, 6000 / frames.length)));
    });
    if (series.peak === null) by("to-peak").hidden = true;
    by("to-peak").addEventListener("click", () => { stop(); toRow(series.peak); });
    by("to-end").addEventListener("click", () => { stop(); go(frames.length - 1); });
  }

  three();
  player();
  curve();
  energies();
  convergence();
  go(now);
})();
