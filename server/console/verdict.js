// verdict.js -- a decision and what goes with it: cards with the word, the score on a gauge, what each
// region adds, advice, figures.

import { count, el, icon, mm, oneIn, percent, plain, reason, signed, svg } from "./dom.js";

export const VERDICTS = {
  match: { icon: "yes", kind: "ok", title: "Same face" },
  no_match: { icon: "no", kind: "no", title: "Different faces" },
  inconclusive: { icon: "unsure", kind: "unsure", title: "Cannot tell" },
};

/** A large word with its icon and colour; kind: ok, no, unsure. */
export function verdict(kind, iconName, title, ...rest) {
  return el(`section.card.verdict.${kind}`, { role: "status" },
    el("h2", {}, icon(iconName, 26), title), ...rest);
}

/** What failed; a script's own error does not read as if it were the scan's. */
export function failure(e) {
  return verdict(e.status === 422 ? "no" : "unsure", "warning", e.status === 422 ? "Not usable" : "That did not work",
    el("p", {}, e.status === undefined ? `The page failed: ${e.message}` : e.message),
    e.wait && el("p.dim", {}, `It can be tried again in ${e.wait} s.`));
}

/** In the place of numbers that the token may not know. */
export const UNTOLD = "The numbers of a non-match are shown to a token with the scope score.";

/** How far a score is from the threshold: of 4, which is 50 times as likely, and of 16. */
function strength(r) {
  const far = Math.abs(r.score - r.threshold);
  return far < 4 ? "Marginal" : far < 16 ? "Clear" : "Strong";
}

/** What was decided, in a sentence. */
function explain(r) {
  if (r.score === undefined) return UNTOLD;
  const apart = `On average the two surfaces lie ${mm(r.disparity_mm)} apart.`;
  if (r.decision === "match")
    return `${strength(r)}: the shape speaks for one person. The evidence is ${plain(r.score, 1)}, and ${plain(r.threshold, 1)} is enough. ${apart}`;
  if (r.decision === "no_match")
    return `${strength(r)}: the shape speaks against one person. The evidence is ${plain(r.score, 1)}, and ${plain(r.threshold, 1)} would be needed. ${apart}`;
  return `The two scans have ${percent(r.overlap)} of the face in common: too little, or too noisy, to say whether it is the same.`;
}

/** How many other people would match like this, in words; of what is no match there is nothing to say.  Where the knots are
 *  unknown it is a limit: beyond the last of them the rate stays at its own. */
function rate(r) {
  if (r.decision !== "match") return null;
  const knots = r.calibration?.knots, many = oneIn(r.fmr_at_score, knots?.at(-1).rate);
  return el("p.dim", {}, `${knots ? many[0].toUpperCase() + many.slice(1) : `At most ${many.replace(/^\D*/, "")}`} other people would score this high or higher.`);
}

/** Of a comparison: the verdict, why, the gauge, and the rate in words. */
export function decided(r) {
  const v = VERDICTS[r.decision], told = r.score !== undefined;
  return verdict(v.kind, v.icon, v.title, el("p", {}, explain(r)), told && gauge(r, r.calibration?.knots),
    told && r.expected > 0 && el("p.dim", {}, `Two such scans of one person score ${plain(r.expected, 1)} on average, by the model.`), told && rate(r));
}

/** The quality of a scan, if what was scanned is a face: of anything else it says nothing. */
export const qualityOf = (r) => (r.code === "not_a_face" ? null : r.quality?.score);

/** Of a comparison: the cards that say what decided, and its figures. */
export const compared = (r) => ({
  cards: [decided(r), r.regions && regions(r.regions)],
  known: r.score === undefined ? [] : [["Face in common", percent(r.overlap)], ["Minimal disparity", mm(r.disparity_mm, r.minimal ? 3 : 2)],
    r.minimal && ["Volume between", `${(r.minimal.volume_mm3 / 1000).toFixed(1)} cm³`],
    r.template_id && ["Templates compared", count(r.templates_compared)], ["Version", r.engine]],
});

/** Of a check: likewise what was found in a scan; after: the verdict's last lines. */
export const found = (r, ...after) => ({
  cards: [checked(r, false, ...after), advice(r), notes(r)],
  known: r.scan ? [["Format", r.scan.format.toUpperCase()], ["Points read", count(r.scan.points_read)],
    ["Points on the face", count(r.scan.points_used)],
    r.scan.yaw_deg != null && ["Turned", `${plain(r.scan.yaw_deg, 0)}°`], ["Covered", percent(r.scan.occluded)],
    r.quality && ["A point every", mm(r.quality.density_mm, 1)], r.quality && ["Noise", mm(r.quality.noise_mm)]] : [],
});

/** Of a scan alone, by a check; verifying: nobody is to be enrolled. */
export function checked(r, verifying, ...rest) {
  const [kind, iconName, title, text] = r.enrollable || (r.usable && verifying && r.code !== "not_a_face")
    ? ["ok", "yes", verifying ? "Good to verify" : "Good to enroll", r.enrollable ? "The face is whole, sharp and turned to the scanner." : "It is good enough for that, though not to enroll."]
    : r.usable && r.code === "not_a_face" ? ["no", "no", "Hardly a face",
      "What was scanned does not have the shape of a face, or too little of one is seen. A verification takes such a scan, but hardly any fits."]
    : r.usable ? ["unsure", "unsure", "Good to verify, not to enroll", reason(r.detail)] : ["no", "no", "Not usable", reason(r.detail)];
  return verdict(kind, iconName, title, el("p", {}, text), ...rest);
}

const REGIONS = ["nose", "eyes", "forehead", "cheeks", "mouth", "chin"];

/** What each region adds to the score: to the right for, to the left against one person. */
export function regions(of) {
  const most = Math.max(1, ...Object.values(of).map(Math.abs));
  return el("section.card", {}, el("h2", {}, "What each region adds to the score"),
    el("ul.regions", {}, REGIONS.filter((r) => of[r] != null).sort((a, b) => Math.abs(of[b]) - Math.abs(of[a])).map((name) => {
      const share = (50 * Math.abs(of[name])) / most, bar = el(of[name] < 0 ? "i.no" : "i.ok");
      bar.style.width = `${share}%`;
      bar.style.left = of[name] < 0 ? `${50 - share}%` : "50%";
      return el("li", {}, el("span", {}, name), el("span.bar", {}, bar), el("span.value", {}, signed(of[name], 1)));
    })));
}

/** Pairs of a name and a value; what is false or null is left out. */
export const pairs = (rows) => rows.filter(Boolean).flatMap(([k, v]) => [el("dt", {}, k), el("dd", {}, v)]);
export const facts = (rows) => el("dl.card.facts", {}, pairs(rows));

function lines(title, kind, all) {
  return all.length > 0 && el("section.card", {}, el("h2", {}, title), all.map((line) => el(`p${kind}`, {}, kind && icon("warning", 18), line)));
}

/** What to change at the scanner, and what was done with the scan, in the daemon's words. */
export const advice = (r) => lines("What to do at the scanner", ".advice", r.advice);
export const notes = (r) => lines("What was done with the scan", "", r.notes);

/** The share of other people at or above a score: between the knots, a straight line of its logarithm. */
export function shareAbove(knots, score) {
  const i = knots.findIndex((k) => k.score > score);
  if (i === 0) return 1;
  if (i < 0) return knots.at(-1).rate;
  const [a, b] = [knots[i - 1], knots[i]], t = (score - a.score) / (b.score - a.score);
  return Math.exp(Math.log(a.rate) * (1 - t) + Math.log(b.rate) * t);
}

/** The score between two hills: other people's scores, which the calibration's knots describe, and one person's, whose mean
 *  is what the model expects of two such scans; its spread is the model's most, of variance 2 x mean. */
export function gauge(r, knots) {
  const same = r.expected > 0 ? r.expected : null;
  const low = Math.min(-100, r.score - 5), high = Math.max(45, r.score + 5, same ? same + 3 * Math.sqrt(2 * same) : 0), W = 300, y = 52;
  const x = (score) => ((score - low) / (high - low)) * W;
  const top = knots?.length > 1 || same ? 0 : 28; // without hills there is nothing above
  const out = svg("svg", { viewBox: `0 ${top} ${W} ${76 - top}`, class: "gauge", role: "img",
    "aria-label": `score ${plain(r.score, 1)}, threshold ${plain(r.threshold, 1)}${same ? `, expected of one person ${plain(same, 1)}` : ""}` });
  const line = (a, b, kind) => svg("rect", { x: x(a), y: y - 4, width: Math.max(0, x(b) - x(a)), height: 8, rx: 4, class: kind });
  const steps = 60, at = (k) => low + ((high - low) * k) / steps;
  const hill = (kind, heights) => {
    const most = Math.max(...heights, 1e-9);
    const points = heights.map((b, i) => `${(((i + 0.5) * W) / steps).toFixed(1)},${(y - 4 - 32 * Math.sqrt(b / most)).toFixed(1)}`);
    out.append(svg("polyline", { class: kind, points: `0,${y - 4} ${points.join(" ")} ${W},${y - 4}` }));
  };
  // Where the curve falls steeply there are many people.
  if (knots?.length > 1) hill("others", Array.from({ length: steps }, (_, i) => Math.max(0, shareAbove(knots, at(i)) - shareAbove(knots, at(i + 1)))));
  if (same) hill("same", Array.from({ length: steps }, (_, i) => Math.exp(-((at(i + 0.5) - same) ** 2) / (4 * same))));
  if (knots?.length > 1) out.append(svg("text", { x: 0, y: 10 }, "other people"));
  if (same) out.append(svg("text", { x: W, y: 10, "text-anchor": "end" }, "one person"));
  const text = (at, up, what, kind = "") =>
    svg("text", { x: Math.min(Math.max(x(at), 22), W - 22), y: up, "text-anchor": "middle", class: kind }, what);
  out.append(line(low, r.threshold, "no"), line(r.threshold, high, "ok"),
    svg("rect", { x: x(r.threshold) - 0.75, y: y - 9, width: 1.5, height: 18, class: "limit" }),
    text(r.threshold, y + 21, `needed ${plain(r.threshold, 1)}`));
  if (same) {
    out.append(svg("rect", { x: x(same) - 0.75, y: y - 36, width: 1.5, height: 40, class: "expected" }));
    if (x(same) - x(r.threshold) > 76) out.append(text(same, y + 21, `expected ${plain(same, 1)}`));
  }
  out.append(svg("circle", { cx: x(r.score), cy: y, r: 6.5, class: "score" }),
    text(r.score, y - 13, plain(r.score, 1), "strong"));
  return out;
}
