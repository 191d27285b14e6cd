// report.js -- a decision, or what was found in a scan, as one sheet of paper, which is printed or filed in
// the place of the page; and the picture as a file.

import { count, el, icon, save } from "./dom.js";
import { pairs } from "./verdict.js";

/** An id for a request, which the daemon's log has too. */
export const requestId = () => [...crypto.getRandomValues(new Uint8Array(8))].map((b) => b.toString(16).padStart(2, "0")).join("");

/** A scan in so many words: how many points, how good. */
export const scanInWords = (scan, quality) =>
  [scan && `${count(scan.points_read)} points`, quality != null && `quality ${quality.toFixed(2)}`].filter(Boolean).join(", ");

/** Copies of cards, as a report takes them. */
export const copies = (cards) => cards.filter(Boolean).map((card) => card.cloneNode(true));

/** contents(): {title, at, sides: [[letter, name, about]], cards, facts} of what is shown; null: nothing, and the page is printed
 *  as it is. */
export function createReport(stage, contents) {
  let sheet = null;
  const drop = () => {
    sheet?.remove();
    sheet = null;
  };
  function make() {
    drop();
    const c = contents();
    if (!c) return;
    sheet = el("article.paper", {},
      el("header", {}, el("h1", {}, c.title), el("span", {}, `surfaced · ${c.at}`)),
      el("div.sides", {}, c.sides.map(([letter, name, about]) =>
        el("p", {}, letter && el(`strong.letter.${letter.toLowerCase()}`, {}, letter), el("strong", {}, name), el("span.dim", {}, about)))));
    document.body.append(sheet); // its colours are those of paper
    const { shots, section } = stage.sheet(sheet);
    const [verdict, ...rest] = c.cards;
    sheet.append(el("div.halves", {}, verdict, el("div", {}, ...rest, el("dl.card.facts", {}, pairs(c.facts)))),
      el("div.shots", {}, shots.map(([title, canvas]) => el("figure", {}, canvas, el("figcaption", {}, title)))));
    if (section) sheet.append(el("section.card", {}, el("h2", {}, "Section"), section.picture, section.said));
    sheet.append(el("footer", {}, "A score is no proof of who somebody is. This sheet has the faces on it: keep it as you keep scans."));
  }
  addEventListener("beforeprint", make);
  addEventListener("afterprint", drop);

  const print = el("button", { type: "button", disabled: true, onclick: () => window.print() }, icon("audit"), "Report");
  const picture = el("button", { type: "button", disabled: true, onclick: () =>
    stage.picture()?.toBlob((blob) => save("picture.png", [blob], "image/png")) }, icon("save"), "Picture");
  return {
    buttons: [print, picture],
    /** Whether there is something to print, and a picture. */
    ready(on) {
      print.disabled = !on;
      picture.disabled = !on || !stage.view;
    },
    close() {
      removeEventListener("beforeprint", make);
      removeEventListener("afterprint", drop);
      drop();
    },
  };
}
