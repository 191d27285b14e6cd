// tokens.js -- who may ask the daemon: tokens made, rotated and revoked.

import { get, post, request, setToken } from "./api.js";
import { away, day, dayEnd, el, icon, refill, when } from "./dom.js";
import { ask, attempt, dialog, failed, field, groupLinks, groupsField, state, table } from "./widgets.js";
import { SCOPES } from "./words.js";

const SOON_MS = 30 * 86400e3;
const GRACE = [["0", "at once"], ["3600", "in an hour"], ["86400", "in a day"], ["604800", "in a week"]];

function about(t) {
  if (t.revoked_at) return { icon: "no", kind: "no", title: "Revoked" };
  const left = t.expires_at ? Date.parse(t.expires_at) - Date.now() : Infinity;
  if (left <= 0) return { icon: "no", kind: "no", title: "Expired" };
  return left < SOON_MS ? { icon: "clock", kind: "unsure", title: `Ends ${away(t.expires_at)}` } : { icon: "yes", kind: "ok", title: "Valid" };
}

/** A secret is shown once: it is in no response but this. */
function show(d, t) {
  const copied = el("span.dim", { role: "status" }), secret = el("code.shown", { tabIndex: 0 }, t.secret);
  d.body.replaceChildren(el("p", {}, "This is the secret of ", el("strong", {}, t.name), ". Give it to whoever needs it now: it is shown this once, and cannot be seen again."),
    secret, el("div.buttons", {}, copied,
      // without TLS a browser has no clipboard: the text is selected instead
      el("button", { type: "button", onclick: async () => {
        getSelection().selectAllChildren(secret);
        const ok = await navigator.clipboard?.writeText(t.secret).then(() => true, () => false);
        copied.textContent = ok ? "Copied." : "Selected: copy it with the keyboard.";
      } }, "Copy"), el("button.primary", { type: "button", onclick: d.close }, "I have it")));
  d.body.querySelector("button.primary").focus();
}

export function openTokens(body, who, actions, asked) {
  const group = asked.get("group");
  const problem = el("p.error", { role: "alert" });
  let done = false;
  const list = table("Tokens", [
    ["Token", (t) => el("span", {}, t.name, t.id === who.id && el("span.dim", {}, " (this one)")), "name"],
    ["State", (t) => state(about(t))],
    ["May", (t) => el("span.chips", {}, t.scopes.map((s) => el("span.chip", { title: SCOPES[s] ?? "" }, s))), "why"],
    ["People", (t) => (t.groups.length ? groupLinks(t.groups) : el("span.dim", {}, "all people")), "why"],
    ["Last used", (t) => when(t.last_used), "dim"],
    ["Ends (UTC)", (t) => day(t.expires_at, "never"), "dim"],
    ["", (t) => !t.revoked_at && el("span.row.end", {},
      el("button", { type: "button", "aria-label": `Rotate ${t.name}`, onclick: () => rotate(t) }, "Rotate"),
      t.id !== who.id && el("button.quiet", { type: "button", "aria-label": `Revoke ${t.name}`, onclick: () => ask(`Revoke ${t.name}?`,
        "Requests with this token are refused from now on. This cannot be undone, but you can create a new token.", "Revoke",
        () => request("DELETE", `/v1/tokens/${t.id}`).then(load), { danger: true }) }, "Revoke")) || "", "acts"],
  ]);

  async function load() {
    try {
      const { tokens } = await get("/v1/tokens");
      if (done) return;
      const ended = (t) => Boolean(t.revoked_at);
      const shown = tokens.filter((t) => group === null || t.groups.includes(group));
      list.set([...shown.filter((t) => !ended(t)), ...shown.filter(ended)]);
      refill(body, ...[group !== null && el("p.row", {}, "Bound to the group ", el("strong", {}, group), el("a", { href: "#health?tab=tokens" }, "Show all")),
        shown.length ? list.element : el("p", {}, "No token is."), problem].filter(Boolean));
    } catch (e) {
      if (!done) body.replaceChildren(failed(e, load));
    }
  }

  function rotate(t) {
    const d = dialog(`Rotate ${t.name}?`, { closed: load }), error = el("p.error", { role: "alert" });
    const grace = el("select", {}, GRACE.map(([s, title]) => el("option", { value: s, selected: s === "86400" }, title)));
    const button = el("button.primary", { type: "submit" }, "Rotate");
    d.body.append(el("form", { onsubmit: async (e) => {
      e.preventDefault();
      await attempt(button, error, async () => {
        const made = await post(`/v1/tokens/${t.id}/rotate`, { grace_s: Number(grace.value) });
        if (t.id === who.id) setToken(made.secret); // this page goes on with it
        show(d, made);
      });
    } }, el("p", {}, "The token gets a new secret; what it may do stays."), field("The old secret ends", grace, "Long enough to change it wherever it is used"), error,
    el("div.buttons", {}, el("button", { type: "button", onclick: d.close }, "Cancel"), button)));
    button.focus();
  }

  function make() {
    const d = dialog("Make a token", { closed: load }), error = el("p.error", { role: "alert" });
    const name = el("input", { type: "text", required: true, maxLength: 64, autocomplete: "off", placeholder: "front door" });
    const ends = el("input", { type: "date", required: true, value: new Date(Date.now() + 365 * 86400e3).toISOString().slice(0, 10) });
    const boxes = who.scopes.map((s) => el("input", { type: "checkbox", name: "scope", value: s, onchange: () => (button.disabled = !boxes.some((b) => b.checked)) }));
    const groups = groupsField(who.groups.length ? `One or more of ${who.groups.join(", ")}`
      : "Nobody else exists for the token; it cannot have audit. Empty: all people", group !== null ? [group] : who.groups);
    const button = el("button.primary", { type: "submit", disabled: true }, "Make it");
    d.body.append(el("form", { onsubmit: async (e) => {
      e.preventDefault();
      await attempt(button, error, async () => show(d, await post("/v1/tokens", {
        name: name.value.trim(), scopes: boxes.filter((b) => b.checked).map((b) => b.value), groups: groups.value, expires_at: dayEnd(ends.value),
      })));
    } }, field("Name", name, "Where it is used"),
    el("fieldset", {}, el("legend", {}, "It may"), boxes.map((b) => el("label.box", {}, b, el("span", {}, el("strong", {}, b.value), el("span.dim", {}, ` – ${SCOPES[b.value] ?? ""}`))))),
    groups.element, field("Ends", ends), error,
    el("div.buttons", {}, el("button", { type: "button", onclick: d.close }, "Cancel"), button)));
    name.focus();
  }

  actions.append(el("button.primary", { type: "button", onclick: make }, icon("plus"), "Make a token"));
  load();
  return () => {
    done = true;
  };
}
