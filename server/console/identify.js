// identify.js -- who is it, of all who may be found?

import { query, request } from "./api.js";
import { createBurst } from "./burst.js";
import { count, el, icon, oneIn, plain, say } from "./dom.js";
import { facts, gauge, UNTOLD, verdict, VERDICTS } from "./verdict.js";
import { failed, field, personAt, table, VERBATIM } from "./widgets.js";

const AT_ONCE = 10; // files, by the API

const people = (n) => `${count(n)} ${n === 1 ? "person" : "people"}`;

/** What was decided, and of how many, in a sentence. */
function explain(r) {
  if (r.searched === 0) return "There is nobody to search.";
  if (r.decision === "inconclusive") {
    if (r.skipped > 0 && r.score < r.threshold)
      return `Among ${people(r.searched)} nobody is alike enough, but ${count(r.skipped)} stored scans could not be searched: it may be one of those.`;
    if (r.threshold === null) return `Among ${people(r.searched)} no evidence is enough: search a smaller group, or calibrate on this database.`;
    return `Among ${people(r.searched)} such a scan could not show who it is: take a better one, or several, or search a smaller group.`;
  }
  if (r.score === undefined) return `${people(r.searched)} searched. ${UNTOLD}`;
  if (r.decision === "match")
    return `The evidence is ${plain(r.score, 1)}, and among ${people(r.searched)} ${plain(r.threshold, 1)} is enough.`;
  return `The evidence for the most alike is ${plain(r.score, 1)}, and among ${people(r.searched)} ${plain(r.threshold, 1)} would be needed.`;
}

function chance(r) {
  if (r.fpir_at_score == null || r.decision !== "match") return null;
  return el("p.dim", {}, `Of strangers ${oneIn(r.fpir_at_score)} would find somebody this much alike${r.extrapolated ? ", by extrapolation" : ""}.`);
}

function candidates(all) {
  const list = table("Candidates", [
    ["Person", (c) => el("a", { href: personAt(c.subject) }, c.subject), "name"],
    ["Evidence", (c) => plain(c.score, 1), "number"],
    ["Other people who score as high, at most", (c) => oneIn(c.fmr_at_score).replace("about ", ""), "dim"],
  ]);
  list.set(all);
  return el("section.stack", {}, el("h2", {}, "To be reviewed by a person"),
    el("p.dim", {}, "The most alike, whether it is one of them or not. This is no decision: most of them are other people."), list.element);
}

export function open(main, who) {
  const reads = who.scopes.includes("read");
  const burst = createBurst({ most: AT_ONCE, verifying: true, changed: run });
  const group = el("input", { type: "text", maxLength: 64, pattern: "[a-z0-9._\\-]{1,64}", list: "groups", placeholder: "everybody", ...VERBATIM, onchange: run });
  const most = el("input", { type: "number", min: 0, max: 50, value: 0, onchange: run });
  const said = el("div.stack");
  let running = null;

  function show(r) {
    const v = VERDICTS[r.decision];
    const title = r.decision === "match" ? r.subject : r.decision === "no_match" ? "Nobody who was searched" : v.title;
    said.replaceChildren(...[
      verdict(v.kind, v.icon, title, el("p", {}, explain(r)), r.score != null && r.threshold !== null && gauge(r), chance(r),
        r.decision === "match" && reads && el("p", {}, el("a", { href: personAt(r.subject) }, `Open ${r.subject}`))),
      burst.gains(r),
      r.candidates?.length > 0 && candidates(r.candidates),
      facts([["Points on the face", count(r.scan.points_used)], ["Quality of the scan", r.quality.score.toFixed(2)],
        r.skipped > 0 && ["Stored scans not searched", count(r.skipped)],
        r.timing_ms.total != null && ["Time on the server", `${r.timing_ms.total.toFixed(0)} ms`]])].filter(Boolean));
    burst.label(r.scan, r.quality.score);
    say(`${title}. ${explain(r)}`);
  }

  async function run() {
    running?.abort();
    if (!burst.files.length) return said.replaceChildren();
    if (!group.reportValidity() || !most.reportValidity()) return;
    const own = (running = new AbortController());
    main.classList.add("busy");
    try {
      if (!await burst.check(own.signal) || own.signal.aborted) return;
      const r = await request("POST", `/v1/identify${query({ group: group.value, candidates: most.value > 0 ? most.value : "", ...burst.values })}`, { body: burst.body, stop: own.signal });
      burst.became(r);
      show(r);
    } catch (e) {
      if (e.name === "AbortError") return;
      burst.became(e, true);
      said.replaceChildren(failed(e, run));
    } finally {
      if (own === running) main.classList.remove("busy");
    }
  }

  main.replaceChildren(
    el("header", {}, el("h1", {}, "Identify"), el("span.dim.note", {}, "Each search is recorded.")),
    el("div.stack.column", {}, ...burst.parts,
      el("div.row.wrap", {},
        field("Group", group, "Only these people are searched"),
        reads && field("Candidates", most, "List so many, for a person to review"),
        el("datalist", { id: "groups" }, (who.groups ?? []).map((g) => el("option", { value: g })))),
      said));
  said.replaceChildren(el("section.card.welcome", {},
    el("h2", {}, "Who is it?"),
    el("p", {}, "Drop a scan, or several of one person, to search everybody who is enrolled, or a group. ",
      "The more people are searched, the more evidence a name needs. Without it the answer is that nobody can tell."),
    el("p.dim", {}, "People who have opted out, are disabled or have expired are not searched. A score is no proof of who somebody is.")));
  return () => running?.abort();
}
