// console.js -- the frame: unlocking with a token, the pages that it may see, locking.

import { get, setToken } from "./api.js";
import { el, icon } from "./dom.js";

const IDLE_MS = 15 * 60 * 1000;

/** Who has one of the scopes sees the page, which is the module of its name: loaded once it is opened. */
const PAGES = [
  { name: "try", title: "Try", icon: "face", scopes: ["verify", "enroll", "identify"] },
  { name: "identify", title: "Identify", icon: "search", scopes: ["identify"] },
  { name: "live", title: "Live", icon: "live", scopes: ["audit"] },
  { name: "people", title: "People", icon: "people", scopes: ["read", "enroll"] },
  { name: "audit", title: "Audit", icon: "audit", scopes: ["audit"] },
  { name: "health", title: "Health", icon: "health", scopes: ["audit", "tokens"] },
];

let session = null; // {who, close(): what the open page has to stop}
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

function awake() {
  clearTimeout(idle);
  if (session) idle = setTimeout(() => lock("Locked after 15 minutes without use."), IDLE_MS);
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
    placeholder: "64 characters",
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
        error.textContent = refusal.status === 401 ? "The daemon does not know this token." : refusal.message + wait;
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

function showFrame() {
  const { who } = session;
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
        el("span.dim", {}, who.scopes.join(" · ")),
        who.groups.length > 0 && el("span.dim", {}, `only ${who.groups.join(", ")}`),
        el("div.row", {}, theme,
          el("button.quiet", { type: "button", "aria-label": "Lock", onclick: () => lock() }, icon("lock"), el("span", {}, "Lock"))))),
    main);

  const mine = session;
  let opened = 0;
  const open = async () => {
    const turn = ++opened;
    const name = location.hash.slice(1).split("?")[0];
    const page = pages.find((p) => p.name === name) ?? pages[0];
    document.querySelector("dialog")?.close();
    session.close?.();
    session.close = null;
    links.forEach((a, i) => {
      if (pages[i] === page) a.setAttribute("aria-current", "page");
      else a.removeAttribute("aria-current");
    });
    if (!page) return main.replaceChildren(el("p", {}, "This token has no scope that a page needs."));
    document.title = `${page.title} – surfaced`;
    const module = await import(`./${page.name}.js`).catch(() => null);
    if (session !== mine || turn !== opened) return; // locked, or another page was asked for
    if (!module) return main.replaceChildren(el("p.error", { role: "alert" }, "The daemon cannot be reached."));
    session.close = module.open(main, who, new URLSearchParams(location.hash.split("?")[1]));
    if (document.activeElement === document.body) main.focus(); // what had it is gone
  };
  session.open = open;
  open();
}

addEventListener("hashchange", () => session?.open());
// A 401 in the middle of work: the token was revoked, or has expired.
addEventListener("expired", () => session && lock("The token is not valid any more."));
for (const name of ["pointerdown", "keydown"]) addEventListener(name, awake, { passive: true });
// A file that misses its place would replace the page.
for (const name of ["dragover", "drop"]) addEventListener(name, (e) => e.preventDefault());
addEventListener("pagehide", () => lock());
// A page of a tool in which nobody is asked for a token (--no-auth) opens by itself.
unlock("").catch(() => showLock(""));
