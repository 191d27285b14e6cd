// scans.js -- are the scans as good as they were: of each token, week by week.

import { get, query } from "./api.js";
import { count, el, many, mm, percent, svg } from "./dom.js";
import { failed, meter, state, table } from "./widgets.js";

const WEEKS = 12, WEEK_MS = 7 * 86400e3, W = 168, H = 36, EDGE = 4;

/** The Mondays of the last weeks, oldest first. */
function mondays() {
  const today = Math.floor(Date.now() / 86400e3), monday = today - ((today + 3) % 7);
  return Array.from({ length: WEEKS }, (_, i) => new Date(monday * 86400e3 - (WEEKS - 1 - i) * WEEK_MS).toISOString().slice(0, 10));
}

const noise = (w) => (w.noise_mm === null ? "no noise known" : mm(w.noise_mm));

/** The noise, week by week, from 0 to what all rows share; a week without scans parts the line. */
function line(t, most) {
  const weeks = mondays().map((from) => t.weeks.find((w) => w.from === from)), known = (w) => w && w.noise_mm !== null;
  const x = (i) => EDGE + (i / (WEEKS - 1)) * (W - 2 * EDGE), y = (w) => H - EDGE - (w.noise_mm / most) * (H - 2 * EDGE);
  const path = weeks.map((w, i) => known(w) && `${known(weeks[i - 1]) ? "L" : "M"}${x(i).toFixed(1)} ${y(w).toFixed(1)}`).filter(Boolean).join("");
  const out = svg("svg", { viewBox: `0 0 ${W} ${H}`, width: W, height: H, class: `chart weeks${t.change ? " unsure" : ""}`, role: "img",
    "aria-label": `Noise by week: ${t.weeks.map((w) => `${w.from} ${noise(w)}`).join(", ")}` },
  svg("line", { x1: EDGE, x2: W - EDGE, y1: H - EDGE, y2: H - EDGE, class: "grid" }), svg("path", { d: path, class: "curve" }));
  weeks.forEach((w, i) => known(w) && out.append(svg("circle", { cx: x(i), cy: y(w), r: i === WEEKS - 1 ? 3.5 : 2 }, svg("title", {}, `Week of ${w.from}: ${mm(w.noise_mm)}`))));
  return out;
}

const last = (t) => t.weeks.at(-1);
const unusable = (w) => (w.unusable ? percent(w.unusable / (w.n + w.unusable)) : "none");

function show(all) {
  const most = Math.max(0.6, ...all.flatMap((t) => t.weeks.map((w) => w.noise_mm ?? 0)));
  const tokens = table("Scans by token", [
    ["Token", (t) => (t.token_id ? el("a.plain", { href: `#audit${query({ actor: t.token_id })}` }, t.token) : t.token), "name"],
    ["Changed", (t) => t.change && state({ kind: "unsure", icon: "warning", title: t.change[0].toUpperCase() + t.change.slice(1) }), "why"],
    [`Noise, ${WEEKS} weeks`, (t) => line(t, most), "drawn"],
    ["Noise", (t) => noise(last(t)), "number"],
    ["Quality", (t) => meter(last(t).quality)],
    ["Unusable", (t) => unusable(last(t)), "number"],
    ["Scans", (t) => count(last(t).n + last(t).unusable), "number"],
  ]);
  const weeks = table("Scans by token and week", [
    ["Token", (r) => r.token, "name"], ["Week from (UTC)", (r) => r.from], ["Noise", noise, "number"],
    ["Quality", (r) => meter(r.quality)], ["Unusable", unusable, "number"], ["Scans", (r) => count(r.n + r.unusable), "number"]]);
  tokens.set([...all].sort((a, b) => !a.change - !b.change));
  weeks.set(all.flatMap((t) => [...t.weeks].reverse().map((w) => ({ token: t.token, ...w }))));
  return [el("p.dim", {}, "What was sent to verify or to identify. The figures are of the last week with scans; the lines have one scale. ",
    "A scan without a face, or too poor, is unusable and was refused."), tokens.element,
  el("details", {}, el("summary", {}, `All weeks of ${many(all.length, "token")}`), weeks.element)];
}

export function openScans(body) {
  let done = false;
  const load = () => get("/v1/stats").then((s) => !done && body.replaceChildren(...(s.scans.length ? show(s.scans)
    : [el("section.card", {}, el("p.dim", {}, "No scan in the last twelve weeks. For each token and day the sums of noise and quality are kept: they name nobody."))])),
  (e) => !done && body.replaceChildren(failed(e, load)));
  load();
  return () => {
    done = true;
  };
}
