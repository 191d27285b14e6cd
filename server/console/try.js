// try.js -- two scans compared, or one looked at.  Nothing is stored.

import { request, url } from "./api.js";
import { count, el, icon, mm, oneIn, percent, plain, save, signed } from "./dom.js";
import { readGlb } from "./glb.js";
import { createStage } from "./stage.js";
import { gauge, VERDICTS } from "./verdict.js";

const SAMPLES = [
  ["The same person, twice", "one.ply", "one-again.ply"],
  ["Two people", "one.ply", "other.ply"],
  ["The same person, with glasses", "one.ply", "one-glasses.ply"],
];

const REGIONS = ["nose", "eyes", "forehead", "cheeks", "mouth", "chin"];

/** What was decided, in a sentence. */
function explain(r) {
  const apart = `On average the two surfaces lie ${mm(r.disparity_mm)} apart.`;
  if (r.decision === "match")
    return `The shape speaks for one person: the evidence is ${plain(r.score, 1)}, and ${plain(r.threshold, 1)} is enough. ${apart}`;
  if (r.decision === "no_match")
    return `The shape speaks against one person: the evidence is ${plain(r.score, 1)}, and ${plain(r.threshold, 1)} would be needed. ${apart}`;
  return `The two scans have ${percent(r.overlap)} of the face in common: too little, or too noisy, to say whether it is the same.`;
}

/** What each region adds to the score: to the right for, to the left against one person. */
function regions(of) {
  const most = Math.max(1, ...Object.values(of).map(Math.abs));
  return el("section.card", {}, el("h2", {}, "What each region adds to the score"),
    el("ul.regions", {}, REGIONS.filter((r) => r in of).sort((a, b) => Math.abs(of[b]) - Math.abs(of[a])).map((name) => {
      const share = (50 * Math.abs(of[name])) / most, bar = el(of[name] < 0 ? "i.no" : "i.ok");
      bar.style.width = `${share}%`;
      bar.style.left = of[name] < 0 ? `${50 - share}%` : "50%";
      return el("li", {}, el("span", {}, name), el("span.bar", {}, bar), el("span.value", {}, signed(of[name], 1)));
    })));
}

const facts = (rows) => el("dl.card.facts", {}, rows.filter(Boolean).flatMap(([k, v]) => [el("dt", {}, k), el("dd", {}, v)]));

function verdict(kind, iconName, title, ...rest) {
  return el(`section.card.verdict.${kind}`, { role: "status" },
    el("h2", {}, icon(iconName, 26), title), ...rest);
}

/** What to change at the scanner, in the daemon's words. */
function advice(lines) {
  if (!lines.length) return null;
  return el("section.card", {}, el("h2", {}, "What to do at the scanner"),
    lines.map((line) => el("p.advice", {}, icon("warning", 18), line)));
}

const details = (title, ...rest) => el("details.card", {}, el("summary", {}, title), ...rest);

function timing(t) {
  const names = { parse: "reading", prepare: "finding the face", score: "score", align: "alignment", minimal: "minimal disparity" };
  return details(`Time: ${t.total.toFixed(0)} ms on the server`,
    el("dl.facts", {}, Object.entries(names).filter(([k]) => t[k] != null)
      .flatMap(([k, name]) => [el("dt", {}, name), el("dd", {}, `${t[k].toFixed(1)} ms`)])));
}

/** The same request as a command; a name from outside is quoted for the shell. */
function curl(path, ...parts) {
  const quoted = (text) => `'${text.replace(/'/g, "'\\''")}'`;
  const line = ["curl -H \"Authorization: Bearer $TOKEN\"", ...parts.map(([flag, value]) => `${flag} ${quoted(value)}`),
    quoted(url(path))].join(" \\\n  ");
  return details("The same with curl", el("pre", { tabIndex: 0 }, line));
}

const unit = (scan) => (scan.units ? `, ${scan.units}` : "");
const slotLine = (scan) => `${count(scan.points_read)} points${unit(scan)}`;

export function open(main, who) {
  const verifies = who.scopes.includes("verify");
  const slots = [slot("A"), slot("B")];
  const stage = createStage();
  const side = el("div.side", { "aria-live": "polite" });
  const title = el("h1", {}, "Compare two scans");
  const saveButton = el("button", { type: "button", disabled: true, onclick: () => save("surfaces.glb", [file], "model/gltf-binary") },
    icon("save"), "Save 3D file");
  const swapButton = el("button.quiet.swap", { type: "button", title: "Swap A and B", "aria-label": "Swap A and B", onclick: swap }, icon("swap"));
  let file = null, running = null;

  function slot(letter) {
    const name = el("strong", {}, "New scan"), about = el("span.dim", {}, "Drop a file or choose one");
    const badge = el("span.badge", { hidden: true });
    const input = el("input", { type: "file", "aria-label": `Scan ${letter}`, onchange: () => put(s, input.files[0]) });
    const s = { letter, name, about, badge, input, file: null };
    s.box = el(`label.slot.${letter.toLowerCase()}`, {
      ondragover: (e) => { e.preventDefault(); s.box.classList.add("over"); },
      ondragleave: () => s.box.classList.remove("over"),
      ondrop: (e) => {
        e.preventDefault();
        s.box.classList.remove("over");
        if (e.dataTransfer.files[0]) put(s, e.dataTransfer.files[0]);
      },
    }, el("span.letter", { "aria-hidden": "true" }, letter), el("span.text", {}, name, about), badge, input);
    return s;
  }

  function label(s, scan, quality) {
    s.name.textContent = s.file?.name ?? "New scan";
    s.about.textContent = !s.file ? "Drop a file or choose one" : scan ? slotLine(scan) : `${count(Math.ceil(s.file.size / 1024))} KB`;
    s.badge.hidden = quality == null;
    if (quality != null) s.badge.textContent = `quality ${quality.toFixed(2)}`;
  }

  function put(s, f) {
    s.file = f;
    label(s);
    run();
  }

  function swap() {
    [slots[0].file, slots[1].file] = [slots[1].file, slots[0].file];
    slots.forEach((s) => label(s));
    run();
  }

  async function sample(names) {
    const files = await Promise.all(names.map(async (n) => new File([await (await fetch(url(`/console/${n}`))).arrayBuffer()], n)));
    files.forEach((f, i) => { slots[i].file = f; label(slots[i]); });
    run();
  }

  function show(glb, layered) {
    if (!(glb instanceof ArrayBuffer)) { // there is nothing to look at
      clear();
      return glb;
    }
    file = glb;
    saveButton.disabled = false;
    const { extras, nodes } = readGlb(glb);
    stage.show(nodes, layered, extras);
    return extras;
  }

  function clear(...cards) {
    file = null;
    saveButton.disabled = true;
    stage.clear();
    side.replaceChildren(...cards.filter(Boolean));
  }

  async function check(s, stop) {
    const glb = await request("POST", "/v1/check?detail=surface", { body: s.file, binary: true, stop });
    const r = show(glb, false);
    label(s, r.scan, r.quality?.score);
    const state = r.enrollable ? ["ok", "yes", "Good to enroll", "The face is whole, sharp and turned to the scanner."]
      : r.usable ? ["unsure", "unsure", "Good to verify, not to enroll", r.detail]
        : ["no", "no", "Not usable", r.detail];
    side.replaceChildren(
      ...[verdict(state[0], state[1], state[2], el("p", {}, state[3]), verifies && el("p.dim", {}, "Drop a second scan to compare them.")),
        advice([...r.advice, ...r.notes]),
        r.scan && facts([["Format", r.scan.format.toUpperCase()], ["Points on the face", count(r.scan.points_used)],
          r.scan.yaw_deg != null && ["Turned", `${plain(r.scan.yaw_deg, 0)}°`], ["Covered", percent(r.scan.occluded)],
          r.quality && ["A point every", mm(r.quality.density_mm, 1)], r.quality && ["Noise", mm(r.quality.noise_mm)]]),
        timing(r.timing_ms), curl("/v1/check", ["--data-binary", `@${s.file.name}`])].filter(Boolean));
  }

  async function compare(stop) {
    const body = new FormData();
    body.append("a", slots[0].file, slots[0].file.name);
    body.append("b", slots[1].file, slots[1].file.name);
    const r = show(await request("POST", "/v1/compare?detail=surface", { body, binary: true, stop }), true);
    slots.forEach((s, i) => label(s, r.scan["ab"[i]], r.quality["ab"[i]]?.score));
    const v = VERDICTS[r.decision];
    side.replaceChildren(
      verdict(v.kind, v.icon, v.title, el("p", {}, explain(r)), gauge(r, r.calibration?.knots),
        el("p.dim", {}, `${oneIn(r.fmr_at_score)} other people would score this high or higher.`.replace(/^a/, "A"))),
      regions(r.regions),
      facts([["Face in common", percent(r.overlap)], ["Minimal disparity", mm(r.disparity_mm, 3)],
        ["Volume between", `${(r.minimal.volume_mm3 / 1000).toFixed(1)} cm³`]]),
      timing(r.timing_ms),
      curl("/v1/compare", ["-F", `a=@${slots[0].file.name}`], ["-F", `b=@${slots[1].file.name}`]));
  }

  async function run() {
    running?.abort();
    const own = (running = new AbortController());
    const given = slots.filter((s) => s.file);
    main.classList.toggle("busy", given.length > 0);
    try {
      if (given.length === 2 && verifies) await compare(own.signal);
      else if (given.length) await check(given.at(-1), own.signal);
      else welcome();
    } catch (e) {
      if (e.name === "AbortError") return;
      const bad = e.status === undefined;
      clear(verdict(e.status === 422 ? "no" : "unsure", "warning", e.status === 422 ? "Not usable" : "That did not work",
        el("p", {}, bad ? `The page failed: ${e.message}` : e.message),
        e.wait && el("p.dim", {}, `It can be tried again in ${e.wait} s.`)));
    } finally {
      if (own === running) main.classList.remove("busy");
    }
  }

  function welcome() {
    clear(el("section.card.welcome", {},
      el("h2", {}, "Where do two scans differ, and what decides?"),
      el("p", {}, "Drop one scan to see the face that is found in it and whether it is good to enroll; drop two to compare them. ",
        "PLY, OBJ, STL, PCD, GLB, text and depth images are read. Nothing is stored."),
      verifies && el("p", {}, "No scan at hand? These faces were made by a computer:"),
      verifies && el("div.samples", {}, SAMPLES.map(([name, ...names]) =>
        el("button", { type: "button", onclick: () => sample(names) }, name))),
      el("p.dim", {}, "A score is no proof of who somebody is.")));
  }

  main.replaceChildren(
    el("header", {}, title, el("span.dim.note", {}, "Nothing is stored."), saveButton),
    el("div.slots", {}, slots[0].box, swapButton, slots[1].box),
    el("div.try", {}, stage.element, side));
  welcome();
  return () => {
    running?.abort();
    stage.close();
  };
}
