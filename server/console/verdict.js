// verdict.js -- a decision: its icon, word and colour, and its score on a gauge.

import { plain, svg } from "./dom.js";

export const VERDICTS = {
  match: { icon: "yes", kind: "ok", title: "Same face" },
  no_match: { icon: "no", kind: "no", title: "Different faces" },
  inconclusive: { icon: "unsure", kind: "unsure", title: "Cannot tell" },
};

/** The score on the curve of other people's scores, which the calibration's knots describe: the share
 *  of other people that score as high or higher. */
export function gauge(r, knots) {
  const low = Math.min(-100, r.score - 5), high = Math.max(45, r.score + 5), W = 300, y = 52;
  const x = (score) => ((score - low) / (high - low)) * W;
  const out = svg("svg", { viewBox: `0 0 ${W} 76`, class: "gauge", role: "img",
    "aria-label": `score ${plain(r.score, 1)}, threshold ${plain(r.threshold, 1)}` });
  const line = (a, b, kind) => svg("rect", { x: x(a), y: y - 4, width: Math.max(0, x(b) - x(a)), height: 8, rx: 4, class: kind });
  if (knots?.length > 1) {
    // Where the curve of the share falls steeply there are many people.
    const steps = 60, share = (s) => {
      const i = knots.findIndex((k) => k.score > s);
      if (i === 0) return 1;
      if (i < 0) return knots.at(-1).rate;
      const [a, b] = [knots[i - 1], knots[i]], t = (s - a.score) / (b.score - a.score);
      return Math.exp(Math.log(a.rate) * (1 - t) + Math.log(b.rate) * t);
    };
    const bins = Array.from({ length: steps }, (_, i) => {
      const at = (k) => low + ((high - low) * k) / steps;
      return Math.max(0, share(at(i)) - share(at(i + 1)));
    });
    const most = Math.max(...bins, 1e-9);
    const points = bins.map((b, i) => `${(((i + 0.5) * W) / steps).toFixed(1)},${(y - 4 - 34 * Math.sqrt(b / most)).toFixed(1)}`);
    out.append(svg("polygon", { class: "others", points: `0,${y - 4} ${points.join(" ")} ${W},${y - 4}` }),
      svg("text", { x: 0, y: 10 }, "scores of other people"));
  }
  const text = (at, up, what, kind = "") => {
    const t = svg("text", { x: Math.min(Math.max(x(at), 22), W - 22), y: up, "text-anchor": "middle", class: kind });
    t.textContent = what;
    return t;
  };
  out.append(line(low, r.threshold, "no"), line(r.threshold, high, "ok"),
    svg("rect", { x: x(r.threshold) - 0.75, y: y - 9, width: 1.5, height: 18, class: "limit" }),
    text(r.threshold, y + 21, `needed ${plain(r.threshold, 1)}`),
    svg("circle", { cx: x(r.score), cy: y, r: 6.5, class: "score" }),
    text(r.score, y - 13, plain(r.score, 1), "strong"));
  return out;
}
