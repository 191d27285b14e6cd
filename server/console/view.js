// view.js -- surfaces in WebGL2: turned by pointer and keys, coloured by what differs, or two of
// them to the left and right of a line, or side by side.  Frames are drawn when something changed, without
// multisampling while it moves, and once more with it 150 ms after it has come to rest.

const SURFACE_VERTEX = `#version 300 es
in vec3 at, normal; in float value, seen;
uniform mat4 place; uniform mat3 turn; uniform float back; uniform vec4 plane;
out float light, amount, there, cut;
void main() {
  vec3 n = turn * normal;
  float key = max(dot(n, normalize(vec3(-0.45, 0.55, 0.75))), 0.0);
  float fill = max(dot(n, normalize(vec3(0.8, -0.1, 0.55))), 0.0);
  light = 0.24 + 0.66 * key + 0.22 * fill;
  amount = value; there = seen; cut = dot(plane.xyz, at) + plane.w;
  gl_Position = place * vec4(at, 1.0);
  gl_Position.z += back * gl_Position.w;
}`;

// The colours are a texture of 25 bands, so that a place can be found on the legend; a line where
// the amount passes the limit.  Light hardly changes them, as a shadow would be another value; towards places
// that were not compared they fade.  The cut is a dark line on a light one.
const SURFACE_FRAGMENT = `#version 300 es
precision highp float;
in float light, amount, there, cut;
uniform vec3 base, none, line; uniform float end, limit; uniform int coloured, cutting; uniform sampler2D scale;
out vec4 color;
void main() {
  vec3 c = base * light;
  if (coloured == 1) {
    float known = smoothstep(0.5, 0.8, there);
    c = mix(none * light, texture(scale, vec2(amount / end * 0.48 + 0.5, 0.5)).rgb * mix(light, 1.0, 0.7), known);
    float far = abs(abs(amount) - limit) / max(fwidth(amount), 1e-6);
    c = mix(c, line, (1.0 - smoothstep(0.4, 1.4, far)) * 0.55 * step(0.99, known));
  }
  if (cutting == 1) {
    float off = abs(cut) / max(fwidth(cut), 1e-6);
    c = mix(mix(c, vec3(1.0), 1.0 - smoothstep(1.6, 2.6, off)), vec3(0.05), 1.0 - smoothstep(0.6, 1.4, off));
  }
  color = vec4(c, 1.0);
}`;

const POINT_VERTEX = `#version 300 es
in vec3 at; uniform mat4 place; uniform float size;
void main() { gl_Position = place * vec4(at, 1.0); gl_PointSize = size; }`;
const POINT_FRAGMENT = `#version 300 es
precision mediump float; uniform vec3 base; out vec4 color;
void main() { color = vec4(base, 1.0); }`;

/** From what speaks for one person, or lies behind, to what speaks against it, or lies in front. */
export const SCALE = ["#103682", "#4688ce", "#c4d8e6", "#f0ede5", "#f6dec2", "#ec944e", "#9e3406"];

export const hex = (text) => [1, 3, 5].map((i) => parseInt(text.slice(i, i + 2), 16) / 255);

const BANDS = 25;

/** The scale's colours, evenly spaced. */
function bands() {
  const out = new Uint8Array(4 * BANDS), colors = SCALE.map(hex);
  for (let i = 0; i < BANDS; i++) {
    const at = (6 * i) / (BANDS - 1), k = Math.min(5, Math.floor(at));
    for (let c = 0; c < 3; c++)
      out[4 * i + c] = Math.round(255 * (colors[k][c] + (at - k) * (colors[k + 1][c] - colors[k][c])));
    out[4 * i + 3] = 255;
  }
  return out;
}

const VIEWS = { front: [0, 0], three: [-0.62, 0.06], profile: [-1.45, 0.02] };

/** The surface's normals: the sum of its triangles', by their area. */
function normals(at, index) {
  const out = new Float32Array(at.length);
  for (let t = 0; t < index.length; t += 3) {
    const [a, b, c] = [3 * index[t], 3 * index[t + 1], 3 * index[t + 2]];
    const ux = at[b] - at[a], uy = at[b + 1] - at[a + 1], uz = at[b + 2] - at[a + 2];
    const vx = at[c] - at[a], vy = at[c + 1] - at[a + 1], vz = at[c + 2] - at[a + 2];
    const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    for (const v of [a, b, c]) {
      out[v] += x;
      out[v + 1] += y;
      out[v + 2] += z;
    }
  }
  for (let v = 0; v < out.length; v += 3) {
    const n = Math.hypot(out[v], out[v + 1], out[v + 2]) || 1;
    out[v] /= n;
    out[v + 1] /= n;
    out[v + 2] /= n;
  }
  return out;
}

/** How much of a surface's surroundings is seen, by its points: 0 where it is not itself, and from 0.5 to 1 where it is, so that
 *  an edge is smooth and nothing unknown is coloured. */
function certainty(color, index) {
  const n = color.length / 4, seen = new Float32Array(n).map((_, v) => (color[4 * v + 3] ? 1 : 0));
  let around = seen;
  for (let pass = 0; pass < 2; pass++) {
    const sum = new Float32Array(n), of = new Float32Array(n);
    for (let t = 0; t < index.length; t += 3) {
      const [a, b, c] = [index[t], index[t + 1], index[t + 2]], mean = (around[a] + around[b] + around[c]) / 3;
      for (const v of [a, b, c]) {
        sum[v] += mean;
        of[v]++;
      }
    }
    around = sum.map((x, v) => x / (of[v] || 1));
  }
  return seen.map((s, v) => s * (0.5 + 0.5 * around[v]));
}

/** The points of a scan but those at the surface that was found in it: by squares of the face's frame. */
function outside(scan, face) {
  const EDGE = 4, NEAR = 6, key = (x, y) => Math.round(x / EDGE) * 4096 + Math.round(y / EDGE), range = new Map();
  for (let v = 0; v < face.length; v += 3)
    for (const [dx, dy] of [[0, 0], [EDGE / 2, EDGE / 2], [-EDGE / 2, EDGE / 2], [EDGE / 2, -EDGE / 2], [-EDGE / 2, -EDGE / 2]]) {
      const at = key(face[v] + dx, face[v + 1] + dy), [low, high] = range.get(at) ?? [Infinity, -Infinity];
      range.set(at, [Math.min(low, face[v + 2]), Math.max(high, face[v + 2])]);
    }
  const out = [];
  for (let v = 0; v < scan.length; v += 3) {
    const found = range.get(key(scan[v], scan[v + 1]));
    if (!found || scan[v + 2] < found[0] - NEAR || scan[v + 2] > found[1] + NEAR) out.push(scan[v], scan[v + 1], scan[v + 2]);
  }
  return Float32Array.from(out);
}

function program(gl, vertex, fragment) {
  const p = gl.createProgram();
  for (const [type, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const s = gl.createShader(type);
    gl.shaderSource(s, text);
    gl.compileShader(s);
    gl.attachShader(p, s);
  }
  ["at", "normal", "value", "seen"].forEach((name, i) => gl.bindAttribLocation(p, i, name));
  gl.linkProgram(p);
  if (!gl.getProgramParameter(p, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(p));
  const uniforms = {};
  const n = gl.getProgramParameter(p, gl.ACTIVE_UNIFORMS);
  for (let i = 0; i < n; i++) {
    const name = gl.getActiveUniform(p, i).name.replace("[0]", "");
    uniforms[name] = gl.getUniformLocation(p, name);
  }
  return { p, ...uniforms };
}

/** A view in canvas; null where there is no WebGL2.
 *  drawn(): is called after each frame; tapped(x, y): at a place that was tapped or clicked on;
 *  drawing(): whether a drag draws a line, lined(plane): the plane that the eye sees as that line. */
export function createView(canvas, { drawn, tapped, drawing, lined }) {
  const gl = canvas.getContext("webgl2", { antialias: false, alpha: true });
  if (!gl) return null;
  const surface = program(gl, SURFACE_VERTEX, SURFACE_FRAGMENT);
  const point = program(gl, POINT_VERTEX, POINT_FRAGMENT);
  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, BANDS, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, bands());
  for (const [name, value] of [[gl.TEXTURE_MIN_FILTER, gl.NEAREST], [gl.TEXTURE_MAG_FILTER, gl.NEAREST],
    [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE], [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE]])
    gl.texParameteri(gl.TEXTURE_2D, name, value);
  const nodes = {}; // by name: what was uploaded, and the arrays for picking
  let yaw = VIEWS.three[0], pitch = VIEWS.three[1], zoom = 1, curtain = 0.5, swapped = false;
  let layer = null, centre = [0, 0, 0], radius = 100, theme = {}, asked = 0, rest = 0, smooth = null, cut = null;

  function buffer(place, data, size) {
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, size, gl.FLOAT, false, 0, 0);
  }

  function upload(node) {
    const out = { ...node, vao: gl.createVertexArray(), n: node.at.length / 3 };
    gl.bindVertexArray(out.vao);
    buffer(0, node.at, 3);
    if (node.index) {
      out.normal = normals(node.at, node.index);
      buffer(1, out.normal, 3);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, node.index, gl.STATIC_DRAW);
      out.type = node.index.BYTES_PER_ELEMENT === 2 ? gl.UNSIGNED_SHORT : gl.UNSIGNED_INT;
    }
    if (node.color) {
      out.seen = certainty(node.color, node.index);
      buffer(3, out.seen, 1);
      out.valueBuffer = gl.createBuffer();
    }
    gl.bindVertexArray(null);
    return out;
  }

  /** What to draw; replaces what there was. */
  function show(given, pose) {
    for (const name in nodes) {
      gl.deleteVertexArray(nodes[name].vao);
      delete nodes[name];
    }
    for (const name in given) {
      const at = name === "scan" && given.face ? outside(given.scan.at, given.face.at) : given[name].at;
      nodes[name] = upload({ ...given[name], at });
    }
    const of = nodes.template ?? nodes.face ?? nodes.scan;
    if (of) {
      const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
      of.at.forEach((x, i) => {
        low[i % 3] = Math.min(low[i % 3], x);
        high[i % 3] = Math.max(high[i % 3], x);
      });
      centre = low.map((x, i) => (x + high[i]) / 2);
      if (of.index) centre[2] -= 20; // of a face; a scan alone is in its own unit
      radius = Math.max(high[0] - low[0], high[1] - low[1]) * (nodes.scan ? 0.72 : 0.61);
    }
    if (pose) [yaw, pitch, zoom] = [...VIEWS[pose], 1];
    changedFrame();
  }

  /** By which attribute the probe is coloured: {name, sign, end, limit}; "curtain", "beside"; "a", "b": one surface
   *  alone; null: plain. */
  function setLayer(next) {
    layer = next;
    const probe = nodes.probe;
    if (probe && layer?.name) {
      gl.bindVertexArray(probe.vao);
      gl.bindBuffer(gl.ARRAY_BUFFER, probe.valueBuffer);
      gl.bufferData(gl.ARRAY_BUFFER, probe[layer.name], gl.STATIC_DRAW);
      gl.enableVertexAttribArray(2);
      gl.vertexAttribPointer(2, 1, gl.FLOAT, false, 0, 0);
      gl.bindVertexArray(null);
    }
    changedFrame();
  }

  function setTheme(colors) {
    theme = Object.fromEntries(Object.entries(colors).map(([k, v]) => [k, hex(v)]));
    changedFrame();
  }

  /** The plane whose line is drawn on the surfaces, as section.js has it; null: none. */
  function setCut(plane) {
    cut = plane;
    changedFrame();
  }

  // Turned about its centre, then seen from 5 radii in front.
  function matrices(aspect = canvas.width / canvas.height / (layer === "beside" ? 2 : 1)) {
    const [cy, sy, cp, sp] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
    const r = [cy, sp * sy, -cp * sy, 0, cp, sp, sy, -sp * cy, cp * cy]; // by columns
    const far = 5 * radius;
    const f = (5 / zoom ** -1) * Math.min(1, aspect * 1.05), near = far / 5, deep = far * 3;
    const t = [0, 1, 2].map((i) => -(r[i] * centre[0] + r[3 + i] * centre[1] + r[6 + i] * centre[2]));
    const z = (near + deep) / (near - deep), w = (2 * near * deep) / (near - deep);
    const place = new Float32Array(16);
    for (let c = 0; c < 4; c++) {
      const col = c < 3 ? [r[3 * c], r[3 * c + 1], r[3 * c + 2]] : [t[0], t[1], t[2] - far];
      place[4 * c] = (col[0] * f) / aspect;
      place[4 * c + 1] = col[1] * f;
      place[4 * c + 2] = col[2] * z + (c === 3 ? w : 0);
      place[4 * c + 3] = -col[2];
    }
    return { turn: new Float32Array(r), place, aspect, f, eye: [t[0], t[1], t[2] - far] };
  }

  /** A place of the canvas from -1 to 1, to the right and up; beside each other, of its half. */
  function local(x, y) {
    const at = x / canvas.clientWidth, half = layer === "beside";
    return [half ? 4 * (at % 0.5) - 1 : 2 * at - 1, 1 - (2 * y) / canvas.clientHeight];
  }

  /** The plane through the eye and two places of the canvas, [nx, ny, nz, w]; null: they are one. */
  function planeThrough(from, to) {
    const { turn: r, aspect, f, eye } = matrices();
    const back = (v) => [0, 1, 2].map((i) => r[3 * i] * v[0] + r[3 * i + 1] * v[1] + r[3 * i + 2] * v[2]);
    const [a, b] = [from, to].map(([x, y]) => back([(x * aspect) / f, y / f, -1])), at = back(eye.map((x) => -x));
    const n = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]], long = Math.hypot(...n);
    return long > 1e-9 ? [...n.map((x) => x / long), -(n[0] * at[0] + n[1] * at[1] + n[2] * at[2]) / long] : null;
  }

  function drawSurface(node, m, base, coloured, back) {
    gl.useProgram(surface.p);
    gl.uniformMatrix4fv(surface.place, false, m.place);
    gl.uniformMatrix3fv(surface.turn, false, m.turn);
    gl.uniform1f(surface.back, back);
    gl.uniform3fv(surface.base, base);
    gl.uniform1i(surface.coloured, coloured ? 1 : 0);
    gl.uniform1i(surface.cutting, cut && back === 0 ? 1 : 0);
    gl.uniform4fv(surface.plane, cut ?? [0, 0, 0, 0]);
    if (coloured) {
      gl.uniform3fv(surface.none, theme.none);
      gl.uniform3fv(surface.line, [0.25, 0.27, 0.3]);
      gl.uniform1f(surface.end, layer.sign * layer.end);
      gl.uniform1f(surface.limit, layer.limit);
    }
    gl.bindVertexArray(node.vao);
    gl.drawElements(gl.TRIANGLES, node.index.length, node.type, 0);
  }

  function drawScene() {
    const m = matrices(), { width, height } = canvas;
    gl.viewport(0, 0, width, height);
    gl.enable(gl.DEPTH_TEST);
    gl.disable(gl.SCISSOR_TEST);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    if (nodes.face) drawSurface(nodes.face, m, theme.skin, false, 0);
    if (nodes.scan) {
      gl.useProgram(point.p);
      gl.uniformMatrix4fv(point.place, false, m.place);
      gl.uniform1f(point.size, 1.5 * (width / canvas.clientWidth || 1));
      gl.uniform3fv(point.base, theme.dots);
      gl.bindVertexArray(nodes.scan.vao);
      gl.drawArrays(gl.POINTS, 0, nodes.scan.n);
    }
    if (!nodes.template) return;
    if (!nodes.probe) return drawSurface(nodes.template, m, theme.skin, false, 0);
    const sides = [[nodes.template, theme.a], [nodes.probe, theme.b]];
    if (layer === "curtain") {
      const at = Math.round(width * curtain);
      if (swapped) sides.reverse();
      gl.enable(gl.SCISSOR_TEST);
      gl.scissor(0, 0, at, height);
      drawSurface(sides[0][0], m, sides[0][1], false, 0);
      gl.scissor(at, 0, width - at, height);
      drawSurface(sides[1][0], m, sides[1][1], false, 0);
      gl.disable(gl.SCISSOR_TEST);
    } else if (layer === "beside") {
      sides.forEach(([node, color], i) => {
        gl.viewport((i * width) / 2, 0, width / 2, height);
        drawSurface(node, m, color, false, 0);
      });
    } else if (layer === "a" || layer === "b") {
      const [node, color] = sides[layer === "a" ? 0 : 1];
      drawSurface(node, m, color, false, 0);
    } else {
      drawSurface(nodes.probe, m, theme.skin, layer !== null, 0);
      drawSurface(nodes.template, m, theme.none, false, 0.012); // behind the probe: last, so that it costs little
    }
  }

  // A multisampled buffer of the canvas' size.
  function smoothBuffer() {
    if (smooth && smooth.width === canvas.width && smooth.height === canvas.height) return smooth;
    if (smooth) {
      smooth.stores.forEach((s) => gl.deleteRenderbuffer(s));
      gl.deleteFramebuffer(smooth.frame);
    }
    smooth = { width: canvas.width, height: canvas.height, frame: gl.createFramebuffer() };
    gl.bindFramebuffer(gl.FRAMEBUFFER, smooth.frame);
    smooth.stores = [[gl.RGBA8, gl.COLOR_ATTACHMENT0], [gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT]].map(
      ([format, place]) => {
        const s = gl.createRenderbuffer();
        gl.bindRenderbuffer(gl.RENDERBUFFER, s);
        gl.renderbufferStorageMultisample(gl.RENDERBUFFER, 4, format, canvas.width, canvas.height);
        gl.framebufferRenderbuffer(gl.FRAMEBUFFER, place, gl.RENDERBUFFER, s);
        return s;
      });
    return smooth;
  }

  function draw(w, h, fine) {
    if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
    gl.bindFramebuffer(gl.FRAMEBUFFER, fine ? smoothBuffer().frame : null);
    drawScene();
    if (!fine) return;
    gl.bindFramebuffer(gl.READ_FRAMEBUFFER, smooth.frame);
    gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, null);
    gl.blitFramebuffer(0, 0, w, h, 0, 0, w, h, gl.COLOR_BUFFER_BIT, gl.NEAREST);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }

  function frame(fine) {
    asked = 0;
    const scale = Math.min(devicePixelRatio || 1, 2);
    draw(...[canvas.clientWidth, canvas.clientHeight].map((x) => Math.max(1, Math.round(x * scale))), fine);
    drawn();
  }

  /** A picture of its own, on a transparent ground: a canvas of so many pixels.  as: {layer, pose, colors, cut}, else as it
   *  is seen. */
  function picture(width, height, as = {}) {
    const was = { layer, theme, cut, yaw, pitch, zoom, size: [canvas.width, canvas.height] };
    const to = document.createElement("canvas");
    [to.width, to.height] = [width, height];
    if (as.colors) setTheme(as.colors);
    if (as.layer !== undefined) setLayer(as.layer);
    if (as.cut !== undefined) cut = as.cut;
    if (as.pose) [yaw, pitch, zoom] = [...VIEWS[as.pose], 1];
    draw(width, height, true);
    to.getContext("2d").drawImage(canvas, 0, 0);
    ({ theme, cut, yaw, pitch, zoom } = was);
    setLayer(was.layer);
    draw(...was.size, true);
    return to;
  }

  function changedFrame() {
    clearTimeout(rest);
    if (!asked) asked = requestAnimationFrame(() => frame(false));
    rest = setTimeout(() => requestAnimationFrame(() => frame(true)), 150);
  }

  /** What of the coloured surface is under a place of the canvas; {none}: what was not compared; null: nothing. */
  function pick(x, y) {
    const node = nodes.probe;
    if (!node || !layer?.name) return null;
    const m = matrices().place, { at, index, seen } = node, value = node[layer.name];
    const [px, py] = local(x, y);
    const on = new Float32Array(at.length);
    for (let v = 0; v < at.length; v += 3) {
      const w = m[3] * at[v] + m[7] * at[v + 1] + m[11] * at[v + 2] + m[15];
      for (let k = 0; k < 3; k++)
        on[v + k] = (m[k] * at[v] + m[4 + k] * at[v + 1] + m[8 + k] * at[v + 2] + m[12 + k]) / w;
    }
    let best = null, near = Infinity;
    for (let t = 0; t < index.length; t += 3) {
      const [a, b, c] = [3 * index[t], 3 * index[t + 1], 3 * index[t + 2]];
      const area = (on[b] - on[a]) * (on[c + 1] - on[a + 1]) - (on[c] - on[a]) * (on[b + 1] - on[a + 1]);
      if (area <= 0) continue;
      const u = ((on[b] - px) * (on[c + 1] - py) - (on[c] - px) * (on[b + 1] - py)) / area;
      const v = ((on[c] - px) * (on[a + 1] - py) - (on[a] - px) * (on[c + 1] - py)) / area;
      const w = 1 - u - v, z = u * on[a + 2] + v * on[b + 2] + w * on[c + 2];
      if (u < 0 || v < 0 || w < 0 || z >= near) continue;
      near = z;
      const mean = (of, k = 0, step = 1) =>
        u * of[(a / 3) * step + k] + v * of[(b / 3) * step + k] + w * of[(c / 3) * step + k];
      best = mean(seen) < 0.5 ? { none: true } : {
        value: mean(value), gap: mean(node._GAP_MM), rest: mean(node._REST_MM), part: mean(node._PART),
        at: [0, 1, 2].map((k) => mean(at, k, 3)), normal: [0, 1, 2].map((k) => mean(node.normal, k, 3)),
      };
    }
    return best;
  }

  /** Where a point is on the canvas, px, and whether it faces the eye. */
  function project({ at, normal }) {
    const { place: m, turn: r } = matrices();
    const [x, y, , w] = [0, 1, 2, 3].map((k) => m[k] * at[0] + m[4 + k] * at[1] + m[8 + k] * at[2] + m[12 + k]);
    return {
      x: ((x / w + 1) / 2) * canvas.clientWidth, y: ((1 - y / w) / 2) * canvas.clientHeight,
      faces: r[2] * normal[0] + r[5] * normal[1] + r[8] * normal[2] > 0.05,
    };
  }

  function turn(dx, dy) {
    yaw = Math.max(-2.6, Math.min(2.6, yaw + dx));
    pitch = Math.max(-1.4, Math.min(1.4, pitch + dy));
    changedFrame();
  }
  function zoomBy(f) {
    zoom = Math.max(0.5, Math.min(6, zoom * f));
    changedFrame();
  }

  // ---- pointer and keys
  const down = new Map(); // pointers: two of them turn and zoom
  const place = (e) => {
    const box = canvas.getBoundingClientRect();
    return [e.clientX - box.left, e.clientY - box.top];
  };
  let begun = null; // where the only pointer went down
  canvas.addEventListener("pointerdown", (e) => {
    canvas.setPointerCapture(e.pointerId);
    down.set(e.pointerId, place(e));
    begun = down.size === 1 ? { at: place(e), moved: false, line: drawing() && e.button === 0 && !e.shiftKey } : null;
  });
  canvas.addEventListener("pointermove", (e) => {
    const was = down.get(e.pointerId);
    if (!was) return;
    const at = place(e), [dx, dy] = [at[0] - was[0], at[1] - was[1]];
    down.set(e.pointerId, at);
    if (begun && !begun.moved && Math.hypot(at[0] - begun.at[0], at[1] - begun.at[1]) < 5) return;
    if (begun) begun.moved = true;
    if (begun?.line) {
      const plane = planeThrough(local(...begun.at), local(...at));
      if (plane) lined(plane);
      return;
    }
    const other = [...down].find(([id]) => id !== e.pointerId)?.[1];
    if (other) {
      const far = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]);
      zoomBy(far(at) / Math.max(far(was), 1));
    }
    turn(dx * 0.008, dy * 0.008);
  });
  canvas.addEventListener("pointerup", (e) => {
    down.delete(e.pointerId);
    if (begun && !begun.moved && e.button === 0) tapped(...place(e));
    begun = null;
  });
  canvas.addEventListener("pointercancel", (e) => {
    down.delete(e.pointerId);
    begun = null;
  });
  canvas.addEventListener("wheel", (e) => {
    e.preventDefault();
    zoomBy(Math.exp(-e.deltaY * 0.001));
  }, { passive: false });
  function swap(on) {
    if (swapped === on) return;
    swapped = on;
    changedFrame();
  }
  const blink = (on) => (e) => {
    if (e.key !== " " || layer !== "curtain") return;
    e.preventDefault();
    swap(on);
  };
  canvas.addEventListener("keyup", blink(false));
  canvas.addEventListener("blur", () => swap(false));
  canvas.addEventListener("keydown", (e) => {
    const step = !e.shiftKey && { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] }[e.key];
    if (step) turn(...step);
    else if (e.key === "+" || e.key === "=") zoomBy(1.15);
    else if (e.key === "-") zoomBy(1 / 1.15);
    else return blink(true)(e);
    e.preventDefault();
  });
  const observer = new ResizeObserver(changedFrame);
  observer.observe(canvas);

  return {
    show, setLayer, setTheme, setCut, pick, project, picture, turn, swap,
    pose: (name) => {
      [yaw, pitch, zoom] = [...VIEWS[name], 1];
      changedFrame();
    },
    curtain: (share) => {
      curtain = Math.max(0, Math.min(1, share));
      changedFrame();
    },
    /** Gives the context back: a browser has sixteen or so, and takes the oldest. */
    close: () => {
      observer.disconnect();
      clearTimeout(rest);
      cancelAnimationFrame(asked);
      gl.getExtension("WEBGL_lose_context")?.loseContext();
    },
    state: () => ({ yaw, pitch, zoom, curtain, swapped }),
    /** The time of a frame in ms, drawn at once and waited for, after act(): for tests. */
    time: (act = () => {}) => {
      const start = performance.now();
      act();
      frame(false);
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
      return performance.now() - start;
    },
  };
}
