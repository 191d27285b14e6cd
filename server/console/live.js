// live.js -- for whoever stands beside a door: the last decision large, those before it, why somebody
// was refused, and an end to a lock-out.

import { get, repeat, request } from "./api.js";
import { el, icon, percent, plain, time } from "./dom.js";
import { gauge, UNTOLD } from "./verdict.js";
import { personAt, state, table } from "./widgets.js";
import { outcome, WHY } from "./words.js";

const SHOWN = 31, EVERY_MS = 2000;

/** Why, in one sentence. */
function why(e) {
  if (e.outcome === "refused") return WHY[e.code] ?? e.detail ?? e.code;
  if (e.kind === "identify" && e.outcome === "inconclusive") return "The scan, or the number of people, allows no decision: scan again.";
  if (e.score === null) return e.kind === "enroll" ? "A template was made of the scan." : UNTOLD;
  if (e.outcome === "match") return `The shape speaks for them: ${plain(e.score, 1)}, and ${plain(e.threshold, 1)} is enough.`;
  if (e.kind === "identify" && e.outcome === "no_match") return `Nobody is alike enough: ${plain(e.score, 1)} at most; ${plain(e.threshold, 1)} would be needed.`;
  if (e.outcome === "no_match") return `The shape speaks against them: ${plain(e.score, 1)}; ${plain(e.threshold, 1)} would be needed.`;
  return `Only ${percent(e.overlap)} of the face could be compared: scan again.`;
}

export function open(main, who) {
  const last = el("div", { "aria-live": "polite" });
  const note = el("span.dim.note", {}, "The last 1,000 are kept in the daemon's memory, until it ends.");
  const list = table("Those before", [
    ["Who", (e) => (e.subject && who.scopes.includes("read") ? el("a", { href: personAt(e.subject) }, e.subject) : e.subject ?? "–"), "name"],
    ["What", (e) => state(outcome(e.outcome))],
    ["Why", (e) => el("span", { title: e.detail ?? "" }, why(e)), "why"],
    ["By", (e) => e.token ?? "–", "dim"],
    ["Time (UTC)", (e) => time(e.at), "dim"],
  ]);
  let entries = [], after = 0, failed = false, knots = null;

  async function reset(e, button) {
    button.disabled = true;
    try {
      await request("DELETE", `/v1/subjects/${encodeURIComponent(e.subject)}/attempts`);
      button.replaceWith(el("span.dim", {}, "The lock-out has ended."));
    } catch (refusal) {
      button.replaceWith(el("span.error", {}, refusal.message));
    }
  }

  /** The way out of a refusal, if a click has one. */
  function remedy(e) {
    if (e.code !== "too_many_attempts" || !who.scopes.includes("manage")) return null;
    const button = el("button", { type: "button", onclick: () => reset(e, button) }, "End the lock-out");
    return button;
  }

  function show() {
    if (!entries.length)
      return void last.replaceChildren(el("section.card", {}, el("h2", {}, "Nobody yet"),
        el("p.dim", {}, "The next verification or enrolment appears here by itself.")));
    const e = entries.at(-1), s = outcome(e.outcome);
    last.replaceChildren(el(`section.card.verdict.live.${s.kind}`, {},
      el("div", {}, el("h2", {}, icon(s.icon, 40), s.title),
        el("p.big", {}, e.subject ?? "unknown"),
        el("p", {}, why(e)),
        remedy(e),
        el("p.dim", {}, [time(e.at), e.token && `by ${e.token}`, `request ${e.request_id}`].filter(Boolean).join(" · "))),
      e.score !== null && e.threshold !== null && gauge(e, knots)));
    list.set(entries.slice(0, -1).reverse());
    list.element.hidden = entries.length < 2;
  }

  async function poll() {
    try {
      const { recent, last: newest } = await get(`/v1/recent?limit=${SHOWN}${after ? `&after=${after}` : ""}`);
      if (newest < after) { // the daemon was started anew, and counts from 1
        after = 0;
        entries = [];
      }
      if (recent.length || !after || failed) {
        entries = [...entries, ...recent].slice(-SHOWN);
        after = entries.at(-1)?.seq ?? 0;
        failed = false;
        show();
      }
    } catch (refusal) {
      failed = true;
      last.replaceChildren(el("section.card.verdict.unsure", {}, el("h2", {}, icon("warning", 26), "No connection"),
        el("p", {}, refusal.message)));
    }
  }

  list.element.hidden = true;
  main.replaceChildren(el("header", {}, el("h1", {}, "Live"), note), el("div.stack", {}, last, list.element));
  get("/v1/stats").then(({ calibration }) => (knots = calibration.knots) && show(), () => {});
  return repeat(EVERY_MS, poll);
}
