// view.js -- surfaces in WebGL2: turned by pointer and keys, coloured by what differs, or two of
// them to the left and right of a line.  Frames are drawn when something changed, without
// multisampling while it moves, and once more with it 150 ms after it has come to rest.

const SURFACE_VERTEX = `#version 300 es
in vec3 at, normal; in float value, seen;
uniform mat4 place; uniform mat3 turn; uniform float back;
out float light, amount, there;
void main() {
  vec3 n = turn * normal;
  float key = max(dot(n, normalize(vec3(-0.45, 0.55, 0.75))), 0.0);
  float fill = max(dot(n, normalize(vec3(0.8, -0.1, 0.55))), 0.0);
  light = 0.24 + 0.66 * key + 0.22 * fill;
  amount = value; there = seen;
  gl_Position = place * vec4(at, 1.0);
  gl_Position.z += back * gl_Position.w;
}`;

// The colours are a texture of 25 bands, so that a place can be found on the legend; a line where
// the amount passes the limit.
const SURFACE_FRAGMENT = `#version 300 es
precision highp float;
in float light, amount, there;
uniform vec3 base, none, line; uniform float end, limit; uniform int coloured; uniform sampler2D scale;
out vec4 color;
void main() {
  vec3 c = base;
  if (coloured == 1) {
    c = mix(none, texture(scale, vec2(amount / end * 0.48 + 0.5, 0.5)).rgb, step(0.5, there));
    float far = abs(abs(amount) - limit) / max(fwidth(amount), 1e-6);
    c = mix(c, line, (1.0 - smoothstep(0.4, 1.4, far)) * 0.55 * step(0.99, there));
  }
  color = vec4(c * light, 1.0);
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
 *  changed(): is called after what the pointer or a key did to the curtain or the pose. */
export function createView(canvas, changed = () => {}) {
  const gl = canvas.getContext("webgl2", { antialias: false, alpha: true, premultipliedAlpha: false });
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
  let layer = null, centre = [0, 0, 0], radius = 100, theme = {}, asked = 0, rest = 0, smooth = null;

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
      out.seen = new Float32Array(out.n).map((_, i) => (node.color[4 * i + 3] ? 1 : 0));
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
    for (const name in given) nodes[name] = upload(given[name]);
    const of = nodes.template ?? nodes.face ?? nodes.scan;
    if (of) {
      const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
      of.at.forEach((x, i) => {
        low[i % 3] = Math.min(low[i % 3], x);
        high[i % 3] = Math.max(high[i % 3], x);
      });
      centre = low.map((x, i) => (x + high[i]) / 2);
      if (of.index) centre[2] -= 20; // of a face; a scan alone is in its own unit
      radius = Math.max(high[0] - low[0], high[1] - low[1]) * (nodes.scan ? 0.8 : 0.68);
    }
    if (pose) [yaw, pitch, zoom] = [...VIEWS[pose], 1];
    changedFrame();
  }

  /** By which attribute the probe is coloured: {name, end, limit}; "curtain"; null: plain. */
  function setLayer(next) {
    layer = next;
    const probe = nodes.probe;
    if (probe && layer && layer !== "curtain") {
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

  // Turned about its centre, then seen from 5 radii in front.
  function matrices() {
    const [cy, sy, cp, sp] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
    const r = [cy, sp * sy, -cp * sy, 0, cp, sp, sy, -sp * cy, cp * cy]; // by columns
    const aspect = canvas.width / canvas.height, far = 5 * radius;
    const f = (5 / zoom ** -1) * Math.min(1, aspect * 1.15), near = far / 5, deep = far * 3;
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
    return { turn: new Float32Array(r), place };
  }

  function drawSurface(node, m, base, coloured, back) {
    gl.useProgram(surface.p);
    gl.uniformMatrix4fv(surface.place, false, m.place);
    gl.uniformMatrix3fv(surface.turn, false, m.turn);
    gl.uniform1f(surface.back, back);
    gl.uniform3fv(surface.base, base);
    gl.uniform1i(surface.coloured, coloured ? 1 : 0);
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
    if (layer === "curtain") {
      const at = Math.round(width * curtain);
      const sides = [[nodes.template, theme.a], [nodes.probe, theme.b]];
      if (swapped) sides.reverse();
      gl.enable(gl.SCISSOR_TEST);
      gl.scissor(0, 0, at, height);
      drawSurface(sides[0][0], m, sides[0][1], false, 0);
      gl.scissor(at, 0, width - at, height);
      drawSurface(sides[1][0], m, sides[1][1], false, 0);
      gl.disable(gl.SCISSOR_TEST);
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

  function frame(fine) {
    asked = 0;
    const scale = Math.min(devicePixelRatio || 1, 2);
    const [w, h] = [canvas.clientWidth, canvas.clientHeight].map((x) => Math.max(1, Math.round(x * scale)));
    if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
    gl.viewport(0, 0, w, h);
    gl.bindFramebuffer(gl.FRAMEBUFFER, fine ? smoothBuffer().frame : null);
    drawScene();
    if (fine) {
      gl.bindFramebuffer(gl.READ_FRAMEBUFFER, smooth.frame);
      gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, null);
      gl.blitFramebuffer(0, 0, w, h, 0, 0, w, h, gl.COLOR_BUFFER_BIT, gl.NEAREST);
      gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    }
  }

  function changedFrame() {
    clearTimeout(rest);
    if (!asked) asked = requestAnimationFrame(() => frame(false));
    rest = setTimeout(() => requestAnimationFrame(() => frame(true)), 150);
  }

  /** What of the coloured surface is under a place of the canvas: {value, at}, or null. */
  function pick(x, y) {
    const node = nodes.probe;
    if (!node || !layer || layer === "curtain") return null;
    const m = matrices().place, { at, index, seen } = node, value = node[layer.name];
    const px = (2 * x) / canvas.clientWidth - 1, py = 1 - (2 * y) / canvas.clientHeight;
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
      best = mean(seen) < 0.5 ? null : {
        value: mean(value), gap: mean(node._GAP_MM), rest: mean(node._REST_MM), part: mean(node._PART),
        at: [mean(at, 0, 3), mean(at, 1, 3)],
      };
    }
    return best;
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
  const down = new Map(); // pointers: two of them zoom
  canvas.addEventListener("pointerdown", (e) => {
    canvas.setPointerCapture(e.pointerId);
    down.set(e.pointerId, [e.clientX, e.clientY]);
  });
  canvas.addEventListener("pointermove", (e) => {
    const was = down.get(e.pointerId);
    if (!was) return;
    const other = [...down].find(([id]) => id !== e.pointerId)?.[1];
    if (other) {
      const far = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]);
      zoomBy(far([e.clientX, e.clientY]) / Math.max(far(was), 1));
    } else {
      turn((e.clientX - was[0]) * 0.008, (e.clientY - was[1]) * 0.008);
    }
    down.set(e.pointerId, [e.clientX, e.clientY]);
    changed();
  });
  for (const name of ["pointerup", "pointercancel"])
    canvas.addEventListener(name, (e) => down.delete(e.pointerId));
  canvas.addEventListener("wheel", (e) => {
    e.preventDefault();
    zoomBy(Math.exp(-e.deltaY * 0.001));
  }, { passive: false });
  function swap(on) {
    if (swapped === on) return;
    swapped = on;
    changedFrame();
    changed();
  }
  const blink = (on) => (e) => {
    if (e.key !== " " || layer !== "curtain") return;
    e.preventDefault();
    swap(on);
  };
  canvas.addEventListener("keyup", blink(false));
  canvas.addEventListener("blur", () => swap(false));
  canvas.addEventListener("keydown", (e) => {
    const step = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] }[e.key];
    if (step) turn(...step);
    else if (e.key === "+" || e.key === "=") zoomBy(1.15);
    else if (e.key === "-") zoomBy(1 / 1.15);
    else return blink(true)(e);
    e.preventDefault();
    changed();
  });
  const observer = new ResizeObserver(changedFrame);
  observer.observe(canvas);

  return {
    show, setLayer, setTheme, pick, turn, swap,
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
    /** The time of a frame in ms, drawn at once and waited for: for tests. */
    time: () => {
      const start = performance.now();
      frame(false);
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
      return performance.now() - start;
    },
  };
}
