// slot.js -- a place that a scan is dropped on, or chosen for.

import { count, el, icon } from "./dom.js";

/** Properties of an element on which a file can be dropped. */
export const droppable = (put) => ({
  ondragover: (e) => e.currentTarget.classList.add("over"),
  ondragleave: (e) => e.currentTarget.classList.remove("over"),
  ondrop: (e) => {
    e.stopPropagation();
    e.preventDefault();
    e.currentTarget.classList.remove("over");
    if (e.dataTransfer.files[0]) put(e.dataTransfer.files[0], e.dataTransfer.files);
  },
});

/** put(file) is called with what was dropped or chosen, and with null once it was taken out again.  several: files are
 *  taken, s.files. */
export function createSlot(letter, put, several = false) {
  const empty = several ? "Drop files or choose them" : "Drop a file or choose one";
  const name = el("strong", {}, "New scan"), about = el("span.dim", {}, empty);
  const badge = el("span.badge", { hidden: true });
  const input = el("input", { type: "file", "aria-label": letter ? `Scan ${letter}` : "Scan", multiple: several, onchange: () => set(input.files[0], input.files) });
  const out = el("button.quiet.out", { type: "button", hidden: true, title: "Take it out", "aria-label": letter ? `Take scan ${letter} out` : "Take the scan out",
    onclick: () => {
      input.value = "";
      fill(null, []);
      input.focus();
    } }, icon("close"));
  const box = el(`div.slot${letter && `.${letter.toLowerCase()}`}`, droppable(set), letter && el("span.letter", { "aria-hidden": "true" }, letter), el("span.text", {}, name, about), badge, input, out);
  const s = { box, input, label, file: null, files: [] };

  /** scan, quality: what the daemon said of it. */
  function label(scan, quality) {
    name.textContent = s.files.length > 1 ? `${s.files.length} scans of one person` : s.file?.name ?? "New scan";
    about.textContent = !s.file ? empty
      : scan ? `${count(scan.points_read)} points${scan.units ? `, ${scan.units}` : ""}` : `${count(Math.ceil(s.file.size / 1024))} KB`;
    badge.hidden = quality == null;
    if (quality != null) badge.textContent = `quality ${quality.toFixed(2)}`;
    out.hidden = !s.file;
  }

  function set(file, files) {
    if (file) fill(file, several ? [...files] : [file]);
  }
  function fill(file, files) {
    s.file = file;
    s.files = files;
    label();
    put(file);
  }
  return s;
}
