// people.js -- who is enrolled: found by a part of the id and by state.

import { get, query } from "./api.js";
import { count, day, el, icon, when } from "./dom.js";
import { enroll } from "./enroll.js";
import { openPerson } from "./person.js";
import { droppable } from "./slot.js";
import { choices, failed, groupLinks, meter, personAt, state, table, waiting } from "./widgets.js";
import { personStates } from "./words.js";

const STATES = [["", "All"], ["active", "Active"], ["ending", "Ending soon"], ["expired", "Expired"], ["disabled", "Disabled"], ["hold", "On hold"]];
const PAGE = 50, LEAST = 20, TRIES = 20;

let listed = "#people"; // the list that was looked at last, which a person's page goes back to

export function open(main, who, asked) {
  if (!who.scopes.includes("read")) return openDesk(main, who);
  if (asked.get("subject") !== null) return openPerson(main, who, asked.get("subject"), listed);

  let q = asked.get("q") ?? "", group = asked.get("group"), filter = asked.get("state") ?? "", cursor = null, shown = 0, stop = null, timer = 0;
  const here = (filter) => `#people${query({ q, state: filter, group })}`;
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
  const problem = el("div");

  /** A page may be short: the daemon looks at so many people for a request, and is asked again. */
  async function load(anew) {
    stop?.abort();
    const own = (stop = new AbortController());
    if (anew) [cursor, shown] = [null, 0];
    status.textContent = "Looking …";
    more.hidden = true;
    try {
      for (let got = 0, tries = 0; tries < TRIES && got < LEAST; tries++) {
        const page = await get(`/v1/subjects${query({ q, state: filter, group, limit: PAGE, cursor })}`, { stop: own.signal });
        if (!shown && !got) list.set([]);
        list.add(page.subjects);
        got += page.subjects.length;
        shown += page.subjects.length;
        cursor = page.next_cursor;
        if (cursor === null) break;
      }
      problem.replaceChildren();
      more.hidden = cursor === null;
      list.element.hidden = !shown;
      const n = `${count(shown)} ${shown === 1 ? "person" : "people"}`;
      status.textContent = cursor !== null ? (shown ? `${n} shown, there are more.` : "Nobody like that so far, and there are more to look at.")
        : shown ? `${n}.` : q || filter || group ? "Nobody like that." : "Nobody is enrolled yet.";
    } catch (e) {
      if (e.name === "AbortError") return;
      status.textContent = "";
      problem.replaceChildren(failed(e, () => load(anew)));
    }
  }

  const begin = (file) => enroll({ who, file, done: () => load(true) });
  main.replaceChildren(
    el("header", {}, el("h1", {}, "People"), el("span.search", {}, icon("search"), search),
      who.scopes.includes("enroll") && el("button.primary", { type: "button", onclick: () => begin() }, icon("plus"), "Enroll")),
    el("div.stack", who.scopes.includes("enroll") ? droppable(begin) : {}, nav,
      group !== null && el("p.row", {}, "Of the group ", el("strong", {}, group), el("a", { href: `#people${query({ q, state: filter })}` }, "Show all")), problem, list.element, el("div.row.end", {}, status, more)));
  links();
  list.element.hidden = true;
  problem.append(waiting());
  load(true);
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
