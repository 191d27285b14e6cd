// burst.js -- the place of the scans of one sitting: what each of them is good for, what became of it, and what they
// give together.

import { query, request } from "./api.js";
import { camera } from "./camera.js";
import { el, icon, many, mm, percent, refill } from "./dom.js";
import { readSeen } from "./glb.js";
import { createSlot } from "./slot.js";
import { checked, qualityOf } from "./verdict.js";
import { meter, state, table } from "./widgets.js";

const OF_THE_FILE = [400, 413, 415, 422]; // what is refused with these is the file, and not the request

/** Without the name that stands beside it, or that a check gives to every scan. */
const bare = (detail, file) => [file.name, "points"].reduce((text, name) => (text.startsWith(`${name}: `) ? text.slice(name.length + 2) : text), detail);

/** What a check says of a scan beside others, in few words. */
function fit(r, verifying) {
  if (r.enrollable || (r.usable && verifying && r.code !== "not_a_face")) return [{ kind: "ok", icon: "yes", title: "Good" }, ""];
  if (r.usable && r.code !== "not_a_face") return [{ kind: "unsure", icon: "unsure", title: "Alone not good enough" }, r.detail];
  return [{ kind: "no", icon: "no", title: r.usable ? "Hardly a face" : "Not usable" }, r.detail];
}

const ONE = { cheeks: "cheek", eyes: "eye" };

/** The parts that a scan adds, as the person calls them: "nose; left cheek". */
function places(parts) {
  return [null, "left", "right"].map((side) => {
    const names = parts.filter((p) => p.side === side).map((p) => p.region);
    return side && names.length ? `${side} ${names.length === 1 && ONE[names[0]] ? ONE[names[0]] : `half of ${names.join(", ")}`}` : names.join(", ");
  }).filter(Boolean).join("; ");
}

/** What a scan adds to those before it, whose last is `before`. */
function adds(a, before) {
  const share = percent(a.share);
  if (!before) return `has ${share} of the face, noise ${mm(a.noise_mm)}. The others were laid on it.`;
  const parts = a.parts.length ? `: ${places(a.parts)}` : "";
  return `adds ${share === "0 %" ? "no other part" : share} of the face${parts}. Noise ${mm(before.noise_mm)} before, ${mm(a.noise_mm)} with it.`;
}

/** The part of the face that it adds, behind what those before it have. */
function bar(a, from) {
  const [had, new_] = [el("i.had"), el("i")];
  had.style.width = new_.style.left = `${100 * from}%`;
  new_.style.width = `${100 * a.share}%`;
  return el("span.track", { "aria-hidden": "true" }, had, new_);
}

/** most: as many files are sent at once.  verifying: nobody is to be enrolled.  changed(): the files are others, or may be sent
 *  now.  look(scan): if given, shows the nodes of a scan. */
export function createBurst({ most, verifying, changed, look }) {
  const slot = createSlot("", others, most), lens = camera(anew);
  const list = el("ul.card.burst", { hidden: true, "aria-label": "The scans of this sitting" });
  let scans = []; // {file, r: of the check, nodes, at: [state, why], used, adds: in the response}
  let over = false; // they were sent, and no other is

  function others() {
    scans = slot.files.map((file) => scans.find((s) => s.file === file) ?? { file, r: null, nodes: null, at: null });
    for (const s of scans) s.adds = null;
    draw();
    changed();
  }

  /** By another camera each is another scan. */
  function anew() {
    scans = [];
    others();
  }

  function draw() {
    list.hidden = scans.length < 2;
    if (list.hidden) return list.replaceChildren();
    const fused = scans.filter((s) => s.adds).sort((a, b) => a.adds.place - b.adds.place);
    const before = (s) => fused.slice(0, s.adds.place - 1);
    refill(list, ...[...fused, ...scans.filter((s) => !s.adds)].map((s) => el("li", {},
      s.nodes ? el("button.quiet.name", { type: "button", title: "Look at it", "aria-label": `Look at ${s.file.name}`, onclick: () => look(s) }, s.file.name)
        : el("strong.name", {}, s.file.name),
      s.r && meter(qualityOf(s.r)),
      !over && el("button.quiet", { type: "button", title: "Take it out", "aria-label": `Take ${s.file.name} out`, onclick: () => without(s) }, icon("close")),
      el("p", {}, ...said(s, s.adds && before(s).at(-1)?.adds)),
      s.adds && bar(s.adds, before(s).reduce((sum, b) => sum + b.adds.share, 0)))));
  }

  /** What is known of a scan, and why. */
  function said({ at, file, adds: a }, before) {
    if (!at) return [el("span.dim", {}, "Not looked at yet")];
    const why = a ? adds(a, before) : at[1] && bare(at[1], file);
    return [state(why ? { ...at[0], title: `${at[0].title}:` } : at[0]), why && el("span.dim", {}, ` ${why}`)].filter(Boolean);
  }

  function without(s) {
    slot.input.value = "";
    slot.take(slot.files.filter((file) => file !== s.file));
    slot.input.focus();
  }

  /** Checks each scan by itself, but for one that is not looked at; nothing is stored.  Returns them, or null: they cannot be sent yet. */
  async function check(stop) {
    const all = scans;
    if (!all.length || !await lens.ready(slot.files)) return null;
    for (const s of all.length > 1 || look ? all : []) {
      if (!s.r) try {
        const { extras, nodes } = readSeen(await request("POST", `/v1/check${query({ detail: look && "surface", ...lens.values })}`, { body: s.file, binary: look !== undefined, stop }));
        [s.r, s.nodes] = [extras, nodes];
      } catch (e) {
        if (all.length === 1 || !OF_THE_FILE.includes(e.status)) throw e;
        s.r = { usable: false, code: e.code, detail: e.message };
      }
      s.at = fit(s.r, verifying);
      draw();
    }
    if (all.length === 1 && look) slot.label(all[0].r.scan, qualityOf(all[0].r));
    return all;
  }

  /** The best of these scans by itself. */
  const best = (of = scans) => of.filter((s) => s.r?.quality && qualityOf(s.r) != null).sort((a, b) => b.r.quality.score - a.r.quality.score)[0];

  /** What became of the scans: of a response, or of a Refusal, whose other scans are as they were. */
  function became({ frames, templates }, refused = false) {
    (frames ?? templates)?.forEach((f, i) => {
      const why = f.reason ?? f.refusal;
      if (why) scans[i].at = [{ kind: "no", icon: "no", title: frames ? "Left out" : "Not enrolled" }, why.detail];
      else if (!refused) scans[i].at = [{ kind: "ok", icon: "yes", title: frames ? "Used" : f.new ? "Enrolled" : "Was enrolled before" }, f.template_id ? `template ${f.template_id}` : ""];
      scans[i].used = !why;
      scans[i].adds = f.adds;
    });
    draw();
  }

  /** What scans that were fused give together, beside the best of them by itself; r: the response. */
  function gains(r) {
    const used = scans.filter((s) => s.used), alone = best(used);
    if (scans.length < 2 || !r.frames) return null;
    const title = el("h2", {}, `${used.length} of ${many(scans.length, "scan")} used`);
    if (used.length < 2 || !alone) return el("section.card", {}, title, el("p.dim", {}, "It is as good as that scan by itself."));
    const t = table("What the scans give together", [["Value", ([what]) => what], ["Best alone", ([, a]) => a, "number"], ["Together", ([, , b]) => b, "number"]]);
    const row = (what, key, write) => [what, write(alone.r.quality[key]), write(r.quality[key])];
    t.set([row("Quality", "score", (q) => q.toFixed(2)), row("Noise", "noise_mm", mm), row("Outline measured", "coverage", percent), row("A point every", "density_mm", (v) => mm(v, 1))]);
    return el("section.stack.gains", {}, title, el("p.dim", {}, `The best of them alone is ${alone.file.name}.`), t.element);
  }

  return {
    parts: [slot.box, slot.wrong, lens.element, list], check, best, became, gains, label: slot.label, take: slot.take,
    /** Cards on scans that were sent, with the response. */
    told(r) {
      over = true;
      draw();
      return scans.length > 1 ? [gains(r), list].filter(Boolean) : [];
    },
    get files() { return slot.files; },
    get values() { return lens.values; },
    /** What is sent: the file, or a form of all of them. */
    get body() {
      if (scans.length < 2) return slot.file;
      const form = new FormData();
      for (const file of slot.files) form.append("scan", file, file.name);
      return form;
    },
    /** What they are called in a sentence. */
    get name() { return scans.length > 1 ? many(scans.length, "scan") : slot.file?.name; },
  };
}
