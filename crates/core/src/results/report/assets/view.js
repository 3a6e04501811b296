"use strict";
// The deformed wall in WebGL 2. Node positions and element values are textures: a frame uploads three small
// textures, and a vertex is the number of a node.

/** Colours of growing damage, of sound materials and of the states of joints, filled in from the table of the page. */
const RAMPS = { tensile: [], compressive: [], crack: [] };
const SOUND = [];
const STATES = [];
const STATE_NAMES = [];

function takeColours(table) {
  for (const kind of Object.keys(RAMPS)) RAMPS[kind] = table[kind];
  SOUND.push(...table.sound);
  STATES.push(...table.states);
  STATE_NAMES.push(...table.state_names);
}

const SHARED = `#version 300 es
precision highp float; precision highp int;
uniform highp usampler2D rest; uniform highp isampler2D moved;
uniform vec3 low, size; uniform float unitOfMove; uniform mat4 camera; uniform vec2 pixels; uniform float lift;
ivec2 at(uint i) { return ivec2(int(i & 1023u), int(i >> 10u)); }
vec3 place(uint n) {
  return low + size * vec3(texelFetch(rest, at(n), 0).xyz) / 65535.0 + unitOfMove * vec3(texelFetch(moved, at(n), 0).xyz);
}
vec4 thick(vec4 a, vec4 b, int corner, float width) {
  vec2 along = (b.xy / b.w - a.xy / a.w) * pixels;
  float size = length(along);
  vec2 across = size > 1e-6 ? vec2(-along.y, along.x) / size : vec2(0.0, 1.0);
  vec4 p = (corner & 2) == 0 ? a : b;
  p.xy += across * ((corner & 1) == 0 ? -1.0 : 1.0) * width / pixels * p.w;
  return p;
}
`;
const SOLID_VERTEX = `${SHARED}
uniform highp usampler2D field, label;
in uint node, element;
out vec3 world; out vec2 uv; flat out vec3 value; flat out uvec2 who;
void main() {
  world = place(node);
  gl_Position = camera * vec4(world, 1.0);
  int corner = gl_VertexID & 3;
  uv = vec2(corner == 1 || corner == 2 ? 1.0 : 0.0, corner >= 2 ? 1.0 : 0.0);
  value = vec3(texelFetch(field, at(element), 0).xyz) / 255.0;
  who = texelFetch(label, at(element), 0).xy;
}`;
const SOLID_FRAGMENT = `#version 300 es
precision highp float; precision highp int;
in vec3 world; in vec2 uv; flat in vec3 value; flat in uvec2 who;
uniform int mode; uniform vec3 eye; uniform vec3 ramp[3]; uniform vec3 sound[8]; uniform float grid, ghost;
out vec4 colour;
vec3 hue(float h) { return clamp(abs(fract(h + vec3(0.0, 2.0 / 3.0, 1.0 / 3.0)) * 6.0 - 3.0) - 1.0, 0.0, 1.0); }
void main() {
  vec3 n = normalize(cross(dFdx(world), dFdy(world)));
  vec3 c = sound[int(who.y) % 8];
  if (mode < 3) {
    float v = mode == 0 ? value.x : mode == 1 ? value.y : value.z;
    c = v < 0.3333 ? mix(c, ramp[0], v * 3.0) : v < 0.6667 ? mix(ramp[0], ramp[1], v * 3.0 - 1.0) : mix(ramp[1], ramp[2], v * 3.0 - 2.0);
  } else if (mode == 4) {
    c = mix(vec3(0.93), hue(fract(float(who.x) * 0.618034)), 0.42) * (who.x % 2u == 0u ? 0.96 : 0.84);
  }
  vec3 ray = normalize(eye - world);
  float light = 0.58 + 0.3 * abs(dot(n, ray)) + 0.14 * abs(dot(n, vec3(0.28, -0.42, 0.86)));
  vec2 edge = min(uv, 1.0 - uv) / fwidth(uv);
  float line = (1.0 - smoothstep(0.3, 1.1, min(edge.x, edge.y))) * grid;
  c = mix(c * light, c * light * 0.72, line);
  colour = vec4(c, ghost);
}`;
const EDGE_VERTEX = `${SHARED}
in uint from, to; uniform float width;
void main() {
  vec4 p = thick(camera * vec4(place(from), 1.0), camera * vec4(place(to), 1.0), gl_VertexID, width);
  p.z -= lift * p.w;
  gl_Position = p;
}`;
const FLAT_FRAGMENT = `#version 300 es
precision highp float;
uniform vec4 paint; out vec4 colour;
void main() { colour = paint; }`;
// The quarter of a facet around its corner x: its fill (vertices 0 to 3) or its two outer half edges (0 to 11).
const JOINT_VERTEX = `${SHARED}
in uvec4 facet; in uint state;
uniform uint least; uniform vec3 states[4]; uniform float width; uniform bool lines;
flat out vec3 tone;
void main() {
  if (state < least) { gl_Position = vec4(2.0, 2.0, 2.0, 1.0); return; }
  tone = states[state];
  vec3 a = place(facet.x), b = place(facet.y), c = place(facet.z), d = place(facet.w);
  vec3 ab = 0.5 * (a + b), ad = 0.5 * (a + d);
  vec4 p;
  if (lines) {
    int half_edge = gl_VertexID / 6, i = gl_VertexID % 6;
    p = thick(camera * vec4(a, 1.0), camera * vec4(half_edge == 0 ? ab : ad, 1.0), i < 3 ? i : 6 - i, width);
    p.z -= 2.0 * lift * p.w;
  } else {
    vec3 x = gl_VertexID == 0 ? a : gl_VertexID == 1 ? ab : gl_VertexID == 2 ? ad : 0.25 * (a + b + c + d);
    p = camera * vec4(x, 1.0);
    p.z -= 0.2 * lift * p.w;
  }
  gl_Position = p;
}`;
const JOINT_FRAGMENT = `#version 300 es
precision highp float;
flat in vec3 tone; out vec4 colour;
void main() { colour = vec4(tone, 1.0); }`;

/** Bytes of a base64 text. */
function bytes(text) {
  const raw = atob(text), array = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i++) array[i] = raw.charCodeAt(i);
  return array;
}

function rgb(hex) {
  const n = parseInt(hex.slice(1), 16);
  return [(n >> 16) / 255, ((n >> 8) & 255) / 255, (n & 255) / 255];
}

/** Numbers of nodes, 16 or 32 bits each. */
function numbers(text, wide) {
  const raw = bytes(text);
  return wide ? new Uint32Array(raw.buffer) : Uint32Array.from(new Uint16Array(raw.buffer));
}

/** Column-major product of 4 × 4 matrices. */
function times(a, b) {
  const c = new Float32Array(16);
  for (let j = 0; j < 4; j++) for (let i = 0; i < 4; i++) for (let k = 0; k < 4; k++) c[4 * j + i] += a[4 * k + i] * b[4 * j + k];
  return c;
}

/**
 * The view on a canvas; null if the browser has no WebGL 2.
 * set({ frame, magnification, colour, joints, outlines, mesh }): frame −1 is the model at rest.
 * at(x, y): unit, material and values of the element at a point of the canvas [CSS pixels], with the supports, drives
 * and loads of the nearest of its nodes; null where there is none.
 */
function makeView(canvas, data) {
  const gl = canvas.getContext("webgl2", { antialias: true, alpha: false });
  if (!gl) return null;
  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  const faceBits = bytes(data.faces), corners = numbers(data.corners, data.wide);
  const rest = new Uint16Array(bytes(data.rest).buffer);
  const nodes = rest.length / 3, elements = faceBits.length;
  const edges = numbers(data.edges, data.wide), facets = numbers(data.facets, data.wide);
  const quarters = facets.length;
  const options = { frame: -1, magnification: 1, colour: "tensile", joints: true, outlines: true, mesh: true };
  const centre = data.low.map((l, i) => l + data.size[i] / 2);
  const radius = Math.hypot(...data.size) / 2;
  const start = { yaw: -0.42, pitch: 0.2, distance: 1, pan: [0, 0] };
  const look = structuredClone(start);
  const unit = new Uint16Array(bytes(data.unit).buffer), material = bytes(data.material);
  const marks = data.marks.map((mark) => ({ told: mark.told, nodes: new Set(numbers(mark.nodes, true)) }));
  let programs, buffers, textures, asked = 0, dead = false, shown = null;

  function compile(vertex, fragment) {
    const program = gl.createProgram();
    for (const [kind, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost()) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) throw new Error(gl.getProgramInfoLog(program));
    const places = {};
    return { program, at: (name) => (name in places ? places[name] : (places[name] = gl.getUniformLocation(program, name))) };
  }

  /** A texture with as many rows of 1024 values as necessary. */
  function texture(unit, inside, format, kind, components, values) {
    const rows = Math.max(1, Math.ceil(values.length / components / 1024));
    const padded = new values.constructor(rows * 1024 * components);
    padded.set(values);
    gl.activeTexture(gl.TEXTURE0 + unit);
    if (!textures[unit]) {
      textures[unit] = gl.createTexture();
      gl.bindTexture(gl.TEXTURE_2D, textures[unit]);
      for (const p of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, p, gl.NEAREST);
    }
    gl.bindTexture(gl.TEXTURE_2D, textures[unit]);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.texImage2D(gl.TEXTURE_2D, 0, inside, 1024, rows, 0, format, kind, padded);
  }

  /** A vertex array of integer attributes: { name: [array, components] }. */
  function arrays(program, attributes, divisor, index) {
    const vao = gl.createVertexArray();
    gl.bindVertexArray(vao);
    const made = { vao };
    for (const name in attributes) {
      const [array, components] = attributes[name];
      made[name] = gl.createBuffer();
      gl.bindBuffer(gl.ARRAY_BUFFER, made[name]);
      gl.bufferData(gl.ARRAY_BUFFER, array, gl.STATIC_DRAW);
      const where = gl.getAttribLocation(program.program, name);
      if (where < 0) continue;
      gl.enableVertexAttribArray(where);
      gl.vertexAttribIPointer(where, components, array instanceof Uint8Array ? gl.UNSIGNED_BYTE : gl.UNSIGNED_INT, 0, 0);
      gl.vertexAttribDivisor(where, divisor);
    }
    if (index) {
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, index, gl.STATIC_DRAW);
      made.count = index.length;
    }
    gl.bindVertexArray(null);
    return made;
  }

  function build() {
    textures = [];
    programs = { solid: compile(SOLID_VERTEX, SOLID_FRAGMENT), edge: compile(EDGE_VERTEX, FLAT_FRAGMENT), joint: compile(JOINT_VERTEX, JOINT_FRAGMENT) };
    let faces = 0;
    for (const bits of faceBits) for (let f = 0; f < 6; f++) faces += (bits >> f) & 1;
    const node = new Uint32Array(4 * faces), element = new Uint32Array(4 * faces), index = new Uint32Array(6 * faces);
    let q = 0;
    for (let e = 0; e < elements; e++) for (let f = 0; f < 6; f++) {
      if (!((faceBits[e] >> f) & 1)) continue;
      for (let i = 0; i < 4; i++) { node[4 * q + i] = corners[8 * e + data.hexahedron[f][i]]; element[4 * q + i] = e; }
      index.set([4 * q, 4 * q + 1, 4 * q + 2, 4 * q, 4 * q + 2, 4 * q + 3], 6 * q);
      q++;
    }
    const from = edges.filter((_, i) => i % 2 === 0), to = edges.filter((_, i) => i % 2 === 1);
    // Each quarter starts at its own corner.
    const turned = new Uint32Array(4 * quarters);
    for (let k = 0; k < quarters; k++) for (let i = 0; i < 4; i++) turned[4 * k + i] = facets[4 * (k >> 2) + ((k + i) & 3)];
    buffers = {
      solid: arrays(programs.solid, { node: [node, 1], element: [element, 1] }, 0, index),
      edge: arrays(programs.edge, { from: [from, 1], to: [to, 1] }, 1),
      joint: arrays(programs.joint, { facet: [turned, 4], state: [new Uint8Array(quarters), 1] }, 1),
    };
    texture(0, gl.RGB16UI, gl.RGB_INTEGER, gl.UNSIGNED_SHORT, 3, rest);
    const label = new Uint16Array(2 * elements);
    for (let e = 0; e < elements; e++) { label[2 * e] = unit[e]; label[2 * e + 1] = material[e]; }
    texture(3, gl.RG16UI, gl.RG_INTEGER, gl.UNSIGNED_SHORT, 2, label);
    upload();
  }

  function upload() {
    const frame = data.frames[options.frame];
    const moved = frame ? new Int16Array(bytes(frame.displacement).buffer) : new Int16Array(3 * nodes);
    texture(1, gl.RGB16I, gl.RGB_INTEGER, gl.SHORT, 3, moved);
    const field = new Uint8Array(3 * elements), state = new Uint8Array(quarters);
    if (frame) {
      const parts = [frame.tensile, frame.compressive, frame.crack].map(bytes), packed = bytes(frame.state);
      for (let e = 0; e < elements; e++) for (let i = 0; i < 3; i++) field[3 * e + i] = parts[i][e];
      for (let k = 0; k < quarters; k++) state[k] = (packed[k >> 2] >> (2 * (k & 3))) & 3;
    }
    texture(2, gl.RGB8UI, gl.RGB_INTEGER, gl.UNSIGNED_BYTE, 3, field);
    shown = { frame, moved, field };
    gl.bindBuffer(gl.ARRAY_BUFFER, buffers.joint.state);
    gl.bufferData(gl.ARRAY_BUFFER, state, gl.STATIC_DRAW);
  }

  /** Camera: x to the right, z up, seen from −y; returns the matrix and the eye. */
  function camera(width, height, moved) {
    const [cy, sy, cp, sp] = [Math.cos(look.yaw), Math.sin(look.yaw), Math.cos(look.pitch), Math.sin(look.pitch)];
    const right = [cy, sy, 0], ahead = [-sy * cp, cy * cp, -sp], up = [-sy * sp, cy * sp, cp];
    const half = Math.tan(0.22), aspect = width / height;
    // The projected box must fit in both directions.
    const seen = (axis) => data.size.reduce((sum, s, i) => sum + Math.abs(axis[i]) * s, 0) / 2;
    const fit = Math.max(seen(up), seen(right) / aspect) * 1.07 / half + seen(ahead);
    const far = fit * look.distance;
    const target = centre.map((c, i) => c + radius * (right[i] * look.pan[0] + up[i] * look.pan[1]));
    const eye = target.map((t, i) => t - far * ahead[i]);
    const dot = (a) => -(a[0] * eye[0] + a[1] * eye[1] + a[2] * eye[2]);
    const back = ahead.map((a) => -a);
    const see = [right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0, dot(right), dot(up), dot(back), 1];
    // A short depth range distinguishes lines from the faces on which they lie.
    const deep = radius * (1.2 + Math.hypot(...look.pan)) + 1.8 * moved;
    const near = Math.max(far - deep, far * 0.05), end = far + deep;
    const lift = (((2 * near * end) / (end - near)) * 0.003 * radius) / (far * far);
    const project = [1 / (half * aspect), 0, 0, 0, 0, 1 / half, 0, 0, 0, 0, (end + near) / (near - end), -1, 0, 0, (2 * end * near) / (near - end), 0];
    return { matrix: times(project, see), eye, lift };
  }

  function draw() {
    asked = 0;
    if (dead || !canvas.clientWidth) return;
    const dense = Math.min(window.devicePixelRatio || 1, 2);
    const width = Math.round(canvas.clientWidth * dense), height = Math.round(canvas.clientHeight * dense);
    if (canvas.width !== width || canvas.height !== height) { canvas.width = width; canvas.height = height; }
    const style = getComputedStyle(document.documentElement);
    gl.viewport(0, 0, width, height);
    gl.clearColor(...rgb(style.getPropertyValue("--stage").trim()), 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.disable(gl.BLEND);
    gl.depthMask(true);
    const frame = data.frames[options.frame], move = frame ? (options.magnification * frame.most) / 32767 : 0;
    const { matrix, eye, lift } = camera(width, height, 32767 * move);
    const see = options.colour === "state";
    const begin = (program) => {
      gl.useProgram(program.program);
      ["rest", "moved", "field", "label"].forEach((name, i) => gl.uniform1i(program.at(name), i));
      gl.uniform3fv(program.at("low"), data.low);
      gl.uniform3fv(program.at("size"), data.size);
      gl.uniform1f(program.at("unitOfMove"), move);
      gl.uniformMatrix4fv(program.at("camera"), false, matrix);
      gl.uniform2f(program.at("pixels"), width, height);
      gl.uniform1f(program.at("lift"), lift);
    };
    const solids = () => {
      const p = programs.solid;
      begin(p);
      gl.uniform1i(p.at("mode"), ["tensile", "compressive", "crack", "state", "unit", "material"].indexOf(options.colour));
      gl.uniform3fv(p.at("eye"), eye);
      gl.uniform3fv(p.at("ramp"), (RAMPS[options.colour] || RAMPS.tensile).flatMap(rgb));
      gl.uniform3fv(p.at("sound"), SOUND.flatMap(rgb));
      gl.uniform1f(p.at("grid"), options.mesh && !see ? 0.55 : 0);
      gl.uniform1f(p.at("ghost"), see ? 0.1 : 1);
      gl.bindVertexArray(buffers.solid.vao);
      gl.drawElements(gl.TRIANGLES, buffers.solid.count, gl.UNSIGNED_INT, 0);
    };
    const outlines = () => {
      if (!options.outlines || !edges.length) return;
      const p = programs.edge;
      begin(p);
      gl.uniform1f(p.at("width"), (see ? 0.7 : 1.1) * dense);
      const dark = matchMedia("(prefers-color-scheme: dark)").matches && see;
      gl.uniform4fv(p.at("paint"), [...rgb(dark ? "#8b837a" : "#3a312b"), see ? 0.35 : 1]);
      gl.bindVertexArray(buffers.edge.vao);
      gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, edges.length / 2);
    };
    const joints = () => {
      if (!quarters || !(options.joints || see)) return;
      const p = programs.joint;
      begin(p);
      gl.uniform1ui(p.at("least"), see ? 1 : 2);
      gl.uniform3fv(p.at("states"), STATES.flatMap(rgb));
      gl.bindVertexArray(buffers.joint.vao);
      gl.uniform1i(p.at("lines"), 0);
      gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, quarters);
      gl.uniform1i(p.at("lines"), 1);
      gl.uniform1f(p.at("width"), 2.3 * dense);
      gl.drawArraysInstanced(gl.TRIANGLES, 0, 12, quarters);
    };
    if (!see) { solids(); outlines(); joints(); return; }
    joints();
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.depthMask(false);
    solids();
    outlines();
    gl.depthMask(true);
  }

  /** Nodes as they are drawn, in coordinates of the canvas from −1 to 1, and their depths. */
  function projected() {
    const move = shown.frame ? (options.magnification * shown.frame.most) / 32767 : 0;
    const { matrix: m } = camera(canvas.clientWidth, canvas.clientHeight, 32767 * move);
    const places = new Float32Array(3 * nodes);
    for (let n = 0; n < 3 * nodes; n += 3) {
      const [x, y, z] = [0, 1, 2].map((i) => data.low[i] + (data.size[i] * rest[n + i]) / 65535 + move * shown.moved[n + i]);
      const w = m[3] * x + m[7] * y + m[11] * z + m[15];
      for (let i = 0; i < 3; i++) places[n + i] = (m[i] * x + m[4 + i] * y + m[8 + i] * z + m[12 + i]) / w;
    }
    return places;
  }

  function at(left, top) {
    if (dead || !shown) return null;
    const x = (2 * left) / canvas.clientWidth - 1, y = 1 - (2 * top) / canvas.clientHeight, p = projected();
    let seen = -1, corner = 0, nearest = Infinity;
    for (let e = 0; e < elements; e++) for (let f = 0; f < 6; f++) {
      if (!((faceBits[e] >> f) & 1)) continue;
      const quad = data.hexahedron[f].map((i) => 3 * corners[8 * e + i]);
      for (const [a, b, c] of [[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]]) {
        const area = (p[b] - p[a]) * (p[c + 1] - p[a + 1]) - (p[c] - p[a]) * (p[b + 1] - p[a + 1]);
        const v = ((x - p[a]) * (p[c + 1] - p[a + 1]) - (p[c] - p[a]) * (y - p[a + 1])) / area;
        const w = ((p[b] - p[a]) * (y - p[a + 1]) - (x - p[a]) * (p[b + 1] - p[a + 1])) / area;
        if (!(v >= 0 && w >= 0 && v + w <= 1)) continue;
        const depth = (1 - v - w) * p[a + 2] + v * p[b + 2] + w * p[c + 2];
        if (depth < nearest) { nearest = depth; seen = e; corner = 1 - v - w >= Math.max(v, w) ? a : v >= w ? b : c; }
      }
    }
    if (seen < 0) return null;
    const { frame, field, moved } = shown;
    const crack = field[3 * seen + 2] / 255;
    return {
      unit: data.units[unit[seen]] || `unit ${unit[seen]}`, material: data.materials[material[seen]],
      damage: frame && { tensile: field[3 * seen] / 255, compressive: field[3 * seen + 1] / 255, crack: crack * crack * data.widest },
      moved: frame && [0, 1, 2].map((i) => (moved[corner + i] * frame.most) / 32767),
      marks: marks.filter((mark) => mark.nodes.has(corner / 3)).map((mark) => mark.told),
    };
  }

  function ask() { if (!asked) asked = requestAnimationFrame(draw); }

  /** Turns to a point of view, at once if the user prefers reduced motion. */
  function turn(to) {
    const from = structuredClone(look), began = performance.now(), lasts = calm.matches ? 0 : 260;
    const step = () => {
      const t = lasts ? Math.min(1, (performance.now() - began) / lasts) : 1, s = t * t * (3 - 2 * t);
      for (const key of ["yaw", "pitch", "distance"]) look[key] = from[key] + s * (to[key] - from[key]);
      look.pan = from.pan.map((p, i) => p + s * (to.pan[i] - p));
      ask();
      if (t < 1) requestAnimationFrame(step);
    };
    step();
  }

  function zoom(factor) { look.distance = Math.min(4, Math.max(0.05, look.distance / factor)); ask(); }
  function orbit(dx, dy) { look.yaw -= dx; look.pitch = Math.min(1.55, Math.max(-1.55, look.pitch + dy)); ask(); }
  function pan(dx, dy) { look.pan[0] -= dx * look.distance; look.pan[1] += dy * look.distance; ask(); }

  const fingers = new Map();
  const between = () => {
    const [a, b] = [...fingers.values()];
    return { apart: Math.hypot(a.x - b.x, a.y - b.y), x: (a.x + b.x) / 2, y: (a.y + b.y) / 2 };
  };
  canvas.addEventListener("pointerdown", (event) => {
    try { canvas.setPointerCapture(event.pointerId); } catch { /* the pointer has left */ }
    fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  });
  canvas.addEventListener("pointermove", (event) => {
    const last = fingers.get(event.pointerId);
    if (!last) return;
    const before = fingers.size === 2 ? between() : null;
    const [dx, dy] = [event.clientX - last.x, event.clientY - last.y];
    last.x = event.clientX; last.y = event.clientY;
    const scale = 1 / canvas.clientHeight;
    if (before) {
      const now = between();
      if (before.apart > 0 && now.apart > 0) zoom(now.apart / before.apart);
      pan((now.x - before.x) * scale * 2, (now.y - before.y) * scale * 2);
    } else if (event.shiftKey || event.buttons === 4 || event.buttons === 2) pan(dx * scale * 2, dy * scale * 2);
    else orbit(dx * 0.008, dy * 0.008);
  });
  for (const kind of ["pointerup", "pointercancel"]) canvas.addEventListener(kind, (event) => fingers.delete(event.pointerId));
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  // The wheel scrolls the page until the user activates the view.
  canvas.addEventListener("wheel", (event) => {
    if (document.activeElement !== canvas && !event.ctrlKey) return;
    event.preventDefault();
    zoom(Math.exp(-event.deltaY * (event.deltaMode === 1 ? 0.04 : 0.0015)));
  }, { passive: false });
  canvas.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const act = {
      ArrowLeft: () => orbit(-0.08, 0), ArrowRight: () => orbit(0.08, 0), ArrowUp: () => orbit(0, -0.08), ArrowDown: () => orbit(0, 0.08),
      "+": () => zoom(1.15), "=": () => zoom(1.15), "-": () => zoom(1 / 1.15), 0: () => turn(start), Home: () => turn(start),
    }[event.key];
    if (act) { act(); event.preventDefault(); }
  });
  canvas.addEventListener("webglcontextlost", (event) => { event.preventDefault(); dead = true; });
  canvas.addEventListener("webglcontextrestored", () => { dead = false; build(); ask(); });
  new ResizeObserver(ask).observe(canvas);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", ask);
  build();
  ask();
  return {
    set(next) {
      const other = "frame" in next && next.frame !== options.frame;
      Object.assign(options, next);
      if (other && !dead) upload();
      ask();
    },
    look(name) { turn({ front: { ...start, yaw: 0, pitch: 0 }, oblique: { ...start, yaw: -0.8, pitch: 0.42 }, back: { ...start, yaw: Math.PI + start.yaw } }[name] || start); },
    zoom,
    at,
    pose: () => structuredClone(look),
    take(pose) { Object.assign(look, pose); ask(); },
  };
}
