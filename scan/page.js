// page.js -- a comparison or a scan as a page of its own, with the console's view: what surfacectl
// explain and surfacectl scan write.  scripts/page.sh joins it with the modules, scan/page.c adds the
// data: binary glTF whose extras are the response, and of each side name, origin and time.

import { el, icon, time } from "./dom.js";
import { openGlb, readGlb } from "./glb.js";
import { copies, createReport } from "./report.js";
import { createStage } from "./stage.js";
import { compared, facts, failure, found, qualityOf } from "./verdict.js";

/** Puts the bytes of each array back: scan/page.c has first all first bytes of its elements, then all
 *  second ones, and so on, each as the difference from the one before, which packs better. */
function reorder(file) {
  const { document, start } = openGlb(file);
  for (const { bufferView, componentType, type } of document.accessors) {
    const { byteOffset, byteLength } = document.bufferViews[bufferView];
    const to = new Uint8Array(file, start + byteOffset, byteLength), from = to.slice();
    const size = type === "VEC3" || componentType === 5125 ? 12 : componentType === 5123 ? 6 : 4;
    for (let k = 0, next = 0; k < size; k++)
      for (let at = k, last = 0; at < byteLength; at += size)
        to[at] = last = (last + from[next++]) & 255;
  }
  return file;
}

async function unpack(text) {
  const packed = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return readGlb(reorder(await new Response(stream).arrayBuffer()));
}

/** Whose face, or which file; from where and when; how good. */
function side(letter, s) {
  return el(`div.slot.${letter.toLowerCase() || "one"}`, {}, letter && el("span.letter", {}, letter),
    el("span.text", {}, el("strong", {}, s.name), el("span.dim", {}, `${s.about} ${s.at ? `${time(s.at)} UTC` : ""}`)),
    s.quality != null && el("span.badge", {}, `quality ${s.quality.toFixed(2)}`));
}

function setTheme(theme) {
  document.documentElement.dataset.theme = theme;
  dispatchEvent(new Event("theme"));
}

function open({ extras: r, nodes }) {
  const two = r.decision !== undefined, stage = createStage();
  const { cards, known } = (two ? compared : found)(r), title = two ? "What decided" : "What was found", made = `${time(r.made_at)} UTC`;
  const sides = two ? [["A", r.a], ["B", r.b]] : [["", { ...r.a, quality: qualityOf({ ...r, quality: { score: r.a.quality } }) }]];
  const report = createReport(stage, () => ({
    title, at: made, facts: known, cards: copies(cards),
    sides: sides.map(([letter, s]) => [letter, s.name, `${s.about} ${s.at ? `${time(s.at)} UTC` : ""}${s.quality != null ? `, quality ${s.quality.toFixed(2)}` : ""}`]),
  }));
  document.title = two ? `${r.a.name} and ${r.b.name}` : r.a.name;
  document.body.replaceChildren(el("main", {},
    el("header", {}, el("h1", {}, title), el("span.dim.note", {}, made), report.buttons,
      el("button.quiet", { type: "button", title: "Dark or light", "aria-label": "Dark or light",
        onclick: () => setTheme(document.documentElement.dataset.theme === "dark" ? "light" : "dark") }, icon("sun"))),
    el("div.slots", {}, side(...sides[0]), two && el("span.swap"), two && side(...sides[1])),
    el("div.try", {}, stage.element, el("div.side", {}, ...cards.filter(Boolean), facts(known),
      el("p.dim", {}, "This page has the faces in it: keep it as you keep scans.",
        two && " A score is no proof of who somebody is.")))));
  stage.show(nodes, two, nodes.face || two ? undefined : "The scan as it came: no face was found in it.");
  report.ready(true);
}

setTheme(matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light");
unpack(document.getElementById("data").textContent).then(open)
  .catch((e) => document.body.replaceChildren(el("main", {}, failure(e))));
