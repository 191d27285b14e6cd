// live.js -- for whoever stands beside a door: the last decision large, those before it, why somebody
// was refused, and an end to a lock-out.

import { get, request } from "./api.js";
import { el, icon, percent, plain, time } from "./dom.js";
import { gauge, VERDICTS } from "./verdict.js";

const SHOWN = 31, EVERY_MS = 2000;

/** What a refusal means at the door; others are in the daemon's words. */
const WHY = {
  too_many_attempts: "Locked out: too many verifications failed.",
  too_many_subjects: "This token has tried too many people without a match.",
  subject_disabled: "This person is disabled: nobody is verified as them until somebody enables them.",
  subject_expired: "This person's time is over.",
  not_found: "Nobody is enrolled under this id.",
  no_face: "No face was found in the scan.",
  several_faces: "There was more than one face before the scanner.",
  low_quality: "The scan is too poor: scan again.",
  replayed: "This is a scan that was used before: scan again.",
  mirrored: "The scanner swaps left and right.",
  sample_mismatch: "The new scan does not fit the person's first one.",
};

const STATES = {
  ...VERDICTS,
  enrolled: { icon: "yes", kind: "ok", title: "Enrolled" },
  known: { icon: "yes", kind: "ok", title: "Known already" },
  refused: { icon: "warning", kind: "unsure", title: "Refused" },
};

const state = (e) => STATES[e.outcome] ?? STATES.refused;

/** Why, in one sentence. */
function why(e) {
  if (e.outcome === "refused") return WHY[e.code] ?? e.detail ?? e.code;
  if (e.score === null) return e.kind === "enroll" ? "A template was made of the scan." : "";
  if (e.outcome === "match") return `The shape speaks for them: ${plain(e.score, 1)}, and ${plain(e.threshold, 1)} is enough.`;
  if (e.outcome === "no_match") return `The shape speaks against them: ${plain(e.score, 1)}; ${plain(e.threshold, 1)} would be needed.`;
  return `Only ${percent(e.overlap)} of the face could be compared: scan again.`;
}

export function open(main, who) {
  const last = el("div", { "aria-live": "polite" });
  const rows = el("tbody");
  const note = el("span.dim.note", {}, "The last 1,000 are kept in the daemon's memory, until it ends.");
  const list = el("div.card.table", {}, el("table", {},
    el("thead", {}, el("tr", {}, ["Time (UTC)", "Who", "What", "Why", "By"].map((t) => el("th", { scope: "col" }, t)))), rows));
  let entries = [], after = 0, timer = 0, done = false, failed = false;

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
    const e = entries.at(-1), s = state(e);
    last.replaceChildren(el(`section.card.verdict.live.${s.kind}`, {},
      el("h2", {}, icon(s.icon, 32), s.title),
      el("p.big", {}, e.subject ?? "unknown"),
      el("p", {}, why(e)),
      e.score !== null && gauge(e),
      remedy(e),
      el("p.dim", {}, [time(e.at), e.token && `by ${e.token}`, `request ${e.request_id}`].filter(Boolean).join(" · "))));
    rows.replaceChildren(...entries.slice(0, -1).reverse().map((x) => el("tr", {},
      el("td.dim", {}, time(x.at)), el("td", {}, el("strong", {}, x.subject ?? "–")),
      el("td", {}, el(`span.state.${state(x).kind}`, {}, icon(state(x).icon, 14), state(x).title)),
      el("td.why", { title: x.detail ?? "" }, why(x)), el("td.dim", {}, x.token ?? "–"))));
    list.hidden = entries.length < 2;
  }

  async function poll() {
    try {
      const { recent, last: newest } = await get(`/v1/recent?limit=${SHOWN}${after ? `&after=${after}` : ""}`);
      if (done) return;
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
      if (done) return;
      failed = true;
      last.replaceChildren(el("section.card.verdict.unsure", {}, el("h2", {}, icon("warning", 26), "No connection"),
        el("p", {}, refusal.message)));
    }
    timer = setTimeout(poll, EVERY_MS);
  }

  list.hidden = true;
  main.replaceChildren(el("header", {}, el("h1", {}, "Live"), note), el("div.stack", {}, last, list));
  poll();
  return () => {
    done = true;
    clearTimeout(timer);
  };
}
