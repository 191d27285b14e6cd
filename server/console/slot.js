// slot.js -- a place that a scan is dropped on, or chosen for.

import { count, el } from "./dom.js";

/** Properties of an element on which a file can be dropped. */
export const droppable = (put) => ({
  ondragover: (e) => e.currentTarget.classList.add("over"),
  ondragleave: (e) => e.currentTarget.classList.remove("over"),
  ondrop: (e) => {
    e.stopPropagation();
    e.preventDefault();
    e.currentTarget.classList.remove("over");
    if (e.dataTransfer.files[0]) put(e.dataTransfer.files[0]);
  },
});

/** put(file) is called with what was dropped or chosen. */
export function createSlot(letter, put) {
  const name = el("strong", {}, "New scan"), about = el("span.dim", {}, "Drop a file or choose one");
  const badge = el("span.badge", { hidden: true });
  const input = el("input", { type: "file", "aria-label": letter ? `Scan ${letter}` : "Scan", onchange: () => set(input.files[0]) });
  const box = el(`label.slot${letter && `.${letter.toLowerCase()}`}`, droppable(set), letter && el("span.letter", { "aria-hidden": "true" }, letter), el("span.text", {}, name, about), badge, input);
  const s = { box, input, label, file: null };

  /** scan, quality: what the daemon said of it. */
  function label(scan, quality) {
    name.textContent = s.file?.name ?? "New scan";
    about.textContent = !s.file ? "Drop a file or choose one"
      : scan ? `${count(scan.points_read)} points${scan.units ? `, ${scan.units}` : ""}` : `${count(Math.ceil(s.file.size / 1024))} KB`;
    badge.hidden = quality == null;
    if (quality != null) badge.textContent = `quality ${quality.toFixed(2)}`;
  }

  function set(file) {
    if (!file) return;
    s.file = file;
    label();
    put(file);
  }
  return s;
}
