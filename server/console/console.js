// console.js -- the frame: unlocking with a token, the pages that it may see, locking.

import { get, setToken } from "./api.js";
import { el, icon } from "./dom.js";
import { failed, waiting } from "./widgets.js";

const IDLE_MS = 15 * 60 * 1000;

/** Who has one of the scopes sees the page, which is the module of its name: loaded once it is opened. */
const PAGES = [
  { name: "try", title: "Try", icon: "face", scopes: ["verify", "enroll", "identify"] },
  { name: "identify", title: "Identify", icon: "search", scopes: ["identify"] },
  { name: "live", title: "Live", icon: "live", scopes: ["events"] },
  { name: "people", title: "People", icon: "people", scopes: ["read", "enroll"] },
  { name: "audit", title: "Audit", icon: "audit", scopes: ["audit"] },
  { name: "health", title: "Health", icon: "health", scopes: ["audit", "tokens"] },
];

/** What a token is for, most likely: the page that it opens with, by the first of these scopes that it has. */
const LANDING = [["verify", "try"], ["read", "people"], ["enroll", "people"], ["events", "live"], ["audit", "audit"], ["identify", "identify"], ["tokens", "health"]];

/** A token that may do no more than this does not lock while Live is open: a screen at a door shows all day. */
const SHOWS = ["events", "manage"];

let session = null; // {who, page, asleep, close(): what the open page has to stop}
let idle = 0;

const may = (who, scopes) => scopes.some((s) => who.scopes.includes(s));

function setTheme(theme) {
  document.documentElement.dataset.theme = theme;
  dispatchEvent(new Event("theme"));
}

const dark = matchMedia("(prefers-color-scheme: dark)");
setTheme(dark.matches ? "dark" : "light");
dark.addEventListener("change", () => setTheme(dark.matches ? "dark" : "light"));

/** Forget the token and all that was shown with it. */
function lock(why = "") {
  session?.close?.();
  session = null;
  setToken(null);
  clearTimeout(idle);
  showLock(why);
}

/** Nobody is there.  What only shows goes on, and can do nothing else until the token is typed again. */
function rest() {
  if (session.page?.name !== "live") return lock("Locked after 15 minutes without use.");
  if (session.who.scopes.every((s) => SHOWS.includes(s))) return;
  session.asleep = true;
  session.who = { ...session.who, scopes: ["events"] };
  session.close?.();
  showFrame();
}

function awake() {
  clearTimeout(idle);
  if (session) idle = setTimeout(rest, IDLE_MS);
}

async function unlock(text) {
  setToken(text || null);
  const who = await get("/v1/token");
  session = { who };
  awake();
  showFrame();
}

function showLock(why) {
  const error = el("p.error", { role: "alert" }, why);
  const input = el("input.secret", {
    id: "token", type: "text", autocomplete: "off", spellcheck: false, autocapitalize: "off", required: true,
    placeholder: "64 digits and letters a to f",
  });
  const button = el("button.primary", { type: "submit" }, "Unlock");
  const form = el("form.lock", {
    onsubmit: async (e) => {
      e.preventDefault();
      button.disabled = true;
      error.textContent = "";
      try {
        const text = input.value.trim();
        input.value = "";
        await unlock(text);
      } catch (refusal) {
        const wait = refusal.wait ? ` Wait ${refusal.wait} s.` : "";
        setToken(null);
        error.textContent = refusal.status === 401 ? "This token is not valid: it was mistyped, has expired, or was revoked." : refusal.message + wait;
        button.disabled = false;
        input.focus();
      }
    },
  },
  el("div.brand", {}, icon("face", 28), el("h1", {}, "surfaced")),
  el("label", { htmlFor: "token" }, "Access token"),
  input, button, error,
  el("p.dim", {}, "It is kept in this page's memory alone, and forgotten when you lock or leave it. ",
    "An administrator makes one with ", el("code", {}, "surfacectl token create"), "."));
  document.body.replaceChildren(el("main.locked", {}, form));
  document.title = "surfaced";
  input.focus();
}

/** What an address asks for, "live?door=3". */
function address() {
  const [name, ...rest] = location.hash.slice(1).split("?");
  return { name, asked: new URLSearchParams(rest.join("?")) };
}

/** A page that the token may not see says which one may. */
function notFor(page, pages) {
  return el("section.card.welcome", {}, el("h1", {}, page.title),
    el("p", {}, `This takes a token with the scope ${page.scopes.join(" or ")}. Yours has ${session.who.scopes.join(", ")}.`),
    pages.length > 0 && el("p", {}, "It is for ", pages.map((p, i) => [i > 0 && ", ", el("a", { href: `#${p.name}` }, p.title)]).flat(), "."));
}

function showFrame() {
  const { who, asleep } = session;
  const pages = PAGES.filter((p) => may(who, p.scopes));
  const main = el("main", { id: "main", tabIndex: -1 });
  const links = pages.map((p) => el("a", { href: `#${p.name}` }, icon(p.icon, 18), el("span", {}, p.title)));
  const theme = el("button.quiet", {
    type: "button", title: "Dark or light", "aria-label": "Dark or light",
    onclick: () => setTheme(document.documentElement.dataset.theme === "dark" ? "light" : "dark"),
  }, icon("sun"));
  document.body.replaceChildren(
    el("a.skip", { href: "#main", onclick: (e) => { e.preventDefault(); main.focus(); } }, "To the content"),
    el("aside", {},
      el("div.brand", {}, icon("face", 18), "surfaced"),
      el("nav", { "aria-label": "Pages" }, links),
      el("div.who", {},
        el("strong", {}, who.name || "no token"),
        el("span.dim", {}, asleep ? "shows alone" : who.scopes.join(" · ")),
        who.groups.length > 0 && el("span.dim", {}, `only ${who.groups.join(", ")}`),
        el("div.row", {}, theme,
          el("button.quiet", { type: "button", "aria-label": asleep ? "Unlock" : "Lock", onclick: () => lock() }, icon("lock"), el("span", {}, asleep ? "Unlock" : "Lock"))))),
    main);

  const mine = session;
  let opened = 0;
  const open = async () => {
    const turn = ++opened;
    const { name, asked } = address();
    const wanted = PAGES.find((p) => p.name === name);
    const page = wanted ? pages.find((p) => p === wanted) : pages.find((p) => p.name === LANDING.find(([scope]) => who.scopes.includes(scope))?.[1]);
    document.querySelector("dialog")?.close();
    session.close?.();
    session.close = null;
    session.page = page;
    document.body.classList.toggle("door", page?.name === "live" && asked.has("door"));
    links.forEach((a, i) => {
      if (pages[i] === page) a.setAttribute("aria-current", "page");
      else a.removeAttribute("aria-current");
    });
    if (!page) return main.replaceChildren(wanted ? notFor(wanted, pages) : el("p", {}, "This token has no scope that a page needs."));
    document.title = `${page.title} – surfaced`;
    main.replaceChildren(waiting());
    const module = await import(`./${page.name}.js`).catch((e) => e);
    if (session !== mine || turn !== opened) return; // locked, or another page was asked for
    if (!module.open) return main.replaceChildren(failed({ status: 0, message: "The daemon cannot be reached." }, open));
    session.close = module.open(main, who, asked);
    if (document.activeElement === document.body) main.focus(); // what had it is gone
  };
  session.open = open;
  open();
}

/** How much of a file the daemon has, while it is being sent for longer than a moment. */
const sending = el("progress.sending", { max: 1, hidden: true, "aria-label": "Sending the scan" });
let began = 0;
addEventListener("sending", ({ detail: share }) => {
  if (share === null || share === 1) began = 0;
  else began ||= Date.now();
  sending.hidden = !began || Date.now() - began < 300;
  sending.value = share ?? 0;
  if (!sending.isConnected) document.body.append(sending);
});

addEventListener("hashchange", () => session?.open());
// A 401 in the middle of work: the token was revoked, or has expired.
addEventListener("expired", () => session && lock("The token is not valid any more."));
for (const name of ["pointerdown", "keydown"]) addEventListener(name, awake, { passive: true });
// A file that misses its place would replace the page.
for (const name of ["dragover", "drop"]) addEventListener(name, (e) => e.preventDefault());
addEventListener("pagehide", () => lock());
// A page that is loaded again has no token: what reloads it loads what it shows instead, and what leaves it asks first.
addEventListener("keydown", (e) => {
  if (!session || e.shiftKey || !(e.key === "F5" || (e.key === "r" && (e.ctrlKey || e.metaKey)))) return;
  e.preventDefault();
  session.open();
});
addEventListener("beforeunload", (e) => session?.who.id && e.preventDefault());
// A page of a tool in which nobody is asked for a token (--no-auth) opens by itself.
unlock("").catch(() => showLock(""));
