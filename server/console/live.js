// live.js -- what happens at the doors: the last decision large, those before it, who is locked out.  With
// ?door=NAME it fills the screen and shows what one token asks for; with an empty name, what all do.

import { follow, request } from "./api.js";
import { el, icon, moment, refill, say, time, when } from "./dom.js";
import { ask, personAt, state, table, waiting } from "./widgets.js";
import { outcome, REASONS, WHY } from "./words.js";

const SHOWN = 31, BEFORE = 100, TICK_MS = 10e3, SHOW_MS = 50;

/** What is shown large: what a person at a door waits for; and what else belongs to a door. */
const LARGE = ["verify", "identify", "enroll", "enroll_mismatch", "refused"];
const DOORS = [...LARGE, "locked_out", "attempts_reset", "many_subjects", "attempts_pattern"];

/** Two notes: up for a match or an enrolment, down for anything else. */
function sound(up) {
  const to = sound.to ??= new AudioContext();
  [up ? 660 : 330, up ? 880 : 220].forEach((pitch, i) => {
    const note = new OscillatorNode(to, { frequency: pitch }), loud = new GainNode(to, { gain: 0.2 });
    note.connect(loud).connect(to.destination);
    note.start(to.currentTime + 0.16 * i);
    note.stop(to.currentTime + 0.16 * i + 0.14);
  });
}

export function open(main, who, asked) {
  const may = (scope) => who.scopes.includes(scope);
  const filling = asked.has("door"), card = el("div"), strip = el("div"), lost = el("p.advice", { role: "status", hidden: true });
  const door = asked.get("door") ?? "", locked = new Map(), names = new Set(door ? [door] : []);
  let entries = [], timer = 0, since = null, loud = false, lit = null;

  /** Why, in one sentence. */
  function why(e) {
    return REASONS[`${e.type} ${e.outcome}`] ?? REASONS[e.type] ?? WHY[e.outcome] ?? e.outcome;
  }

  // ---- lock-outs: until their end, or somebody's

  function keep(e) {
    if (e.type === "locked_out" && e.subject) locked.set(e.subject, e);
    if (e.type === "attempts_reset") locked.delete(e.subject);
  }

  function lockouts() {
    for (const [subject, e] of locked) if (!(Date.parse(e.until) > Date.now())) locked.delete(subject);
    refill(strip, ...(locked.size === 0 ? [] : [el("section.card", {}, el("h2", {}, "Locked out"),
      el("ul.lockouts", {}, [...locked.values()].map((e) => el("li", {}, icon("lock"), el("strong", {}, e.subject),
        el("span.dim", {}, "until ", el("time", { dateTime: e.until }, moment(e.until))),
        may("manage") && el("button", { type: "button", "aria-label": `End the lock-out of ${e.subject}`, onclick: () => endOf(e.subject) }, "End")))))]));
  }

  const endOf = (subject) => ask(`End the lock-out of ${subject}?`, "They can be verified again at once. Do it if you know them, or if the scanner failed them.", "End it", async () => {
    await request("DELETE", `/v1/subjects/${encodeURIComponent(subject)}/attempts`);
    locked.delete(subject);
    show();
  });

  // ---- what is shown

  const list = filling ? null : table("Those before", [
    ["Who", (e) => (e.subject && may("read") ? el("a", { href: personAt(e.subject) }, e.subject) : e.subject ?? "–"), "name"],
    ["What", (e) => state(outcome(e))],
    ["Why", why, "why"],
    ["By", (e) => e.token ?? "–", "dim"],
    ["Time (UTC)", (e) => el("time", { dateTime: e.at, title: moment(e.at) }, time(e.at)), "dim"],
  ]);

  function large(e) {
    const s = outcome(e), until = locked.get(e.subject)?.until;
    return el(`section.card.verdict.live.${s.kind}`, {},
      el("h2", {}, icon(s.icon, 48), s.title),
      el("p.big", {}, e.subject ?? (e.type === "identify" ? "Nobody" : "Unknown")),
      el("p.reason", {}, why(e), until && e.outcome !== "too_many_attempts" && " Locked out: too many failed.", until && ` Until ${moment(until)}.`),
      el("p.dim", {}, moment(e.at), e.token && ` · ${e.token}`, " · ", when(e.at)));
  }

  function show() {
    timer = 0;
    lockouts();
    const last = entries.findLast((e) => LARGE.includes(e.type));
    card.replaceChildren(last ? large(last) : el("section.card.live", {}, el("h2", {}, "Nobody yet"),
      el("p.dim", {}, "The next verification or enrolment appears here by itself.")));
    list?.set(entries.filter((e) => e !== last).reverse());
    if (list) list.element.hidden = entries.length < 2;
    if (select.childElementCount !== names.size + 1)
      select.replaceChildren(...["", ...[...names].sort()].map((name) => el("option", { value: name, selected: name === door }, name || "All doors")));
  }

  function tell(e, fresh) {
    if (!DOORS.includes(e.type)) return;
    keep(e);
    if (e.token) names.add(e.token);
    timer ||= setTimeout(show, SHOW_MS); // many at once are drawn once
    if ((door && e.token !== door) || entries.some((x) => x.cursor === e.cursor)) return;
    entries = [...entries, e].slice(-SHOWN);
    if (!fresh || !LARGE.includes(e.type)) return;
    say(`${e.subject ?? "Unknown"}: ${outcome(e).title}. ${why(e)}`);
    if (loud) sound(outcome(e).kind === "ok");
  }

  /** problem: why the daemon sends nothing; null: it does. */
  function changed(problem) {
    since = problem ? since ?? new Date().toISOString() : null;
    main.classList.toggle("offline", problem !== null);
    lost.hidden = problem === null;
    if (problem) refill(lost, icon("warning", 18), el("span", {}, `No connection since ${moment(since)}: ${problem.message}. What is shown may be old. It is tried again by itself.`));
    if (!entries.length && !problem) show();
  }

  // ---- what can be chosen

  const select = el("select", { "aria-label": "Door", onchange: () => (location.hash = `live?door=${encodeURIComponent(select.value)}`) });
  const bell = el("button", { type: "button", "aria-pressed": "false", onclick: () => {
    loud = !loud;
    bell.setAttribute("aria-pressed", loud);
    bell.replaceChildren(loud ? "Sound is on" : "Sound is off");
    if (loud) sound(true);
  } }, "Sound is off");
  const full = el("button", { type: "button", onclick: async () => {
    if (document.fullscreenElement) return document.exitFullscreen();
    await document.documentElement.requestFullscreen().catch(() => {});
    lit ??= await navigator.wakeLock?.request("screen").catch(() => null); // the screen does not go dark
  } }, "Full screen");

  main.replaceChildren(
    el("header", {}, el("h1", {}, door || (filling ? "All doors" : "Live")), filling && select, bell,
      filling ? [full, el("a", { href: "#live" }, "Live")] : el("a", { href: "#live?door=" }, "Door screen")),
    lost, el("div.stack", {}, card, strip, list?.element));
  if (list) list.element.hidden = true;
  card.append(waiting());
  const stop = follow({ last: BEFORE, tell, state: changed }), tick = setInterval(show, TICK_MS);
  return () => {
    stop();
    clearInterval(tick);
    clearTimeout(timer);
    main.classList.remove("offline");
    lit?.release();
  };
}
