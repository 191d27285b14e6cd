// groups.js -- the groups in use: how many people are in each, and how many tokens are bound to it.

import { get, query } from "./api.js";
import { count, el, many } from "./dom.js";
import { failed, table, waiting } from "./widgets.js";

const PAGE = 1000, TRIES = 100; // people a request, and requests until it is asked whether to go on

export function openGroups(body, who) {
  const found = new Map(), stop = new AbortController(), tokens = who.scopes.includes("tokens");
  const of = (group) => found.get(group) ?? found.set(group, { group, people: 0, tokens: 0 }).get(group);
  const status = el("p.dim", { role: "status" });
  let cursor = null, looked = 0, outside = 0, unbound = 0;
  who.groups.forEach(of);

  const link = (n, what, to) => (n ? el("a.chip", { href: to, "aria-label": `${count(n)} ${what}` }, count(n)) : el("span.dim", {}, "none"));
  const list = table("Groups", [
    ["Group", ({ group }) => group, "name"],
    ["People", (g) => link(g.people, `in the group ${g.group}`, `#people${query({ group: g.group })}`)],
    ...(tokens ? [["Tokens", (g) => link(g.tokens, `bound to the group ${g.group}`, `#health${query({ tab: "tokens", group: g.group })}`)]] : []),
  ]);

  function show() {
    const all = [...found.values()].sort((a, b) => (a.group < b.group ? -1 : 1));
    body.replaceChildren(...[
      all.length > 0 ? list.element : el("p", {}, "Nobody is in a group, and no token is bound to one. A person's page has their groups."),
      who.groups.length > 0 ? el("p.dim", {}, "Your token is bound to groups: it sees these, and their people, alone.")
        : el("p.dim", {}, `In no group: ${many(outside, "person", "people")}. Only a token that is bound to no group sees them`, tokens && `: ${many(unbound, "token")}`, "."),
      el("div.row.end", {}, status, cursor !== null && el("button", { type: "button", onclick: load }, "Count on")),
    ]);
    list.set(all);
    status.textContent = cursor !== null ? `Counted of the first ${count(looked)} people; there are more.` : `${many(all.length, "group")}.`;
  }

  async function load() {
    body.replaceChildren(waiting(), el("div.row.end", {}, status));
    try {
      if (tokens && !looked) {
        const { tokens: valid } = await get("/v1/tokens", { stop: stop.signal });
        for (const t of valid.filter((t) => t.state === "valid")) {
          t.groups.forEach((g) => of(g).tokens++);
          unbound += !t.groups.length;
        }
      }
      for (let tries = TRIES; tries > 0; tries--) {
        const page = await get(`/v1/subjects${query({ limit: PAGE, cursor })}`, { stop: stop.signal });
        for (const s of page.subjects) {
          s.groups.forEach((g) => of(g).people++);
          outside += !s.groups.length;
        }
        looked += page.subjects.length;
        status.textContent = `Counting … ${count(looked)}`;
        cursor = page.next_cursor;
        if (cursor === null) break;
      }
      show();
    } catch (e) {
      if (e.name !== "AbortError") body.replaceChildren(failed(e, load));
    }
  }

  load();
  return () => stop.abort();
}
