// person.js -- one person: state, consent, templates, attempts, what happened lately; and what can be
// done about them.

import { get, query, request } from "./api.js";
import { cameOf } from "./audit.js";
import { count, day, dayEnd, el, icon, many, moment, refill, save, when } from "./dom.js";
import { enroll, verifyHere } from "./enroll.js";
import { readGlb } from "./glb.js";
import { pairsOf } from "./pairs.js";
import { droppable } from "./slot.js";
import { createStage } from "./stage.js";
import { facts, pairs, verdict } from "./verdict.js";
import { ask, attempt, dialog, failed, field, groupLinks, groupsField, meter, state, table, VERBATIM, waiting } from "./widgets.js";
import { isLocked, kind, personStates } from "./words.js";

const LATELY = 8;

const nameOf = (t) => t.label || t.template_id.slice(0, 8);

/** The state in a sentence. */
function about(s) {
  if (s.disabled) return "Nobody is verified as them until somebody enables them.";
  if (s.expires_at && Date.parse(s.expires_at) <= Date.now()) return "The consent is over: nobody is verified as them, and the next purge erases them.";
  if (isLocked(s)) return `Too many verifications failed: nobody is verified as them until ${moment(s.attempts.locked_until)}.`;
  if (!s.templates.length) return "No scan is enrolled yet: nobody can be verified as them.";
  return "A scan that fits is verified as them.";
}

/** list: the address of the list of people that is gone back to. */
export function openPerson(main, who, subject, list) {
  const may = (scope) => who.scopes.includes(scope);
  const path = `/v1/subjects/${encodeURIComponent(subject)}`;
  const actions = el("div.row");
  const body = el("div", may("enroll") ? droppable((_, files) => person && begin(files)) : {});
  let stage = null, person = null, done = false, together = null;

  async function load() {
    try {
      person = await get(path);
      if (!done) show();
    } catch (e) {
      if (done) return;
      actions.replaceChildren();
      body.replaceChildren(e.status === 404 ? verdict("unsure", "unsure", "Nobody", el("p", {}, "Nobody is enrolled under this id.")) : failed(e, load));
    }
  }

  const change = (what) => request("PATCH", path, { body: what }).then(load);

  /** A button for a change that is asked about first. */
  const asking = (label, title, text, verb, what) =>
    el("button", { type: "button", onclick: () => ask(title, text, verb, () => change(what)) }, label);

  // ---- cards

  function stateCard() {
    const [first, ...others] = personStates(person), held = person.hold;
    return el(`section.card.verdict.${first.kind}`, {},
      el("h2", {}, icon(first.icon, 26), first.title),
      el("p", {}, about(person)),
      others.length > 0 && el("p.states", {}, others.map(state), held && el("span.dim", {}, "and so cannot be erased")),
      el("p.dim", {}, "Added ", when(person.created), ", last seen ", when(person.last_seen), "."),
      may("manage") && el("div.row.wrap", {},
        person.disabled
          ? asking("Enable", `Enable ${subject}?`, "They can be verified again.", "Enable", { disabled: false })
          : asking("Disable", `Disable ${subject}?`, "Nobody is verified as them until somebody enables them. Nothing is erased.",
            "Disable", { disabled: true }),
        held
          ? asking("Release the hold", `Release the hold of ${subject}?`, "They can be erased then, also by the end of the consent.",
            "Release", { hold: false })
          : asking("Hold", `Put ${subject} on hold?`, "They cannot be erased until the hold is released, not even when the consent is over.",
            "Put on hold", { hold: true })));
  }

  function editConsent() {
    const d = dialog("Consent"), error = el("p.error", { role: "alert" });
    const reference = el("input", { type: "text", maxLength: 128, value: person.consent ?? "" });
    const purpose = el("input", { type: "text", maxLength: 128, value: person.purpose ?? "" });
    const ends = el("input", { type: "date", defaultValue: person.expires_at?.slice(0, 10) ?? "" });
    const found = el("input", { type: "checkbox", checked: person.identify });
    const button = el("button.primary", { type: "submit" }, "Save");
    d.body.append(el("form", {
      onsubmit: async (e) => {
        e.preventDefault();
        const what = { identify: found.checked, consent: reference.value || null, purpose: purpose.value || null };
        if (ends.value !== ends.defaultValue) what.expires_at = dayEnd(ends.value); // else its time of day stays
        if (await attempt(button, error, () => change(what))) d.close();
      },
    }, field("Reference", reference, "A number, a file"), field("Purpose", purpose),
    field("Ends", ends, "The last day, UTC; nobody is verified as them after it. Empty: never"),
    el("label.box", {}, found, el("span", {}, "A search among all people may find them", el("span.dim", {}, " – verified they are in any case"))),
    error, el("div.buttons", {}, el("button", { type: "button", onclick: d.close }, "Cancel"), button)));
    reference.focus();
  }

  /** When it was written last, for who may know. */
  function changedAt() {
    const at = el("dd", {}, "–");
    get(`/v1/audit${query({ subject, kind: "set_subject,add_subject", limit: 1 })}`).then(({ entries }) => entries[0] && at.replaceChildren(when(entries[0].at)), () => {});
    return [el("dt", {}, "Recorded"), at];
  }

  const consentCard = () => el("section.card", {},
    el("div.row.between", {}, el("h2", {}, "Consent"),
      may("manage") && el("button.quiet", { type: "button", "aria-label": "Change the consent", onclick: editConsent }, "Change")),
    !person.consent && !person.expires_at && el("p.dim", {}, "None is recorded."),
    el("dl.facts", {}, pairs([person.consent && ["Reference", person.consent], person.purpose && ["Purpose", person.purpose],
      (person.consent || person.expires_at) && ["Ends (UTC)", day(person.expires_at, "never")], ["Searches", person.identify ? "may find them" : "opted out"]]),
    may("audit") && (person.consent || person.expires_at) && changedAt()));

  function editGroups() {
    const d = dialog("Groups"), error = el("p.error", { role: "alert" });
    const groups = groupsField(who.groups.length ? `One or more of ${who.groups.join(", ")}`
      : "Up to 8: a-z 0-9 . _ -; tokens may be bound to them. Empty: none", person.groups);
    const button = el("button.primary", { type: "submit" }, "Save");
    d.body.append(el("form", {
      onsubmit: async (e) => {
        e.preventDefault();
        if (await attempt(button, error, () => change({ groups: groups.value }))) d.close();
      },
    }, groups.element, error, el("div.buttons", {}, el("button", { type: "button", onclick: d.close }, "Cancel"), button)));
    groups.input.focus();
  }

  const groupsCard = () => el("section.card", {},
    el("div.row.between", {}, el("h2", {}, "Groups"),
      may("manage") && el("button.quiet", { type: "button", "aria-label": "Change the groups", onclick: editGroups }, "Change")),
    person.groups.length ? groupLinks(person.groups) : el("p.dim", {}, "None: only tokens that are bound to no group see this person."));

  function attemptsCard() {
    const { failures, locked_until: until } = person.attempts, error = el("p.error", { role: "alert" });
    const locked = isLocked(person);
    const button = el("button", {
      type: "button", onclick: () => attempt(button, error, () => request("DELETE", `${path}/attempts`).then(load)),
    }, locked ? "End the lock-out" : "Forget them");
    return el("section.card", {}, el("h2", {}, "Attempts"),
      el(locked ? "p.advice" : "p", {}, locked && icon("warning", 18), el("span", {}, locked ? `Locked out until ${moment(until)}: ` : "",
        failures ? `${many(failures, "verification")} in a row failed.` : "No verification has failed lately.")),
      failures > 0 && may("manage") && el("div", {}, button), error);
  }

  function lately() {
    const error = el("p.dim"), list = table("What happened lately", [
      ["What", (e) => kind(e.kind)], ["Outcome", cameOf, "dim.why"], ["By", (e) => e.actor_name ?? e.actor, "by"], ["When", (e) => when(e.at), "dim.when"],
    ]);
    get(`/v1/audit${query({ subject, limit: LATELY })}`).then(({ entries }) => list.set(entries), (e) => (error.textContent = e.message)); // it is tried again with the page
    return [el("h2", {}, "What happened lately"), list.element, error, el("p.row.end", {}, el("a", { href: `#audit${query({ subject })}` }, "All of it in Audit"))];
  }

  // ---- templates

  async function look(t, button, error) {
    await attempt(button, error, async () => {
      const { nodes } = readGlb(await request("GET", `/v1/templates/${t.template_id}/surface`, { binary: true }));
      if (done) return;
      stage ??= createStage();
      body.querySelector(".looked").replaceChildren(el("div.row.between", {}, el("h2", {}, `Template ${nameOf(t)}`),
        el("span.dim", {}, "The audit log has recorded that you looked.")), stage.element);
      stage.show(nodes, false, "The face as it is enrolled.");
      body.querySelector(".looked").scrollIntoView({ block: "nearest" });
    });
  }

  function templates() {
    const error = el("p.error", { role: "alert" });
    const list = table("Templates", [
      ["Template", (t) => el("span", { title: t.template_id }, nameOf(t))],
      ["Enrolled", (t) => day(t.created), "dim"],
      ["Points", (t) => count(t.points), "number"],
      ["Quality", (t) => meter(t.quality.score)],
      ["", (t) => el("span.row.end", {},
        may("detail") && el("button", {
          type: "button", "aria-label": `Look at template ${nameOf(t)}`, onclick: (e) => look(t, e.currentTarget, error),
        }, icon("face"), "Look"),
        may("delete") && el("button.quiet", {
          type: "button", title: "Delete the template", "aria-label": `Delete template ${nameOf(t)}`,
          onclick: () => ask("Delete this template?", `Its bytes are overwritten. ${person.templates.length > 1
            ? "The others stay." : "It is the only one: nobody can be verified as them then."}`, "Delete", () => request("DELETE", `/v1/templates/${t.template_id}`).then(load), { danger: true }),
        }, icon("trash"))), "acts"],
    ]);
    list.set(person.templates);
    const ids = person.templates.map((t) => t.template_id).join();
    if (together?.ids !== ids) together = { ids, element: pairsOf(subject) };
    return [person.templates.length ? list.element : el("section.card", {}, el("h2", {}, "No template"),
      el("p.dim", {}, may("enroll") ? "Drop a scan here to enroll the first." : "No scan is enrolled yet.")), error, person.templates.length > 1 && together.element];
  }

  // ---- erasing

  function erase() {
    const d = dialog(`Erase ${subject}?`, { closed: () => { if (erased) location.hash = list; } });
    const error = el("p.error", { role: "alert" });
    let erased = null;
    const typed = el("input", { type: "text", ...VERBATIM, oninput: () => (button.disabled = typed.value !== subject) });
    const button = el("button.danger", { type: "submit", disabled: true }, "Erase for ever");
    const keep = () => save(`erased-${erased.subject_uid}.json`, [JSON.stringify(erased, null, 2), "\n"], "application/json");
    d.body.append(el("form", {
      onsubmit: async (e) => {
        e.preventDefault();
        if (!await attempt(button, error, async () => (erased = await request("DELETE", path)))) return;
        d.body.replaceChildren(
          verdict("ok", "yes", "Erased",
            el("p", {}, `${many(erased.templates_removed, "template")} and all that was known of ${subject} are overwritten.`)),
          el("p", {}, "Keep the receipt: it is signed, and shows when this was done. It cannot be made again. Audit finds what was done about them by the number on it, not by the id."),
          facts([["Erased", moment(erased.erased_at)], ["Number", erased.subject_uid], ["Entry of the log", count(erased.audit.seq)]]),
          el("div.buttons", {}, el("button", { type: "button", onclick: d.close }, "Close"),
            el("button.primary", { type: "button", onclick: keep }, icon("save"), "Save the receipt")));
        d.body.querySelector("button.primary").focus();
      },
    }, el("p", {}, `${many(person.templates.length, "template")}, the consent and the id are overwritten. Nobody can bring them back but from a backup.`),
    field("Type the id to confirm", typed, subject), error,
    el("div.buttons", {}, el("button", { type: "button", onclick: d.close }, "Cancel"), button)));
    typed.focus();
  }

  const eraseCard = () => el("section.card", {}, el("h2", {}, "Erase"),
    person.hold ? el("p.dim", {}, "This person is on hold and cannot be erased.")
      : el("div.row.between", {}, el("span.dim", {}, "You get a signed receipt."), el("button.danger", { type: "button", onclick: erase }, icon("trash"), "Erase …")));

  // ---- the page

  const begin = (files = []) => enroll({ who, subject, files: [...files], done: load });

  function show() {
    actions.replaceChildren(...[
      may("verify") && person.templates.length > 0 && el("button", {
        type: "button", onclick: () => verifyHere({ who, subject, attempts: person.attempts, done: load }),
      }, "Verify a scan"),
      may("enroll") && el("button.primary", { type: "button", onclick: () => begin() }, icon("plus"), "Enroll a scan"),
    ].filter(Boolean));
    const looked = body.querySelector(".looked") ?? el("section.stack.looked");
    refill(body, el("div.try", {},
      el("div.stack", {}, templates(), looked, may("audit") && lately()),
      el("div.side", {}, stateCard(), attemptsCard(), consentCard(), groupsCard(), may("delete") && eraseCard())));
  }

  main.replaceChildren(el("header", {}, el("a.back", { href: list, "aria-label": "Back to the people" }, icon("back", 20)), el("h1.id", {}, subject), actions), body);
  body.append(waiting());
  load();
  return () => {
    done = true;
    stage?.close();
  };
}
