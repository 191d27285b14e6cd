// health.js -- is all well: how much is done and how fast, what is refused, what to mend.  The quality of scans,
// tokens and calibration are tabs of it.

import { get, repeat } from "./api.js";
import { openCalibration } from "./calibration.js";
import { count, drawn, el, icon, many, plain, refill, span, svg } from "./dom.js";
import { openScans } from "./scans.js";
import { openTokens } from "./tokens.js";
import { choices, failed, waiting } from "./widgets.js";
import { WHY, outcome } from "./words.js";

/** Name, title, and the scope that it takes. */
const TABS = [["", "Now", "audit"], ["scans", "Scans", "audit"], ["tokens", "Tokens", "tokens"], ["calibration", "Calibration", "audit"]], EVERY_MS = 5000;
const at = (tab) => (tab ? `#health?tab=${tab}` : "#health");

export function open(main, who, asked) {
  const tabs = TABS.filter(([, , scope]) => who.scopes.includes(scope));
  const tab = tabs.some(([name]) => name === asked.get("tab")) ? asked.get("tab") : tabs[0][0];
  const body = el("div.stack"), actions = el("div.row");
  main.replaceChildren(el("header", {}, el("h1", {}, "Health"), actions),
    el("div.stack", {}, choices("Health", tabs, tab, at), body));
  body.append(waiting());
  return { "": openNow, scans: openScans, tokens: openTokens, calibration: openCalibration }[tab](body, who, actions, asked);
}

const tile = (value, title, note) => el("section.card.tile", {}, el("h2", {}, title), el("p.figure", {}, value), el("p.dim", {}, note));

const FOUND = { ok: ["yes", "ok"], warning: ["warning", "unsure"], error: ["no", "no"] };

/** Longest first; the bars are shares of the longest. */
function bars(rows) {
  const most = Math.max(...rows.map(([, n]) => n), 1);
  return el("ul.bars", {}, rows.sort((a, b) => b[1] - a[1]).map(([title, n, kind]) => {
    const bar = el(`i${kind ? `.${kind}` : ""}`);
    bar.style.width = `${(100 * n) / most}%`;
    return el("li", {}, el("span", {}, title), el("span.value", {}, count(n)), el("span.track", { "aria-hidden": "true" }, bar));
  }));
}

const DAYS = 28, DECISIONS = ["match", "inconclusive", "no_match"];

/** How many a day, the last four weeks. */
function daily(days, W) {
  const H = 150, bottom = 20, left = 40, today = Date.now();
  const all = Array.from({ length: DAYS }, (_, i) => new Date(today - (DAYS - 1 - i) * 86400e3).toISOString().slice(0, 10))
    .map((day) => [day, DECISIONS.map((k) => days.filter((d) => d.day === day && d.decision === k).reduce((n, d) => n + d.n, 0))]);
  const most = Math.max(...all.map(([, n]) => n[0] + n[1] + n[2]), 1), step = (W - left) / DAYS, y = (n) => (H - bottom - 8) * (n / most);
  const out = svg("svg", { viewBox: `0 0 ${W} ${H}`, class: "chart", role: "img", "aria-label": `Verifications a day, ${all[0][0]} to ${all.at(-1)[0]}: ${count(most)} at most` },
    svg("line", { x1: left, x2: W, y1: H - bottom, y2: H - bottom, class: "grid" }), svg("line", { x1: left, x2: W, y1: 8, y2: 8, class: "grid" }),
    svg("text", { x: left - 8, y: 12, "text-anchor": "end" }, count(most)), svg("text", { x: left - 8, y: H - bottom, "text-anchor": "end" }, "0"));
  all.forEach(([day, n], i) => {
    let up = H - bottom;
    n.forEach((k, j) => {
      if (k) out.append(svg("rect", { x: left + i * step + 2, y: up - y(k), width: step - 4, height: y(k), class: outcome(DECISIONS[j]).kind }));
      up -= y(k);
    });
    if ((DAYS - 1 - i) % 7 === 0) out.append(svg("text", { x: left + (i + 0.5) * step, y: H - 4, "text-anchor": i === DAYS - 1 ? "end" : "middle" }, day.slice(5)));
  });
  return out;
}

function openNow(body, who, actions) {
  let before = null;

  function show(s) {
    const { rates, latency_ms: ms, counts } = s;
    // The rate of the last seconds; at first that since the start.
    const [n, seconds] = before ? [rates.verifications - before.n, (Date.now() - before.at) / 1000] : [rates.verifications, s.uptime_s];
    const order = ["error", "warning", "ok"], bad = s.findings.filter((f) => f.severity !== "ok").length;
    refill(body,
      el("div.tiles", {},
        tile(count(rates.verifications), "Decisions since the start", `${plain((60 * n) / Math.max(seconds, 1), 1)} a minute ${before ? "now" : "on average"}`),
        tile(ms.p50 == null ? "–" : `${plain(ms.p50, 0)} ms`, "Half are faster than", ms.p95 == null ? "none so far" : `95 of 100 faster than ${plain(ms.p95, 0)} ms`),
        tile(count(counts.subjects), "People", many(counts.templates, "template")),
        tile(span(s.uptime_s), "Running", `${count(s.queue.waiting)} waiting`)),
      el("div.try", {},
        el("div.stack", {}, el("section.card", {}, el("h2", {}, "Verifications a day"), drawn((width) => daily(s.days, width))),
          el("section.card", {}, el("h2", {}, bad ? "To be mended" : "All is well"),
          el("ul.findings", {}, [...s.findings].sort((a, b) => order.indexOf(a.severity) - order.indexOf(b.severity)).map((f) => {
            const [name, kind] = FOUND[f.severity];
            return el(`li.${kind}`, {}, icon(name, 18), el("div", {}, el("span.sr", {}, `${f.severity}: `), el("p", {}, el("strong", {}, `${f.about}: `), f.what), f.do && el("p.dim", {}, f.do)));
          })))),
        el("div.side", {},
          el("section.card", {}, el("h2", {}, "Verifications and comparisons since the start"),
            rates.verifications ? bars(["match", "no_match", "inconclusive"].map((d) => [outcome(d).title, rates.decisions[d], outcome(d).kind])) : el("p.dim", {}, "None so far.")),
          el("section.card", {}, el("h2", {}, "Refused since the start"),
            Object.keys(rates.refusals).length ? bars(Object.entries(rates.refusals).map(([code, k]) => [WHY[code] ?? code, k])) : el("p.dim", {}, "Nothing so far.")),
          el("section.card", {}, el("h2", {}, "Versions"), el("p.dim", {}, s.engine)))));
    before ??= { n: rates.verifications, at: Date.now() };
  }

  const load = () => get("/v1/stats").then(show, (e) => body.replaceChildren(failed(e, load)));
  return repeat(EVERY_MS, load);
}
