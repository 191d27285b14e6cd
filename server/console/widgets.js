// widgets.js -- dialogs, tables, fields: what several pages are made of.

import { query } from "./api.js";
import { el, focusAgain, icon, labelOf } from "./dom.js";
import { failure } from "./verdict.js";

/** A dialog over the page; the browser holds the focus in it, closes it on Escape, and gives the focus
 *  back.  Returns {element, close, body}; closed(): however it ended. */
export function dialog(title, { wide, closed } = {}) {
  const body = el("div.body"), opener = labelOf(document.activeElement);
  function ended() {
    element.remove();
    closed?.();
    if (document.activeElement === document.body) focusAgain(opener); // what opened it was made anew, or is gone
  }
  const element = el(wide ? "dialog.wide" : "dialog", { "aria-labelledby": "dialog-title", onclose: ended },
    el("header", {}, el("h2", { id: "dialog-title" }, title),
      el("button.quiet", { type: "button", "aria-label": "Close", onclick: () => element.close() }, icon("close", 18))),
    body);
  document.body.append(element);
  element.showModal();
  return { element, body, close: () => element.close() };
}

/** Calls act() while its button waits; what was refused is shown beside it.  Returns whether it was done. */
export async function attempt(button, error, act) {
  const name = document.activeElement === button && labelOf(button); // a disabled button loses the focus
  button.disabled = true;
  error.textContent = "";
  try {
    await act();
    return true;
  } catch (e) {
    error.textContent = e.message + (e.wait ? ` It can be tried again in ${e.wait} s.` : "");
    return false;
  } finally {
    button.disabled = false;
    if (button.isConnected && name) button.focus();
    else if (name && document.activeElement === document.body) focusAgain(name);
  }
}

/** What failed, and a button that tries it again. */
export function failed(e, again) {
  const card = failure(e);
  card.append(el("div", {}, el("button", { type: "button", onclick: again }, "Try again")));
  return card;
}

/** In the place of what the daemon has not sent yet; it shows only if that takes a while. */
export const waiting = () => el("div.waiting", { role: "img", "aria-label": "Loading" }, [1, 2, 3].map(() => el("i.card")));

/** A question before something is done: act() once it is confirmed. */
export function ask(title, text, verb, act, { danger } = {}) {
  const d = dialog(title), error = el("p.error", { role: "alert" });
  const button = el(danger ? "button.danger" : "button.primary", {
    type: "button", autofocus: true,
    onclick: async () => { if (await attempt(button, error, act)) d.close(); },
  }, verb);
  d.body.append(el("p", {}, text), error,
    el("div.buttons", {}, el("button", { type: "button", onclick: d.close }, "Cancel"), button));
  button.focus();
}

/** Of an input for what is no prose: an id, a token. */
export const VERBATIM = { autocomplete: "off", spellcheck: false, autocapitalize: "off" };

let fields = 0;

/** A labelled input; note: what to know before filling it in. */
export function field(label, input, note) {
  input.id = `field-${++fields}`;
  if (note) input.setAttribute("aria-describedby", `${input.id}-note`);
  return el("div.field", {}, el("label", { htmlFor: input.id }, label), input,
    note && el("span.dim", { id: `${input.id}-note` }, note));
}

/** A table; columns: [title, row => cell, class].  Where it is wider than its place, each row is a card.
 *  row(tr, x): what else a row is given. */
export function table(caption, columns, row) {
  const body = el("tbody", { role: "rowgroup" });
  const make = (x) => {
    const tr = el("tr", { role: "row" }, columns.map(([title, cell, kind], i) =>
      el(`${i ? "td" : "th"}${kind ? `.${kind}` : ""}`, i ? { role: "cell", "data-title": title } : { role: "rowheader", scope: "row" }, cell(x))));
    row?.(tr, x);
    return tr;
  };
  const inner = el("table", { role: "table", "aria-label": caption },
    el("thead", { role: "rowgroup" }, el("tr", { role: "row" }, columns.map(([title, , kind]) =>
      el(`th${kind ? `.${kind}` : ""}`, { scope: "col", role: "columnheader" }, title)))),
    body);
  const element = el("div.card.table", {}, inner);
  let width = 0; // of the place, when it was looked at last
  function fit() {
    element.classList.remove("cards");
    width = element.offsetWidth;
    element.classList.toggle("cards", inner.scrollWidth > element.clientWidth);
  }
  new ResizeObserver(() => element.offsetWidth !== width && fit()).observe(element);
  const changed = (change) => (rows) => {
    change(rows);
    if (element.isConnected) fit();
  };
  return { element, body, set: changed((rows) => body.replaceChildren(...rows.map(make))), add: changed((rows) => body.append(...rows.map(make))) };
}

/** The groups that a text names, "door-3, staff"; and an input for them. */
const groupsIn = (text) => text.split(/[\s,]+/).filter(Boolean);
export function groupsField(note, groups = []) {
  const input = el("input", { type: "text", value: groups.join(", "), placeholder: "door-3, staff", ...VERBATIM });
  return { input, element: field("Groups", input, note), get value() { return groupsIn(input.value); } };
}

/** Groups, each as a link to its people. */
export const groupLinks = (groups) => groups.length > 0 && el("span.chips", {}, groups.map((group) => el("a.chip", { href: `#people${query({ group })}` }, group)));

/** The address of a person's page. */
export const personAt = (subject) => `#people${query({ subject })}`;

export const state = (s) => el(`span.state.${s.kind}`, {}, icon(s.icon, 14), s.title);

/** A share of 1 as a bar and in digits. */
export function meter(value) {
  if (value == null) return el("span.dim", {}, "–");
  const bar = el("i");
  bar.style.width = `${100 * value}%`;
  return el("span.meter", {}, el("span.track", { "aria-hidden": "true" }, bar), value.toFixed(2));
}

/** Choices of which one holds, as links: [name, title]; to(name): its address. */
export function choices(label, all, current, to) {
  return el("nav.choices", { "aria-label": label }, all.map(([name, title]) =>
    el("a", { href: to(name), "aria-current": name === current ? "true" : null }, title)));
}
