// enroll.js -- scans of a person: looked at first, then enrolled or verified once that is confirmed.

import { get, post, query, request } from "./api.js";
import { createBurst } from "./burst.js";
import { dayEnd, el, icon, many, say, time } from "./dom.js";
import { readSeen } from "./glb.js";
import { copies, createReport, requestId, scanInWords } from "./report.js";
import { createStage } from "./stage.js";
import { advice, checked, compared, facts, qualityOf, verdict } from "./verdict.js";
import { attempt, dialog, failed, field, VERBATIM } from "./widgets.js";

const ENROLLED_AT_ONCE = 20, VERIFIED_AT_ONCE = 10; // files, by the API
const ID = /[A-Za-z0-9._@:\-]{1,128}/;

const at = (subject, what) => `/v1/subjects/${encodeURIComponent(subject)}/${what}`;

/** Of several scans that were checked: how many are good by themselves. */
function counted(all, verifying) {
  const good = all.filter((s) => s.at[0].kind === "ok").length, bad = all.filter((s) => !s.r.usable).length;
  return verdict(good ? "ok" : bad < all.length ? "unsure" : "no", good ? "yes" : bad < all.length ? "unsure" : "no",
    `${good} of ${many(all.length, "scan")} good`,
    el("p", {}, `Each was looked at by itself. Whether they fit each other, and what they give together, is known once they are ${verifying ? "verified" : "enrolled"}.`));
}

/** The place of the scans beside the picture of one.  ready(all): as they were checked; null: they were not. */
function scanning(d, files, verifying, most, ready) {
  const stage = createStage(), said = el("div.side");
  const burst = createBurst({ most, verifying, changed: look, look: show });
  let stop = null;

  function show(scan) {
    if (scan?.nodes) stage.show(scan.nodes, false, burst.files.length > 1 ? `${scan.file.name} alone.` : undefined);
    else stage.clear();
  }

  async function look() {
    stop?.abort();
    const own = (stop = new AbortController());
    ready(null);
    said.replaceChildren();
    d.element.classList.add("busy");
    try {
      const all = await burst.check(own.signal);
      if (own.signal.aborted) return;
      show(burst.best() ?? all?.[0]);
      if (!all) return;
      const { r } = all[0];
      said.replaceChildren(...(all.length > 1 ? [counted(all, verifying)] : [checked(r, verifying), advice(r)]).filter(Boolean));
      say(said.querySelector(".verdict")?.textContent);
      ready(all);
    } catch (e) {
      if (e.name === "AbortError") return;
      stage.clear();
      said.replaceChildren(failed(e, look));
    } finally {
      if (own === stop) d.element.classList.remove("busy");
    }
  }
  if (files.length) burst.take(files);
  return { burst, stage, said, close: () => { stop?.abort(); stage.close(); } };
}

/** Enrolls scans of subject, or of whoever is typed in; done() is called once something was stored.
 *  files: what was dropped already. */
export function enroll({ who, subject, files = [], done }) {
  let found = null, parts = null, added = false;
  const d = dialog(subject ? `Enroll a scan of ${subject}` : "Enroll somebody", { wide: true, closed: () => parts.close() });
  const id = el("input", {
    type: "text", required: true, maxLength: 128, pattern: ID.source, ...VERBATIM, oninput: () => update(),
  });
  const label = el("input", { type: "text", maxLength: 64, autocomplete: "off" });
  const consent = el("input", { type: "text", maxLength: 128, autocomplete: "off" });
  const ends = el("input", { type: "date" });
  const error = el("p.error", { role: "alert" }), wrong = el("p.error", { role: "alert" });
  const fuse = el("select", { onchange: () => update() }, el("option", { value: "" }, "One template of all, with less noise"),
    el("option", { value: "false" }, "A template of each"));
  const how = field("The scans become", fuse);
  const button = el("button.primary", { type: "submit", disabled: true }, "Enroll");
  const force = el("button.danger", { type: "button", hidden: true, onclick: () => send(force, true) }, "Enroll anyway");
  const name = () => subject ?? id.value.trim();

  function update() {
    const strange = !subject && [...id.value].filter((c) => !ID.test(c));
    wrong.textContent = strange?.length ? `An id has letters a to z, digits and . _ - @ : alone, and no ${strange.includes(" ") ? "space" : `“${strange[0]}”`}.` : "";
    id.setAttribute("aria-invalid", wrong.textContent !== "");
    how.hidden = !(found?.length > 1);
    // Of scans that are fused the daemon judges the whole.
    const good = found?.some(({ r }) => r.enrollable || (found.length > 1 && !fuse.value && r.usable));
    button.disabled = !good || !(subject || (id.value && id.checkValidity()));
    button.textContent = name() ? `Enroll ${name()}` : "Enroll";
    force.hidden = true;
  }

  async function send(by, forced) {
    let response;
    const ok = await attempt(by, error, async () => {
      // Consent comes before the first template.
      if (!subject && !added && (consent.value || ends.value)) {
        await post("/v1/subjects", { subject: name(), consent: consent.value || null, expires_at: dayEnd(ends.value) });
        added = true;
      }
      try {
        const { body, values } = parts.burst;
        response = await post(at(name(), `templates${query({ label: label.value, force: forced ? "true" : "", fuse: found.length > 1 ? fuse.value : "", ...values })}`), body);
      } catch (e) {
        parts.burst.became(e, true);
        force.hidden = e.code !== "sample_mismatch" || !who.scopes.includes("manage");
        throw e;
      }
    });
    if (!ok) return;
    parts.burst.became(response);
    const of = response.templates?.filter((t) => t.template_id).length;
    form.replaceChildren(
      verdict("ok", "yes", "Enrolled", el("p", {}, of ? `${name()} has a template of each of ${many(of, "scan")}.`
        : `A template of ${name()} was made of the ${found.length > 1 ? "scans that fit each other" : "scan"}.`),
      response.template_id && el("p.dim", {}, `Template ${response.template_id}`)),
      ...parts.burst.told(response),
      el("div.buttons", {}, el("button.primary", { type: "button", autofocus: true, onclick: d.close }, "Done")));
    form.querySelector("button.primary").focus();
    done();
  }

  parts = scanning(d, files, false, ENROLLED_AT_ONCE, (all) => {
    found = all;
    error.textContent = "";
    update();
  });
  const form = el("form", { onsubmit: (e) => { e.preventDefault(); send(button, false); } },
    ...(subject ? [] : [field("Id", id, "Letters, digits and . _ - @ :"), wrong]),
    ...parts.burst.parts, how, parts.said,
    el("details", {}, el("summary", {}, "Label, consent"),
      field("Label of the scan", label, "Where or how it was made, say"),
      ...(subject ? [] : [field("Reference of the consent", consent), field("The consent ends", ends)])),
    error,
    el("div.buttons", {}, force, el("button", { type: "button", onclick: d.close }, "Cancel"), button));
  d.body.append(el("div.scanning", {}, parts.stage.element, form));
  update();
  (subject ? form.querySelector("input[type=file]") : id).focus();
}

/** Verifies a scan as a door would.  attempts: of the subject; done(): it was counted. */
export function verifyHere({ who, subject, attempts, done }) {
  const detail = who.scopes.includes("detail");
  let parts = null, shown = null;
  const d = dialog(`Verify a scan as ${subject}`, { wide: true, closed: () => { report.close(); parts.close(); done(); } });
  const error = el("p.error", { role: "alert" });
  const button = el("button.primary", { type: "submit", disabled: true }, "Verify");
  const before = attempts.failures ? `${many(attempts.failures, "attempt")} failed already. ` : "None has failed so far. ";

  async function send() {
    let r, nodes;
    const id = requestId(), path = at(subject, `verify${query({ detail: detail ? "surface" : "", ...parts.burst.values })}`);
    if (!await attempt(button, error, async () => {
      try {
        ({ extras: r, nodes } = readSeen(await request("POST", path, { body: parts.burst.body, binary: detail, headers: { "X-Request-Id": id } })));
      } catch (e) {
        parts.burst.became(e, true);
        throw e;
      }
    })) return;
    parts.burst.became(r);
    if (nodes) parts.stage.show(nodes, true);
    const { cards, known } = compared(r), template = r.template_id && ["Template", r.template_id];
    shown = {
      title: `A verification of ${subject}`, at: `${time(new Date().toISOString())} UTC`, cards: copies(cards),
      sides: [["A", subject, "as enrolled"], ["B", parts.burst.name, scanInWords(parts.burst.files.length > 1 ? null : r.scan, r.quality?.score)]],
      facts: [...known, template, ["Request", id], ["Token", who.name]],
    };
    report.ready(true);
    form.replaceChildren(...[...cards, ...parts.burst.told(r), known.length > 0 && facts(known),
      el("div.buttons", {}, report.buttons[0], el("button.primary", { type: "button", onclick: d.close }, "Done"))].filter(Boolean));
    form.querySelector("button.primary").focus();
  }

  parts = scanning(d, [], true, VERIFIED_AT_ONCE, (all) => (button.disabled = !all?.some(({ r }) => r.usable)));
  const report = createReport(parts.stage, () => shown);
  const form = el("form", { onsubmit: (e) => { e.preventDefault(); send(); } },
    el("p.advice", {}, icon("warning", 18), el("span", {}, "This counts as an attempt, as at a door: if it fails, the next one may have to wait. ",
      el("strong", {}, before), "To look at two scans without that, use Try.")),
    detail && el("p.dim", {}, "The enrolled face is shown with it; the audit log records that."),
    ...parts.burst.parts, parts.said, error,
    el("div.buttons", {}, el("button", { type: "button", onclick: d.close }, "Cancel"), button));
  d.body.append(el("div.scanning", {}, parts.stage.element, form));
  form.querySelector("input").focus();
}
