// people.js -- who is enrolled: found by a part of the id and by state.

import { get, query } from "./api.js";
import { count, day, el, icon, many, save, when } from "./dom.js";
import { enroll } from "./enroll.js";
import { openGroups } from "./groups.js";
import { openPerson } from "./person.js";
import { droppable } from "./slot.js";
import { choices, failed, groupLinks, meter, personAt, state, table, waiting } from "./widgets.js";
import { personStates } from "./words.js";

const TABS = [["", "List"], ["groups", "Groups"]];
const STATES = [["", "All"], ["active", "Active"], ["ending", "Ending soon"], ["expired", "Expired"], ["disabled", "Disabled"], ["hold", "On hold"],
  ["locked", "Locked out"], ["no_consent", "No consent"]];

/** What the list can be ordered by; else it is the order of creation. */
const ORDERS = [["", "As added"], ["subject", "By id"], ["-last_seen", "Last seen"], ["quality", "Worst quality"], ["expires_at", "End of consent"]];
const COLUMNS = ["subject", "created", "consent", "purpose", "expires_at", "last_seen", "disabled", "hold", "locked_until", "identify", "groups", "templates", "quality"];

/** A cell of CSV; what a table program would take for a formula is a text. */
const cell = (value) => `"${String(value ?? "").replace(/^[=+@\-]/, "'$&").replaceAll('"', '""')}"`;
const PAGE = 50, LEAST = 20, TRIES = 20;

let listed = "#people"; // the list that was looked at last, which a person's page goes back to

export function open(main, who, asked) {
  if (!who.scopes.includes("read")) return openDesk(main, who);
  if (asked.get("subject") !== null) return openPerson(main, who, asked.get("subject"), listed);
  const tab = asked.get("tab") === "groups" ? "groups" : "", tabs = choices("People", TABS, tab, (name) => `#people${query({ tab: name })}`);
  if (tab) {
    const body = el("div.stack");
    main.replaceChildren(el("header", {}, el("h1", {}, "People"), tabs), body);
    return openGroups(body, who);
  }

  let q = asked.get("q") ?? "", group = asked.get("group"), filter = asked.get("state") ?? "", order = asked.get("order") ?? "", cursor = null, shown = [], stop = null, timer = 0;
  const here = (filter) => `#people${query({ q, state: filter, group, order })}`;
  listed = here(filter);
  const search = el("input", {
    type: "search", value: q, placeholder: "Find an id", "aria-label": "Find a person by a part of the id", spellcheck: false, autocapitalize: "off",
    oninput: () => {
      clearTimeout(timer);
      timer = setTimeout(() => {
        q = search.value.trim();
        history.replaceState(null, "", listed = here(filter));
        links();
        load(true);
      }, 250);
    },
  });
  const nav = el("div");
  const links = () => nav.replaceChildren(choices("State", STATES, filter, here));
  const list = table("People", [
    ["Person", (s) => el("a", { href: personAt(s.subject) }, s.subject), "name"],
    ["State", (s) => el("span.states", {}, personStates(s).map(state))],
    ["Groups", (s) => groupLinks(s.groups)],
    ["Templates", (s) => s.templates || el("span.dim", {}, "none"), "number"],
    ["Quality", (s) => meter(s.quality)],
    ["Last seen", (s) => when(s.last_seen), "dim"],
    ["Consent ends (UTC)", (s) => day(s.expires_at, s.consent ? "never" : "–"), "dim"],
  ], (tr) => tr.classList.add("link"));
  const status = el("p.dim", { role: "status" });
  const more = el("button", { type: "button", onclick: () => load(false) }, "Show more");
  const all = el("button", { type: "button", onclick: () => rest() }, "Show all");
  const by = el("select", { "aria-label": "Order", onchange: () => {
    order = by.value;
    history.replaceState(null, "", listed = here(filter));
    links();
    if (order) rest(); // an order is of all
    draw(null);
  } }, ORDERS.map(([value, title]) => el("option", { value, selected: value === order }, title)));
  const problem = el("div");

  /** As the order says; what has no value comes last. */
  function sorted() {
    if (!order) return shown;
    const name = order.replace("-", ""), sign = order === name ? 1 : -1;
    const place = (a, b) => (a === b ? 0 : a == null ? 1 : b == null ? -1 : (a < b ? -1 : 1) * sign);
    return shown.toSorted((a, b) => place(a[name], b[name]));
  }

  function draw(rows) {
    if (rows && !order) list.add(rows);
    else list.set(sorted());
    list.element.hidden = !shown.length;
    more.hidden = all.hidden = cursor === null;
    const n = many(shown.length, "person", "people");
    status.textContent = cursor !== null ? (shown.length ? `${n} ${order ? "ordered" : "shown"}, there are more.` : "Nobody like that so far, and there are more to look at.")
      : shown.length ? `${n}.` : q || filter || group ? "Nobody like that." : "Nobody is enrolled yet.";
  }

  /** At least so many more.  A page may be short: the daemon looks at so many people for a request, and is asked
   *  again, so often. */
  async function load(anew, least = LEAST, tries = TRIES, limit = PAGE) {
    stop?.abort();
    const own = (stop = new AbortController());
    status.textContent = "Looking …";
    more.hidden = all.hidden = true;
    try {
      for (let got = 0, first = anew; tries-- > 0 && got < least; first = false) {
        const page = await get(`/v1/subjects${query({ q, state: filter, group, limit, cursor: first ? null : cursor })}`, { stop: own.signal });
        if (first) {
          list.set([]);
          shown = [];
        }
        shown.push(...page.subjects);
        got += page.subjects.length;
        cursor = page.next_cursor;
        if (order) status.textContent = `Looking … ${count(shown.length)}`;
        else draw(page.subjects);
        if (cursor === null) break;
      }
      problem.replaceChildren();
      draw(order ? null : []);
      return true;
    } catch (e) {
      if (e.name === "AbortError") return false;
      status.textContent = "";
      problem.replaceChildren(failed(e, () => load(anew, least, tries, limit)));
      return false;
    }
  }

  const rest = () => cursor === null || load(false, Infinity, Infinity, 1000);

  async function saveAll() {
    if (await rest())
      save("people.csv", [COLUMNS.join(), ...sorted().map((s) => COLUMNS.map((c) => cell(c === "groups" ? s.groups.join(" ") : s[c])).join())].map((line) => `${line}\r\n`), "text/csv");
  }

  const begin = (_, files = []) => enroll({ who, files: [...files], done: () => load(true) });
  main.replaceChildren(
    el("header", {}, el("h1", {}, "People"), tabs, el("span.search", {}, icon("search"), search), by,
      el("button", { type: "button", "aria-label": "Save as CSV", onclick: saveAll }, icon("save"), "CSV"),
      who.scopes.includes("enroll") && el("button.primary", { type: "button", onclick: () => begin() }, icon("plus"), "Enroll")),
    el("div.stack", who.scopes.includes("enroll") ? droppable(begin) : {}, nav,
      group !== null && el("p.row", {}, "Of the group ", el("strong", {}, group), el("a", { href: `#people${query({ q, state: filter })}` }, "Show all")), problem, list.element, el("div.row.end", {}, status, more, all)));
  links();
  list.element.hidden = true;
  problem.append(waiting());
  load(true).then((ok) => ok && order && rest());
  return () => {
    clearTimeout(timer);
    stop?.abort();
  };
}

/** For a token that may enroll, and not see who is. */
function openDesk(main, who) {
  main.replaceChildren(el("header", {}, el("h1", {}, "People")),
    el("section.card.welcome", {}, el("h2", {}, "Enroll somebody"),
      el("p", {}, "You need the person's id and a scan of the face. The scan is checked first; nothing is stored until you confirm."),
      el("p.dim", {}, "This token may enroll. It may not see who is enrolled."),
      el("div", {}, el("button.primary", { type: "button", onclick: () => enroll({ who, done: () => {} }) }, icon("plus"), "Enroll"))));
}
