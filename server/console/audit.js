// audit.js -- who did what and when: filtered, verified, exported.

import { get, post, query, request } from "./api.js";
import { count, el, icon, many, moment, plain, save } from "./dom.js";
import { verdict, VERDICTS } from "./verdict.js";
import { attempt, dialog, failed, field, personAt, state, table, waiting } from "./widgets.js";
import { kind, KINDS, outcome, WHY } from "./words.js";

const PAGE = 50, TRIES = 20;
const FILTERS = ["subject", "subject_uid", "kind", "actor", "since", "until"];
/** What an erased person is found by: on the receipt, and in each entry. */
const UID = /^[0-9a-f]{32}$/;

const dayOf = (iso) => new Date(iso).toLocaleDateString("en-GB", { weekday: "long", day: "numeric", month: "long", year: "numeric", timeZone: "UTC" });

const SAID = ["created", "set", "enabled", "disabled"]; // by the entry's name

const SEARCH = /^(match|no_match|inconclusive|) ?(-?[\d.]+|) ?of (\d+)(.*)$/; // of an identification or a candidate

/** What came of it: a decision, or in the log's words. */
export function cameOf(e) {
  if (/_(token|device)$/.test(e.kind)) return e.outcome; // a name
  if (SAID.includes(e.outcome)) return "";
  if (e.outcome in VERDICTS) return state(VERDICTS[e.outcome]);
  const [, word, score, people, rest] = SEARCH.exec(e.outcome) ?? [];
  if (people) return el("span", {}, word && state(outcome({ type: e.kind, outcome: word })),
    `${word && " "}${score && `${plain(Number(score), 1)} `}among ${many(Number(people), "person", "people")}${rest.replace(/ ([^ =]+)$/, " in $1")}`);
  const code = e.outcome.split(" ")[0];
  if (code in WHY) return el("span", { title: e.outcome }, WHY[code]);
  return e.outcome.replace(/\S+Z$/, moment);
}

export function open(main, who, from) {
  const filter = Object.fromEntries(FILTERS.map((name) => [name, from.get(name) ?? ""]));
  const here = (change) => `#audit${query({ ...filter, ...change })}`;
  let cursor = null, last = "", shown = 0, stop = null, timer = 0;

  const results = el("div", { role: "status" }), problem = el("div");
  const entries = table("Entries of the audit log", [
    ["What", (e) => el("span", { title: `${e.kind}, entry ${e.seq} of the ${e.log}` }, kind(e.kind))],
    ["Person", (e) => (e.subject === null ? (e.erased ? el("a.dim", { href: here({ subject: "", subject_uid: e.subject_uid }), title: `All of ${e.subject_uid}` }, "erased since") : "")
      : who.scopes.includes("read") ? el("a", { href: personAt(e.subject) }, e.subject) : e.subject), "name"],
    ["Outcome", cameOf, "dim.why"],
    ["By", (e) => e.actor && el("a.plain", { href: here({ actor: e.actor }), title: `Only by ${e.actor}` }, e.actor_name ?? e.actor), "by"],
    ["Time (UTC)", (e) => el("time", { dateTime: e.at, title: moment(e.at) }, e.at.slice(11, 19)), "dim"],
  ]);
  const status = el("p.dim", { role: "status" });
  const more = el("button", { type: "button", onclick: () => load(false) }, "Show older ones");

  function add(rows) {
    for (const [title, of] of Map.groupBy(rows, (e) => dayOf(e.at))) {
      if (title !== last) entries.body.append(el("tr.day", { role: "row" }, el("th", { role: "rowheader", colSpan: 5, scope: "colgroup" }, title)));
      last = title;
      entries.add(of);
    }
  }

  async function load(anew) {
    stop?.abort();
    const own = (stop = new AbortController());
    if (anew) [cursor, last, shown] = [null, "", 0];
    status.textContent = "Looking …";
    more.hidden = true;
    try {
      let page, tries = 0;
      do { // the daemon looks at so many entries for a request, and is asked again
        page = await get(`/v1/audit${query({ ...filter, limit: PAGE, before: cursor })}`, { stop: own.signal });
        cursor = page.next_cursor;
      } while (!page.entries.length && cursor !== null && ++tries < TRIES);
      if (anew) entries.set([]);
      add(page.entries);
      shown += page.entries.length;
      problem.replaceChildren();
      entries.element.hidden = !shown;
      more.hidden = cursor === null;
      status.textContent = `${shown ? count(shown) : "No"} ${shown === 1 ? "entry" : "entries"}${cursor !== null ? ", there are older ones." : "."}`;
    } catch (e) {
      if (e.name === "AbortError") return;
      if (e.status === 404 && UID.test(filter.subject)) { // no id: what a receipt calls a person
        [filter.subject, filter.subject_uid] = ["", filter.subject];
        history.replaceState(null, "", here({}));
        return load(anew);
      }
      status.textContent = "";
      entries.element.hidden = anew;
      problem.replaceChildren(e.status === 404 ? verdict("unsure", "unsure", "Nobody", el("p", {}, "Nobody is enrolled under this id. ",
        "The id of an erased person is overwritten: look for the number on the receipt of the erasure (subject_uid).")) : failed(e, () => load(anew)));
      more.hidden = anew || cursor === null;
    }
  }

  // ---- filters
  function set(name, value, delay = 0) {
    filter[name] = value;
    clearTimeout(timer);
    timer = setTimeout(() => {
      history.replaceState(null, "", here({}));
      clear.hidden = !FILTERS.some((f) => filter[f]);
      load(true);
    }, delay);
  }
  const dayInput = (name) => el("input", { type: "date", value: filter[name], oninput: (e) => set(name, e.target.value) });
  /** A select of [value, title], or of groups of them; what else is asked for in the address is added. */
  function select(name, all, groups = []) {
    const option = ([value, title]) => el("option", { value, selected: value === filter[name] }, title);
    const known = [...all, ...groups.flatMap(([, of]) => of)].some(([value]) => value === filter[name]);
    return el("select", { onchange: (e) => set(name, e.target.value) }, all.map(option),
      groups.map(([label, of]) => el("optgroup", { label }, of.map(option))), !known && option([filter[name], filter[name]]));
  }
  const groups = Object.entries(Object.groupBy(Object.entries(KINDS), ([, [, group]]) => group)).map(([group, all]) =>
    [group, [[all.map(([name]) => name).join(), `${group}: all`], ...all.map(([name, [title]]) => [name, title])]]);
  const by = field("By", select("actor", [["", "Anybody"]]));
  get("/v1/tokens").then(({ tokens }) =>
    by.replaceWith(field("By", select("actor", [["", "Anybody"], ...tokens.map((t) => [t.id, t.name])]))), () => {});
  const clear = el("a.clear", { href: "#audit", hidden: !FILTERS.some((f) => filter[f]) }, "Show all");
  const form = el("form.filters", { role: "search", onsubmit: (e) => e.preventDefault() },
    field("What", select("kind", [["", "Everything"]], groups)), field("Person", el("input", { type: "search", placeholder: "Id or number", title: "Id, or the number on a receipt", spellcheck: false, value: filter.subject || filter.subject_uid,
      oninput: (e) => { filter.subject_uid = ""; set("subject", e.target.value.trim(), 300); } })),
    by, field("From (UTC)", dayInput("since")), field("To (UTC)", dayInput("until")), clear);

  // ---- the chain, and the export
  async function verify() {
    button.disabled = true;
    results.replaceChildren(el("p.card.dim", {}, "Verifying every entry …"));
    try {
      const v = await post("/v1/audit/verify");
      results.replaceChildren(v.ok
        ? verdict("ok", "shield", "The log is whole",
          el("p", {}, `${count(v.changes)} changes, ${count(v.accesses)} accesses and ${count(v.rows)} rows were verified in `,
            `${plain(v.took_ms, 0)} ms: none is missing, none was changed.`),
          el("p.dim", {}, "Its end now, to be held against it later: entry ", count(v.head.seq), ", ", el("code", {}, v.head.hash)))
        : verdict("no", "warning", "The log is not whole",
          el("p", {}, "Something was removed or changed outside of this program. Keep a copy of the database as it is, ",
            "and tell whoever is responsible for security."),
          el("ul", {}, v.findings.map((f) => el("li", {}, f)))));
    } catch (e) {
      results.replaceChildren(failed(e, verify));
    } finally {
      button.disabled = false;
    }
  }
  const button = el("button", { type: "button", onclick: verify }, icon("shield"), el("span", {}, "Verify", el("span.roomy", {}, " the chain")));

  function exported() {
    const d = dialog("Export"), error = el("p.error", { role: "alert" });
    const filtered = FILTERS.some((f) => filter[f]);
    const make = (format, name, type, of) => async (e) => {
      if (await attempt(e.currentTarget, error, async () =>
        save(name, [await request("GET", `/v1/audit/export${query({ format, ...of })}`, { binary: true })], type))) d.close();
    };
    d.body.append(
      el("h3", {}, "A table, for reading"),
      el("p", {}, filtered ? "The entries that the filters leave, as CSV." : "All entries, as CSV. Set filters first for a part of them."),
      el("div", {}, el("button.primary", { type: "button", onclick: make("csv", "audit.csv", "text/csv", filter) }, icon("save"), "Save CSV")),
      el("h3", {}, "The signed log, for keeping"),
      el("p", {}, "The whole log, with signatures: ", el("code", {}, "surfacectl audit verify"),
        " verifies it without the database. That it was exported becomes an entry of the log."),
      el("div", {}, el("button", { type: "button", onclick: make("jsonl", "audit.jsonl", "application/jsonl", {}) }, icon("save"), "Save signed log")), error);
  }

  main.replaceChildren(
    el("header", {}, el("h1", {}, "Audit"), el("div.row", {}, button, el("button", { type: "button", onclick: exported }, icon("save"), "Export"))),
    el("div.stack", {}, results, form, problem, entries.element, el("div.row.end", {}, status, more)));
  entries.element.hidden = true;
  problem.append(waiting());
  load(true);
  return () => {
    clearTimeout(timer);
    stop?.abort();
  };
}
