// enroll.js -- a scan of a person: looked at first, then enrolled or verified once that is confirmed.

import { get, post, query, request } from "./api.js";
import { camera } from "./camera.js";
import { dayEnd, el, icon, many, say, time } from "./dom.js";
import { readSeen } from "./glb.js";
import { copies, createReport, requestId, scanInWords } from "./report.js";
import { createSlot } from "./slot.js";
import { createStage } from "./stage.js";
import { advice, checked, compared, facts, qualityOf, verdict } from "./verdict.js";
import { attempt, dialog, failed, field, VERBATIM } from "./widgets.js";

const ID = /[A-Za-z0-9._@:\-]{1,128}/;

const at = (subject, what) => `/v1/subjects/${encodeURIComponent(subject)}/${what}`;

/** The place of a scan beside the picture of it.  ready(file, r): it was checked; r: null: not. */
function scanning(d, file, verifying, ready) {
  const stage = createStage(), said = el("div.side");
  const slot = createSlot("", look), lens = camera(() => look(slot.file));
  let stop = null;

  async function look(f) {
    stop?.abort();
    const own = (stop = new AbortController());
    ready(f, null);
    if (!f || !await lens.ready([f])) {
      said.replaceChildren();
      return stage.clear();
    }
    d.element.classList.add("busy");
    try {
      const { extras: r, nodes } = readSeen(await request("POST", `/v1/check${query({ detail: "surface", ...lens.values })}`, { body: f, binary: true, stop: own.signal }));
      if (nodes) stage.show(nodes, false);
      else stage.clear();
      slot.label(r.scan, qualityOf(r));
      said.replaceChildren(...[checked(r, verifying), advice(r)].filter(Boolean));
      say(said.querySelector(".verdict")?.textContent);
      ready(f, r);
    } catch (e) {
      if (e.name === "AbortError") return;
      stage.clear();
      said.replaceChildren(failed(e, () => look(f)));
    } finally {
      if (own === stop) d.element.classList.remove("busy");
    }
  }
  if (file) {
    slot.file = file;
    slot.label();
    look(file);
  }
  return { slot: [slot.box, lens.element], lens, stage, said, close: () => { stop?.abort(); stage.close(); } };
}

/** Enrolls a scan of subject, or of whoever is typed in; done() is called once something was stored.
 *  file: what was dropped already. */
export function enroll({ who, subject, file, done }) {
  let scan = null, found = null, parts = null, added = false;
  const d = dialog(subject ? `Enroll a scan of ${subject}` : "Enroll somebody", { wide: true, closed: () => parts.close() });
  const id = el("input", {
    type: "text", required: true, maxLength: 128, pattern: ID.source, ...VERBATIM, oninput: () => update(),
  });
  const label = el("input", { type: "text", maxLength: 64, autocomplete: "off" });
  const consent = el("input", { type: "text", maxLength: 128, autocomplete: "off" });
  const ends = el("input", { type: "date" });
  const error = el("p.error", { role: "alert" }), wrong = el("p.error", { role: "alert" });
  const button = el("button.primary", { type: "submit", disabled: true }, "Enroll");
  const force = el("button.danger", { type: "button", hidden: true, onclick: () => send(force, true) }, "Enroll anyway");
  const name = () => subject ?? id.value.trim();

  function update() {
    const strange = !subject && [...id.value].filter((c) => !ID.test(c));
    wrong.textContent = strange?.length ? `An id has letters a to z, digits and . _ - @ : alone, and no ${strange.includes(" ") ? "space" : `“${strange[0]}”`}.` : "";
    id.setAttribute("aria-invalid", wrong.textContent !== "");
    button.disabled = !found?.enrollable || !(subject || (id.value && id.checkValidity()));
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
        response = await post(at(name(), `templates${query({ label: label.value, force: forced ? "true" : "", ...parts.lens.values })}`), scan);
      } catch (e) {
        force.hidden = e.code !== "sample_mismatch" || !who.scopes.includes("manage");
        throw e;
      }
    });
    if (!ok) return;
    form.replaceChildren(
      verdict("ok", "yes", "Enrolled", el("p", {}, `A template of ${name()} was made of the scan.`),
        el("p.dim", {}, `Template ${response.template_id}`)),
      el("div.buttons", {}, el("button.primary", { type: "button", autofocus: true, onclick: d.close }, "Done")));
    form.querySelector("button").focus();
    done();
  }

  parts = scanning(d, file, false, (f, r) => {
    [scan, found] = [f, r];
    error.textContent = "";
    update();
  });
  const form = el("form", { onsubmit: (e) => { e.preventDefault(); send(button, false); } },
    ...(subject ? [] : [field("Id", id, "Letters, digits and . _ - @ :"), wrong]),
    ...parts.slot, parts.said,
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
  let scan = null, checkedAs = null, parts = null, shown = null;
  const d = dialog(`Verify a scan as ${subject}`, { wide: true, closed: () => { report.close(); parts.close(); done(); } });
  const error = el("p.error", { role: "alert" });
  const button = el("button.primary", { type: "submit", disabled: true }, "Verify");
  const before = attempts.failures ? `${many(attempts.failures, "attempt")} failed already. ` : "None has failed so far. ";

  async function send() {
    let r, nodes;
    const id = requestId(), path = at(subject, `verify${query({ detail: detail ? "surface" : "", ...parts.lens.values })}`);
    if (!await attempt(button, error, async () => {
      ({ extras: r, nodes } = readSeen(await request("POST", path, { body: scan, binary: detail, headers: { "X-Request-Id": id } })));
    })) return;
    if (nodes) parts.stage.show(nodes, true);
    const { cards, known } = compared(r), template = r.template_id && ["Template", r.template_id];
    shown = {
      title: `A verification of ${subject}`, at: `${time(new Date().toISOString())} UTC`, cards: copies(cards),
      sides: [["A", subject, "as enrolled"], ["B", scan.name, scanInWords(checkedAs.scan, qualityOf(checkedAs))]],
      facts: [...known, template, ["Request", id], ["Token", who.name]],
    };
    report.ready(true);
    form.replaceChildren(...[...cards, known.length > 0 && facts(known),
      el("div.buttons", {}, report.buttons[0], el("button.primary", { type: "button", onclick: d.close }, "Done"))].filter(Boolean));
    form.querySelector("button.primary").focus();
  }

  parts = scanning(d, null, true, (f, r) => {
    [scan, checkedAs] = [f, r];
    button.disabled = !r?.usable;
  });
  const report = createReport(parts.stage, () => shown);
  const form = el("form", { onsubmit: (e) => { e.preventDefault(); send(); } },
    el("p.advice", {}, icon("warning", 18), el("span", {}, "This counts as an attempt, as at a door: if it fails, the next one may have to wait. ",
      el("strong", {}, before), "To look at two scans without that, use Try.")),
    detail && el("p.dim", {}, "The enrolled face is shown with it; the audit log records that."),
    ...parts.slot, parts.said, error,
    el("div.buttons", {}, el("button", { type: "button", onclick: d.close }, "Cancel"), button));
  d.body.append(el("div.scanning", {}, parts.stage.element, form));
  form.querySelector("input").focus();
}
