// calibration.js -- does the threshold still fit: on the curve of other people's scores, and on the
// scores of the last weeks.

import { get } from "./api.js";
import { count, day, drawn, el, many, oneIn, plain, svg } from "./dom.js";
import { pairs, shareAbove } from "./verdict.js";
import { failed } from "./widgets.js";
import { outcome } from "./words.js";

const LOW = -40, STEP = 2, BINS = 64, WEEKS = 12, DECISIONS = ["match", "inconclusive", "no_match"];

/** The threshold's name over its line, which no edge cuts. */
const named = (x, width, threshold) => svg("text", { x: Math.max(48, Math.min(x, width - 48)), y: 12, "text-anchor": "middle", class: "strong" }, `threshold ${plain(threshold, 1)}`);

/** What another threshold would have changed, of the scores that are kept, which are counted in steps: in a sentence. */
function effect(all, from, to) {
  const n = all.reduce((sum, w) => sum + w.n, 0), low = Math.min(from, to), high = Math.max(from, to);
  const share = (bin) => Math.max(0, Math.min(LOW + STEP * (bin + 1), high) - Math.max(LOW + STEP * bin, low)) / STEP;
  const k = Math.round(all.flatMap((w) => DECISIONS.map((d) => w.bins[d].reduce((sum, v, bin) => sum + v * share(bin), 0))).reduce((a, b) => a + b, 0));
  return n > 0 && to !== from && ` Of the ${count(n)} scans of the last ${all.length === 1 ? "week" : many(all.length, "week")}, ${k ? `about ${count(k)}` : "none"} ${to > from ? "fewer" : "more"} would have passed.`;
}

const interval = (c) => `${plain(c.low, 1)} to ${plain(c.high, 1)}`;

/** What the threshold was learned from, in words. */
const learned = (c) => el("p.dim", {}, `Learned from scans of ${many(c.subjects, "person", "people")}: ${many(c.non_mated, "comparison")} of two of them set the threshold. `,
  c.mated ? `${many(c.mated, "comparison")} of one person's scans showed how often the right one is refused. ` : "There were no two scans of one person, so how often the right one is refused is not known. ",
  `Of other people like these, the threshold for the same rate would lie between ${plain(c.low, 1)} and ${plain(c.high, 1)} in 95 of 100 cases: the grey band.`);

/** Rates downwards by powers of ten, scores to the right; a line that is moved to ask "what if". */
function curve(c, all) {
  const H = 260, left = 96, bottom = 28, top = 24, right = 16;
  const low = Math.max(-40, Math.min(c.knots[0].score, c.low ?? 0, 0)), high = Math.max(c.knots.at(-1).score, c.high ?? 0, c.threshold + 8);
  const least = Math.floor(Math.log10(Math.min(...c.knots.map((k) => k.rate))));
  const slider = el("input", { type: "range", min: Math.ceil(low), max: Math.floor(high), step: 0.5, value: c.threshold, "aria-label": "What if the threshold were" });
  const said = el("output.what"), mark = svg("circle", { r: 5.5, class: "mark" });
  let move = null; // the mark to a score, once there is a chart
  const draw = (W) => {
    const x = (s) => left + ((s - low) / (high - low)) * (W - left - right);
    const y = (r) => top + (Math.log10(Math.max(r, 10 ** least)) / least) * (H - top - bottom);
    const text = (at, up, what, anchor = "middle", kind = "") => svg("text", { x: at, y: up, "text-anchor": anchor, class: kind }, what);
    const out = svg("svg", { viewBox: `0 0 ${W} ${H}`, class: "chart", role: "img",
      "aria-label": `At the threshold of ${plain(c.threshold, 1)}${c.low === null ? "" : ` (95 % interval ${interval(c)})`}, ${oneIn(shareAbove(c.knots, c.threshold), c.knots.at(-1).rate)} other people match.` });
    for (let p = 0; p >= least; p--)
      out.append(svg("line", { x1: left, x2: W - right, y1: y(10 ** p), y2: y(10 ** p), class: "grid" }),
        text(left - 8, y(10 ** p) + 4, p === 0 ? "all" : `1 in ${count(10 ** -p)}`, "end"));
    for (let s = Math.ceil(low / 20) * 20; s <= high; s += 20) out.append(text(x(s), H - 8, plain(s, 0)));
    const last = c.knots.at(-1).score; // beyond it the rate is lower, and it is not known by how much
    const line = (from, to, kind) => svg("polyline", { class: kind, points: Array.from({ length: 121 }, (_, i) => from + ((to - from) * i) / 120)
      .map((s) => `${x(s).toFixed(1)},${y(shareAbove(c.knots, s)).toFixed(1)}`).join(" ") });
    out.append(svg("rect", { x: x(c.threshold), y: top, width: W - right - x(c.threshold), height: H - top - bottom, class: "match" }),
      ...(c.low === null ? [] : [svg("rect", { x: x(Math.max(low, c.low)), y: top, width: x(c.high) - x(Math.max(low, c.low)), height: H - top - bottom, class: "interval" })]),
      line(low, last, "curve"), line(last, high, "curve beyond"),
      svg("line", { x1: x(c.threshold), x2: x(c.threshold), y1: top - 6, y2: H - bottom, class: "limit" }),
      named(x(c.threshold), W, c.threshold));
    move = (s) => {
      mark.setAttribute("cx", x(s));
      mark.setAttribute("cy", y(shareAbove(c.knots, s)));
    };
    move(Number(slider.value));
    out.append(mark);
    return out;
  };
  const ask = () => {
    const s = Number(slider.value);
    move?.(s);
    said.replaceChildren(...["At ", el("strong", {}, plain(s, 1)), `, ${oneIn(shareAbove(c.knots, s), c.knots.at(-1).rate)} other people would match.`, all && effect(all, c.threshold, s)].filter(Boolean));
  };
  slider.addEventListener("input", ask);
  ask();
  return [drawn(draw), el("div.what-if", {}, slider, said)];
}

/** The point of a normal distribution below which is this share (Acklam's approximation, to 1e-9). */
function deviate(p) {
  const tail = (q) => (((((-7.784894002430293e-3 * q - 0.3223964580411365) * q - 2.400758277161838) * q - 2.549732539343734) * q + 4.374664141464968) * q + 2.938163982698783)
    / ((((7.784695709041462e-3 * q + 0.3224671290700398) * q + 2.445134137142996) * q + 3.754408661907416) * q + 1);
  if (p < 0.02425) return tail(Math.sqrt(-2 * Math.log(p)));
  if (p > 1 - 0.02425) return -tail(Math.sqrt(-2 * Math.log(1 - p)));
  const q = p - 0.5, r = q * q;
  return ((((((-39.69683028665376 * r + 220.9460984245205) * r - 275.9285104469687) * r + 138.357751867269) * r - 30.66479806614716) * r + 2.506628277459239) * q)
    / (((((-54.47609879822406 * r + 161.5858368580409) * r - 155.6989798598866) * r + 66.80131188771972) * r - 13.28068155288572) * r + 1);
}

const TICKS = [1e-5, 1e-4, 1e-3, 0.01, 0.05, 0.2, 0.5];
const share = (rate) => `${Number((100 * rate).toPrecision(2))} %`;

const refused = (p) => `${share(p.fnmr)} (${share(p.low)} to ${share(p.high)})`;

/** How often the own people are refused against how often others match, both as normal deviates: a straight line if both
 *  scores are normal.  Below what so few people can show there is no value: "none". */
function tradeOff(d, W) {
  const H = Math.min(W, 420), left = 62, bottom = 44, top = 26, right = 18;
  const few = 3 / d.people, floor = few / 6;
  const from = d.points.at(-1).fmr, most = Math.min(0.9, Math.max(0.5, ...d.points.map((p) => p.high)));
  const place = (v, low, high) => (deviate(Math.min(Math.max(v, low), high)) - deviate(low)) / (deviate(high) - deviate(low));
  const x = (fmr) => left + place(fmr, from / 2, 0.5) * (W - left - right);
  const y = (fnmr) => H - bottom - place(fnmr, floor, most) * (H - top - bottom);
  const text = (at, up, what, anchor = "middle", kind = "") => svg("text", { x: at, y: up, "text-anchor": anchor, class: kind }, what);
  const out = svg("svg", { viewBox: `0 0 ${W} ${H}`, class: "chart", role: "img",
    "aria-label": `At the threshold in force ${share(d.own.fnmr)} of own comparisons do not match (95 % interval ${share(d.own.low)} to ${share(d.own.high)}). The table below has the curve.` });
  out.append(svg("rect", { x: left, y: y(few), width: W - left - right, height: H - bottom - y(few), class: "unknown" }));
  for (const t of TICKS) {
    if (t >= from / 2) out.append(svg("line", { x1: x(t), x2: x(t), y1: top, y2: H - bottom, class: "grid" }), text(x(t), H - bottom + 16, share(t)));
    if (t >= floor && t <= most) out.append(svg("line", { x1: left, x2: W - right, y1: y(t), y2: y(t), class: "grid" }), text(left - 8, y(t) + 4, share(t), "end"));
  }
  const band = [...d.points.map((p) => `${x(p.fmr)},${y(p.high)}`), ...d.points.toReversed().map((p) => `${x(p.fmr)},${y(p.low)}`)].join(" ");
  out.append(text(left - 8, H - bottom + 4, "none", "end"), text(left + (W - left - right) / 2, H - 6, "other people match", "middle", "strong"),
    text(left, 14, "own comparisons that do not match", "start", "strong"), svg("polygon", { points: band, class: "band" }),
    svg("polyline", { points: d.points.map((p) => `${x(p.fmr)},${y(p.fnmr)}`).join(" "), class: "curve" }));
  for (const [p, kind] of [[d.shipped, "other"], [d.own, "mark"]]) out.append(svg("circle", { cx: x(p.fmr), cy: y(p.fnmr), r: kind === "mark" ? 5.5 : 7, class: kind }));
  return out;
}

const SELECTED = "Templates of a person had to match to be enrolled, unless that was forced: scans at a door are refused more often.";

/** The error trade-off of the own scans, or why there is none. */
function own(d) {
  const title = el("h2", {}, "How often the right person is refused");
  if (!d) return el("section.card", {}, title, el("p.dim", {}, "The shipped model keeps no scores of one person's scans; ", el("code", {}, "surfacectl calibrate"),
    " measures this with scans of your own, of people with two templates or more."));
  if (!d.points.length) return el("section.card", {}, title, el("p", {}, `${d.people === 0 ? "None" : `Only ${count(d.people)}`} of the people who were compared ${d.people === 1 ? "has" : "have"} two templates or more; ${count(d.needed)} are needed. `,
    "Fewer show no rate below one in ten."), el("p.dim", {}, "Enroll a second sitting of more people, and calibrate again."));
  const row = (p, name = "") => el("tr", {}, el("th", { scope: "row" }, name + share(p.fmr)), [plain(p.score, 1), refused(p)].map((t) => el("td", {}, t)));
  return el("section.card", {}, title, drawn((width) => tradeOff(d, width)),
    el("p.states", {}, el("span.key.own", {}, `Threshold in force: ${refused(d.own)}`), el("span.key.ring", {}, `Shipped threshold: ${refused(d.shipped)}`),
      el("span.key.band", {}, "95 % interval, over people"), el("span.key.unknown", {}, `Below what ${count(d.people)} people can show`)),
    el("p.dim", {}, SELECTED),
    el("details", {}, el("summary", {}, "As a table"), el("table.trade", { "aria-label": "Error trade-off" },
      el("thead", {}, el("tr", {}, ["Other people match", "Score", "Refused, 95 % interval"].map((t) => el("th", { scope: "col" }, t)))),
      el("tbody", {}, row(d.own, "In force: "), row(d.shipped, "Shipped: "), d.points.map((p) => row(p))))));
}

/** The Monday of a day. */
function week(of) {
  const d = new Date(`${of}T00:00:00Z`);
  d.setUTCDate(d.getUTCDate() - ((d.getUTCDay() + 6) % 7));
  return d.toISOString().slice(0, 10);
}

/** Week by week {start, n, match, ..., bins: {match: [64], ...}}, newest first. */
function weeks(days) {
  const out = new Map();
  for (const d of days) {
    const start = week(d.day);
    if (!out.has(start)) out.set(start, { start, n: 0, ...Object.fromEntries(DECISIONS.map((k) => [k, 0])), bins: Object.fromEntries(DECISIONS.map((k) => [k, new Array(BINS).fill(0)])) });
    const w = out.get(start);
    if (!w.bins[d.decision]) continue;
    d.bins?.forEach((n, i) => (w.bins[d.decision][i] += n));
    w[d.decision] += d.n;
    w.n += d.n;
  }
  return [...out.values()].sort((a, b) => (a.start < b.start ? 1 : -1)).slice(0, WEEKS);
}

/** One row a week, of the same scales, so that a drift is a shift down the page. */
function history(all, threshold, W) {
  const left = 76, right = 44, row = 44, top = 22, H = top + all.length * row + 22;
  const x = (s) => left + ((s - LOW) / (STEP * BINS)) * (W - left - right), bar = x(LOW + STEP) - x(LOW);
  const out = svg("svg", { viewBox: `0 0 ${W} ${H}`, class: "chart", role: "img", "aria-label": "Scores of the last weeks; the table below has the same." });
  all.forEach((w, i) => {
    const base = top + (i + 1) * row - 4, sums = w.bins.match.map((_, b) => DECISIONS.reduce((n, k) => n + w.bins[k][b], 0));
    const most = Math.max(...sums, 1);
    out.append(svg("text", { x: left - 8, y: base - 10, "text-anchor": "end" }, w.start), svg("line", { x1: left, x2: W - right, y1: base, y2: base, class: "grid" }),
      svg("text", { x: W - right + 8, y: base - 10 }, count(w.n)));
    for (let b = 0; b < BINS; b++) {
      let up = base;
      for (const k of DECISIONS) {
        const h = ((row - 8) * Math.sqrt(sums[b] / most) * w.bins[k][b]) / Math.max(sums[b], 1);
        if (h > 0) out.append(svg("rect", { x: x(LOW + STEP * b) + 0.5, y: up - h, width: bar - 1, height: h, class: outcome(k).kind }));
        up -= h;
      }
    }
  });
  out.append(svg("line", { x1: x(threshold), x2: x(threshold), y1: top - 4, y2: H - 22, class: "limit" }),
    named(x(threshold), W, threshold),
    svg("text", { x: W - right + 8, y: 12 }, "scans"),
    ...[-40, 0, 40, 80].map((s) => svg("text", { x: x(s), y: H - 6, "text-anchor": "middle" }, plain(s, 0))));
  return out;
}

const asTable = (all) => el("table", {},
  el("thead", {}, el("tr", {}, ["Week from", ...DECISIONS.map((k) => outcome(k).title)].map((t) => el("th", { scope: "col" }, t)))),
  el("tbody", {}, all.map((w) => el("tr", {}, el("th", { scope: "row" }, w.start), DECISIONS.map((k) => el("td", {}, count(w[k])))))));

const legend = () => el("p.states", {}, DECISIONS.map((k) => el(`span.key.${outcome(k).kind}`, {}, outcome(k).title)));

export function openCalibration(body) {
  let done = false;
  const load = () => get("/v1/stats").then((s) => {
    if (done) return;
    const c = s.calibration, all = weeks(s.days);
    body.replaceChildren(el("div.try", {},
      el("div.stack", {},
        el("section.card", {}, el("h2", {}, "How many other people would match"), ...curve(c, s.days.some((d) => d.bins) && all)),
        own(c.det),
        el("section.card", {}, el("h2", {}, "Scores of the last weeks"),
          ...(s.days.some((d) => d.bins) ? [legend(), drawn((width) => history(all, c.threshold, width)), el("details", {}, el("summary", {}, "As a table"), asTable(all))]
            : all.length ? [el("p.dim", {}, "Scores are shown to a token with the scope score."), asTable(all)]
            : [el("p.dim", {}, "No verification so far. A histogram a day is kept, of the scores alone: it names nobody.")]))),
      el("div.side", {},
        el("section.card", {}, el("h2", {}, "In force"), el("dl.facts", {}, pairs([
          ["Threshold", plain(c.threshold, 1)], c.low !== null && ["95 % interval", interval(c)], ["Other people match", oneIn(shareAbove(c.knots, c.threshold), c.knots.at(-1).rate).replace(/^about /, "")], ["From", c.source === "shipped" ? "the model, as shipped" : "scans of your own"],
          c.made_at && ["Made", day(c.made_at)]])),
          el("p.dim", {}, "A score at or above the threshold is a match."), c.low !== null && learned(c)),
        el("section.card", {}, el("h2", {}, "Does it still fit?"),
          el("p", {}, "The green hill should stay well to the right of the threshold, week after week. If it moves to the left, ",
            "scanners or people have changed: look at the quality of new scans, and calibrate anew with scans of your own."),
          el("p.dim", {}, el("code", {}, "surfacectl calibrate"), " does that.")))));
  }, (e) => !done && body.replaceChildren(failed(e, load)));
  load();
  return () => {
    done = true;
  };
}
