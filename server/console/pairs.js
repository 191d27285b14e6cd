// pairs.js -- the templates of a person compared with each other: which of them does not fit the others?

import { get } from "./api.js";
import { el, icon, many, plain } from "./dom.js";
import { attempt } from "./widgets.js";
import { outcome } from "./words.js";

const nameOf = (t) => t.label || t.template_id.slice(0, 8);
const dayOf = (t) => t.created.slice(0, 10);

/** A template, for who reads: "scanner 1 of 2026-03-03". */
const named = (t) => `${nameOf(t)} of ${dayOf(t)}`;

const cannot = (t) => `The template ${named(t)} cannot be judged: too little of the face is in it and in the others, or it is too noisy.`;

/** What the comparisons say: [icon, kind, sentences]. */
function summary({ subject, templates, pairs }) {
  const compared = templates.filter((t) => t.compared), others = compared.length - 1;
  const odd = compared.filter((t) => t.fits === false), unknown = compared.filter((t) => t.fits === null);
  const left = templates.filter((t) => !t.compared).map((t) => `The template ${named(t)} is of another version, and cannot be compared.`);
  const number = (decision) => pairs.filter((p) => p.decision === decision).length, against = number("no_match"), unsure = number("inconclusive");
  if (!pairs.length) return ["unsure", "unsure", left];
  if (odd.length > 0 && odd.length === compared.length)
    return ["warning", "no", [odd.length === 2 ? `The two templates do not fit each other. Which of them is of ${subject} they cannot tell.`
      : `None of the templates fits most of the others: they are of several people, or of bad sittings. Which are of ${subject} they cannot tell.`, ...left]];
  if (odd.length > 0)
    return ["warning", "no", [...odd.map((t) => `The template ${named(t)} fits ${t.matches ? `only ${t.matches}` : "none"} of the ${t.matches ? `${others} ` : ""}others.`),
      "It is of another person, or of a bad sitting: look at it before you delete it.", ...unknown.map(cannot), ...left]];
  if (unknown.length || left.length) return ["unsure", "unsure", [...unknown.map(cannot), ...left]];
  return ["yes", "ok", [against + unsure === 0 ? "All fit each other."
    : `Each fits most of the others. Of ${many(pairs.length, "pair")} ${against} ${against === 1 ? "does" : "do"} not match, and of ${unsure} it cannot be told.`]];
}

function matrix({ templates, pairs }) {
  const of = new Map(pairs.flatMap((p) => [[`${p.a} ${p.b}`, p], [`${p.b} ${p.a}`, p]]));
  const cell = (a, b) => {
    const p = of.get(`${a.template_id} ${b.template_id}`);
    if (!p) return el("td.dim", {}, a === b ? "" : "–");
    const is = outcome(p.decision);
    return el(`td.${is.kind}`, {}, icon(is.icon, 14), el("span.sr", {}, `${is.title} `), p.score !== null && plain(p.score, Math.abs(p.score) < 10 ? 1 : 0));
  };
  return el("div.matrix", { role: "region", tabIndex: 0, "aria-label": "Each template with each other" }, el("table", {},
    el("thead", {}, el("tr", {}, el("td"), templates.map((t, i) => el("th", { scope: "col", title: named(t), "aria-label": named(t) }, String(i + 1))))),
    el("tbody", {}, templates.map((a, i) => el("tr", {},
      el(a.fits === false ? "th.no" : "th", { scope: "row", title: named(a) }, `${i + 1} ${nameOf(a)} `, a.fits === false && [icon("warning", 14), el("span.sr", {}, " does not fit")], el("span.dim", {}, dayOf(a))),
      templates.map((b) => cell(a, b)))))));
}

const legend = ({ threshold, pairs }) => el("p.states", {},
  ["match", "no_match", "inconclusive"].map((d) => outcome(d)).map((o) => el(`span.state.${o.kind}`, {}, icon(o.icon, 14), o.title)),
  el("span.dim", {}, pairs.some((p) => p.score !== null) ? `A score of ${plain(threshold, 1)} or more is a match.` : "Scores are shown to a token with the scope score."));

/** A place with a button, that has the comparison once it was asked for. */
export function pairsOf(subject) {
  const error = el("p.error", { role: "alert" }), said = el("p", { role: "status" });
  const place = el("div.stack");
  const button = el("button", {
    type: "button",
    onclick: () => attempt(button, error, async () => {
      const all = await get(`/v1/subjects/${encodeURIComponent(subject)}/templates/compare`);
      const [sign, kind, sentences] = summary(all);
      place.replaceChildren(el("section.card.pairs", {}, el("h2", {}, "The templates with each other"),
        said, all.pairs.length > 0 && [matrix(all), legend(all)], el("p.dim", {}, "The audit log has recorded that you compared them.")));
      said.className = `said state ${kind}`;
      said.append(icon(sign, 18), el("span", {}, sentences.join(" ")));
      place.querySelector(".matrix")?.focus({ preventScroll: true });
    }),
  }, "Compare them with each other");
  place.append(el("div.row.end", {}, button), error);
  return place;
}
