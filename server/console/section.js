// section.js -- surfaces cut by a plane: the triangles that it meets, their curves, and a drawing of two
// such curves with the gap between them and a ruler.

import { el, mm, svg } from "./dom.js";

const GROUP = 32; // triangles that are looked at together

/** Spreads 10 bits, so that two numbers can be interleaved. */
function spread(x) {
  x = (x | (x << 8)) & 0xff00ff;
  x = (x | (x << 4)) & 0xf0f0f0f;
  x = (x | (x << 2)) & 0x33333333;
  return (x | (x << 1)) & 0x55555555;
}

/** Prepares a surface to be cut.  Its triangles are put in the order of a curve that fills the plane (Morton's), so that
 *  those of a group lie together, and a plane that misses a group's box misses them all. */
export function createCutter({ at, index }) {
  const n = index.length / 3, keys = new Float64Array(n);
  const low = [Infinity, Infinity], high = [-Infinity, -Infinity];
  for (let v = 0; v < at.length; v += 3)
    for (const k of [0, 1]) {
      low[k] = Math.min(low[k], at[v + k]);
      high[k] = Math.max(high[k], at[v + k]);
    }
  const cell = (k, v) => Math.floor((1023 * (at[3 * v + k] - low[k])) / (high[k] - low[k] || 1));
  for (let t = 0; t < n; t++)
    keys[t] = (spread(cell(0, index[3 * t])) + 2 * spread(cell(1, index[3 * t]))) * 2 ** 24 + t;
  keys.sort();
  const order = Uint32Array.from(keys, (key) => key % 2 ** 24), groups = Math.ceil(n / GROUP);
  const boxes = new Float32Array(6 * groups); // the smallest and the largest of x, y, z
  for (let g = 0; g < groups; g++)
    for (let k = 0; k < 3; k++) {
      let least = Infinity, most = -Infinity;
      for (let i = g * GROUP; i < Math.min(n, (g + 1) * GROUP); i++)
        for (let c = 0; c < 3; c++) {
          const x = at[3 * index[3 * order[i] + c] + k];
          least = Math.min(least, x);
          most = Math.max(most, x);
        }
      boxes[6 * g + k] = least;
      boxes[6 * g + 3 + k] = most;
    }

  /** The segments in which the plane x nx + y ny + z nz + w = 0 meets triangles: [edge, edge, x, y, z, x, y, z],
   *  from where a triangle's border goes to the plane's negative side.  An edge's number and point are the same
   *  in both of its triangles. */
  function segments([nx, ny, nz, w]) {
    const out = [], height = new Float64Array(3), to = new Float64Array(8);
    for (let g = 0; g < groups; g++) {
      const b = 6 * g;
      const far = (nx * (boxes[b] + boxes[b + 3]) + ny * (boxes[b + 1] + boxes[b + 4]) + nz * (boxes[b + 2] + boxes[b + 5])) / 2 + w;
      const reach = (Math.abs(nx) * (boxes[b + 3] - boxes[b]) + Math.abs(ny) * (boxes[b + 4] - boxes[b + 1]) +
        Math.abs(nz) * (boxes[b + 5] - boxes[b + 2])) / 2;
      if (Math.abs(far) > reach + 1e-6) continue;
      for (let i = g * GROUP; i < Math.min(n, (g + 1) * GROUP); i++) {
        const t = 3 * order[i];
        for (let c = 0; c < 3; c++) {
          const v = 3 * index[t + c];
          height[c] = nx * at[v] + ny * at[v + 1] + nz * at[v + 2] + w;
        }
        if (height[0] >= 0 === height[1] >= 0 && height[1] >= 0 === height[2] >= 0) continue;
        for (let c = 0; c < 3; c++) {
          const d = (c + 1) % 3;
          if (height[c] >= 0 === height[d] >= 0) continue;
          const swap = index[t + c] > index[t + d], [a, z] = swap ? [d, c] : [c, d];
          const p = 3 * index[t + a], q = 3 * index[t + z], share = height[a] / (height[a] - height[z]);
          const end = height[c] >= 0 ? 0 : 1;
          to[end] = index[t + a] * 2 ** 24 + index[t + z];
          for (let k = 0; k < 3; k++) to[2 + 3 * end + k] = at[p + k] + share * (at[q + k] - at[p + k]);
        }
        out.push(Float64Array.from(to));
      }
    }
    return out;
  }

  /** The same as curves: of each its points [x, y, z, ...]. */
  function curves(plane) {
    const all = segments(plane), from = new Map(all.map((s) => [s[0], s])), ends = new Set(all.map((s) => s[1]));
    const out = [];
    const follow = (s) => {
      const points = [...s.subarray(2, 5)];
      for (; s && from.delete(s[0]); s = from.get(s[1])) points.push(...s.subarray(5, 8));
      out.push(points);
    };
    all.filter((s) => !ends.has(s[0])).forEach(follow);
    while (from.size) follow(from.values().next().value); // those without an end
    return out;
  }
  return { segments, curves };
}

const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const unit = (a) => a.map((x) => x / Math.hypot(...a));

/** A cut as its numbers: turn from the middle of the face, degrees (0 from top to chin, 90 from ear to ear), tilt towards
 *  the scanner, and distance from the frame's middle, mm. */
export function planeOf({ turn, tilt, place }) {
  const [t, s] = [(turn * Math.PI) / 180, (tilt * Math.PI) / 180];
  return [Math.cos(t) * Math.cos(s), Math.sin(t) * Math.cos(s), Math.sin(s), -place];
}

export function cutOf([nx, ny, nz, w]) {
  const over = Math.atan2(ny, nx), flip = over <= -Math.PI / 2 + 1e-9 || over > Math.PI / 2 + 1e-9 ? -1 : 1;
  return { turn: (Math.atan2(flip * ny, flip * nx) * 180) / Math.PI, tilt: (Math.asin(Math.max(-1, Math.min(1, flip * nz))) * 180) / Math.PI, place: -flip * w };
}

const STEP = 0.25; // mm, of the gap along the cut

/** The height of curves above the cut's own axis, at steps along it: the highest where there are several. */
function heights(lines, first, n) {
  const out = new Float64Array(n).fill(NaN);
  for (const line of lines)
    for (let i = 2; i < line.length; i += 2) {
      const [a, b] = line[i - 2] <= line[i] ? [i - 2, i] : [i, i - 2];
      for (let k = Math.max(0, Math.ceil((line[a] - first) / STEP)); k < n && first + k * STEP <= line[b]; k++) {
        const share = (first + k * STEP - line[a]) / (line[b] - line[a] || 1);
        const v = line[a + 1] + share * (line[b + 1] - line[a + 1]);
        if (!(out[k] >= v)) out[k] = v;
      }
    }
  return out;
}

/** The heights of A and of B along a cut, by steps from first on; NaN where there is none. */
export function gapOf(a, b) {
  let first = Infinity, last = -Infinity;
  for (const line of [...a, ...b])
    for (let i = 0; i < line.length; i += 2) {
      first = Math.min(first, line[i]);
      last = Math.max(last, line[i]);
    }
  const n = last >= first ? Math.floor((last - first) / STEP) + 1 : 0;
  return { first, a: heights(a, first, n), b: heights(b, first, n) };
}

/** The curves of both as drawn, [along, up, ...]: along the cut to the right or to the chin, up to the scanner. */
function flatten(curves, plane) {
  const n = plane.slice(0, 3), along = unit(Math.hypot(n[0], n[1]) > 0.2 ? cross(n, [0, 0, 1]) : cross(n, [0, 1, 0])), up = cross(along, n);
  return curves.map((points) => {
    const out = new Float64Array((points.length / 3) * 2);
    for (let i = 0, k = 0; i < points.length; i += 3, k += 2) {
      const p = [points[i], points[i + 1], points[i + 2]];
      out[k] = dot(p, along);
      out[k + 1] = dot(p, up);
    }
    return out;
  });
}

// What the drawing has room for, mm: a face and its depth.  Fixed, so that two drawings can be compared.
const WIDE = 176, HIGH = 74;

/** The drawing of a cut through A and B, or through one surface. */
export function createSection() {
  const path = (kind) => svg("path", { class: kind });
  const parts = { front: path("front"), behind: path("behind"), a: path("a"), b: path("b"), ruler: path("ruler") };
  const texts = svg("g"), picture = svg("svg", { class: "cuts", role: "img" }, ...Object.values(parts), texts);
  const said = el("p.said");

  /** cutters: of A, and of B or null; size: of the drawing in px. */
  function draw(cutters, plane, width, height) {
    const [a, b] = cutters.map((c) => (c ? flatten(c.curves(plane), plane) : []));
    const scale = Math.min((width - 64) / WIDE, (height - 30) / HIGH), ends = [Infinity, Infinity, -Infinity, -Infinity];
    for (const line of [...a, ...b])
      for (let i = 0; i < line.length; i++) {
        ends[i % 2] = Math.min(ends[i % 2], line[i]);
        ends[2 + (i % 2)] = Math.max(ends[2 + (i % 2)], line[i]);
      }
    const empty = !(ends[2] >= ends[0]), [u, v] = empty ? [0, 0] : [(ends[0] + ends[2]) / 2, (ends[1] + ends[3]) / 2];
    const x = (at) => (width / 2 + 18 + (at - u) * scale).toFixed(1), y = (at) => (height / 2 - 12 - (at - v) * scale).toFixed(1);
    const trace = (lines) => lines.map((line) => {
      let d = "";
      for (let i = 0; i < line.length; i += 2) d += `${i ? "L" : "M"}${x(line[i])} ${y(line[i + 1])}`;
      return d;
    }).join("");
    const gap = b.length ? gapOf(a, b) : null;
    parts.a.setAttribute("d", trace(a));
    parts.b.setAttribute("d", trace(b));
    for (const [name, pick] of [["front", Math.max], ["behind", Math.min]])
      parts[name].setAttribute("d", gap ? filled(gap, pick, x, y) : "");
    picture.setAttribute("viewBox", `0 0 ${width} ${height}`);
    picture.setAttribute("width", width);
    picture.setAttribute("height", height);
    rule(empty ? 0 : ends[0], empty ? 0 : ends[2], empty ? 0 : v, x, y, height);
    said.textContent = empty ? "The cut misses the face." : gap ? inWords(gap) : `${mm(ends[2] - ends[0], 0)} along the cut.`;
    picture.setAttribute("aria-label", `The cut. ${said.textContent}`);
  }

  /** The ruler: along the cut from its beginning, and up beside it; a mark each 10 mm. */
  function rule(from, to, middle, x, y, height) {
    const line = height - 18, long = Math.max(10, Math.ceil((to - from) / 10) * 10), side = Number(x(from)) - 16;
    let d = `M${x(from)} ${line}H${x(from + long)}M${side} ${y(middle - 30)}V${y(middle + 30)}`;
    for (let k = 0; k <= long; k += 10) d += `M${x(from + k)} ${line}v${k % 50 ? -4 : -7}`;
    for (let k = -30; k <= 30; k += 10) d += `M${side} ${y(middle + k)}h${k % 30 ? 4 : 7}`;
    parts.ruler.setAttribute("d", d);
    const marks = [];
    for (let k = 0; k <= long; k += 50) marks.push([x(from + k), line + 13, k ? `${k} mm` : "0", "middle"]);
    marks.push([side - 4, Number(y(middle)) + 4, "60 mm", "end"]);
    while (texts.children.length < marks.length) texts.append(svg("text"));
    while (texts.children.length > marks.length) texts.lastChild.remove();
    marks.forEach(([tx, ty, text, anchor], i) => {
      const t = texts.children[i];
      t.setAttribute("x", tx);
      t.setAttribute("y", ty);
      t.setAttribute("text-anchor", anchor);
      t.textContent = text;
    });
  }
  return { picture, said, draw };
}

/** The area between both curves where B is in front of A (pick: max), or behind it (min). */
function filled({ first, a, b }, pick, x, y) {
  let d = "";
  for (let from = 0, to; from < a.length; from = to + 1) {
    for (to = from; to < a.length && !Number.isNaN(a[to] + b[to]); to++);
    if (to - from < 2) continue;
    let back = "";
    for (let k = from; k < to; k++) {
      const at = x(first + k * STEP);
      d += `${k === from ? "M" : "L"}${at} ${y(a[k])}`;
      back = `L${at} ${y(pick(a[k], b[k]))}${back}`;
    }
    d += `${back}Z`;
  }
  return d;
}

function inWords({ a, b }) {
  let front = 0, behind = 0, sum = 0, n = 0;
  for (let k = 0; k < a.length; k++) {
    const gap = b[k] - a[k];
    if (Number.isNaN(gap)) continue;
    front = Math.max(front, gap);
    behind = Math.max(behind, -gap);
    sum += Math.abs(gap);
    n++;
  }
  if (!n) return "A and B do not meet along this cut.";
  return `B lies at most ${mm(front, 1)} in front of A, ${mm(behind, 1)} behind it; ${mm(sum / n)} on average along ${mm(n * STEP, 0)}.`;
}
