// try.js -- two scans compared, or one looked at.  Nothing is stored.

import { query, request, url } from "./api.js";
import { camera } from "./camera.js";
import { el, icon, save, say, time } from "./dom.js";
import { readSeen } from "./glb.js";
import { copies, createReport, requestId, scanInWords } from "./report.js";
import { createSlot } from "./slot.js";
import { createStage } from "./stage.js";
import { compared, facts, found, pairs, qualityOf } from "./verdict.js";
import { failed } from "./widgets.js";

const SAMPLES = [
  ["The same person, twice", "one.ply", "one_again.ply"],
  ["Two people", "one.ply", "other.ply"],
  ["The same person, turned away", "one.ply", "one_turned.ply"],
  ["One scan, with advice", "one_turned.ply"],
];

const details = (title, ...rest) => el("details.card", {}, el("summary", {}, title), ...rest);

function timing(t) {
  const names = { parse: "reading", prepare: "finding the face", score: "score", align: "alignment", minimal: "minimal disparity" };
  return details(`Time: ${t.total.toFixed(0)} ms on the server`,
    el("dl.facts", {}, pairs(Object.entries(names).map(([k, name]) => t[k] != null && [name, `${t[k].toFixed(1)} ms`]))));
}

/** The same request as a command; a name from outside is quoted for the shell. */
function curl(path, ...parts) {
  const quoted = (text) => `'${text.replace(/'/g, "'\\''")}'`;
  const line = ["curl -H \"Authorization: Bearer $TOKEN\"", ...parts.map(([flag, value]) => `${flag} ${quoted(value)}`),
    quoted(url(path))].join(" \\\n  ");
  return details("The same with curl", el("pre", { tabIndex: 0 }, line));
}

export function open(main, who) {
  const verifies = who.scopes.includes("verify");
  const slots = ["A", "B"].map((letter) => createSlot(letter, run, 1, both));
  const stage = createStage(), report = createReport(stage, () => shown);
  const side = el("div.side"), lens = camera(run);
  const title = el("h1", {}, "Compare two scans");
  const saveButton = el("button", { type: "button", disabled: true, onclick: () => save("surfaces.glb", [file], "model/gltf-binary") },
    icon("save"), "Save 3D file");
  const swapButton = el("button.quiet.swap", { type: "button", title: "Swap A and B", "aria-label": "Swap A and B", onclick: swap }, icon("swap"));
  let file = null, running = null, shown = null; // what the report has

  function swap() {
    [slots[0].file, slots[1].file] = [slots[1].file, slots[0].file];
    slots.forEach((s) => s.label());
    run();
  }

  async function sample(names) {
    both(await Promise.all(names.map(async (n) => new File([await (await fetch(url(`/console/${n}`))).arrayBuffer()], n))));
  }

  function both(files) {
    slots.forEach((s, i) => {
      s.input.value = s.wrong.textContent = "";
      s.file = files[i] ?? null;
      s.label();
    });
    run();
  }

  function show(response, layered) {
    const { extras, nodes } = readSeen(response);
    if (!nodes) {
      clear();
      return extras;
    }
    file = response;
    saveButton.disabled = false;
    report.ready(true);
    stage.show(nodes, layered);
    return extras;
  }

  function clear(...cards) {
    file = null;
    saveButton.disabled = true;
    shown = null;
    report.ready(false);
    stage.clear();
    side.replaceChildren(...cards.filter(Boolean));
  }

  async function ask(path, body, stop) {
    const id = requestId();
    const response = await request("POST", `${path}${query({ detail: "surface", ...lens.values })}`, { body, binary: true, stop, headers: { "X-Request-Id": id } });
    return { response, id };
  }

  /** Fills the side, and the report. */
  function tell(title, sides, { cards, known }, id, ...more) {
    side.replaceChildren(...[...cards, facts(known), ...more].filter(Boolean));
    say(cards[0].textContent);
    shown = { title, sides, at: `${time(new Date().toISOString())} UTC`, cards: copies(cards), facts: [...known, ["Request", id], ["Token", who.name]] };
  }

  async function check(s, stop) {
    const { response, id } = await ask("/v1/check", s.file, stop);
    const r = show(response, false);
    s.label(r.scan, qualityOf(r));
    tell("What was found in a scan", [["", s.file.name, scanInWords(r.scan, qualityOf(r))]],
      found(r, verifies && el("p.dim", {}, "Drop a second scan to compare them.")), id,
      timing(r.timing_ms), curl("/v1/check", ["--data-binary", `@${s.file.name}`]));
  }

  async function compare(stop) {
    const body = new FormData();
    body.append("a", slots[0].file, slots[0].file.name);
    body.append("b", slots[1].file, slots[1].file.name);
    const { response, id } = await ask("/v1/compare", body, stop);
    const r = show(response, true);
    slots.forEach((s, i) => s.label(r.scan["ab"[i]], r.quality["ab"[i]]?.score));
    tell("Two scans compared", slots.map((s, i) => ["AB"[i], s.file.name, scanInWords(r.scan["ab"[i]], r.quality["ab"[i]]?.score)]),
      compared(r), id, timing(r.timing_ms),
      curl("/v1/compare", ["-F", `a=@${slots[0].file.name}`], ["-F", `b=@${slots[1].file.name}`]));
  }

  async function run() {
    running?.abort();
    const own = (running = new AbortController());
    const given = slots.filter((s) => s.file);
    if (!await lens.ready(given.map((s) => s.file))) return clear();
    main.classList.toggle("busy", given.length > 0);
    try {
      if (given.length === 2 && verifies) await compare(own.signal);
      else if (given.length) await check(given.at(-1), own.signal);
      else welcome();
    } catch (e) {
      if (e.name === "AbortError") return;
      clear(failed(e, run));
    } finally {
      if (own === running) main.classList.remove("busy");
    }
  }

  function welcome() {
    clear(el("section.card.welcome", {},
      el("h2", {}, "Where do two scans differ, and what decides?"),
      el("p", {}, "Drop one scan to see the face that is found in it and whether it is good to enroll; drop two to compare them. ",
        "PLY, OBJ, STL, PCD, GLB, text and depth images are read. Nothing is stored."),
      verifies && el("p", {}, "No scan at hand? These people are invented:"),
      verifies && el("div.samples", {}, SAMPLES.map(([name, ...names]) =>
        el("button", { type: "button", onclick: () => sample(names) }, name))),
      el("p.dim", {}, "A score is no proof of who somebody is.")));
  }

  main.replaceChildren(
    el("header", {}, title, el("span.dim.note", {}, "Nothing is stored."), report.buttons, saveButton),
    el("div.slots", {}, slots[0].box, swapButton, slots[1].box), ...slots.map((s) => s.wrong), lens.element,
    el("div.try", {}, stage.element, side));
  welcome();
  return () => {
    running?.abort();
    report.close();
    stage.close();
  };
}
