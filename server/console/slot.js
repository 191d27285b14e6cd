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

/** put(file) is called with what was dropped or chosen, and with null once it was taken out again.  most: as many files
 *  of one person are taken, s.files; of more none is, which s.wrong says.  pair(files): if given, takes two at once. */
export function createSlot(letter, put, most = 1, pair = null) {
  const several = most > 1, empty = several ? `Drop up to ${most} files of one sitting, or choose them` : "Drop a file or choose one";
  const name = el("strong", {}, "New scan"), about = el("span.dim", {}, empty);
  const badge = el("span.badge", { hidden: true });
  const input = el("input", { type: "file", "aria-label": letter ? `Scan ${letter}` : "Scan", multiple: several || pair !== null, onchange: () => input.files.length && take([...input.files]) });
  const out = el("button.quiet.out", { type: "button", hidden: true, title: "Take it out", "aria-label": letter ? `Take scan ${letter} out` : "Take the scan out",
    onclick: () => {
      input.value = "";
      take([]);
      input.focus();
    } }, icon("close"));
  const box = el(`div.slot${letter && `.${letter.toLowerCase()}`}`, droppable((_, files) => take([...files])), letter && el("span.letter", { "aria-hidden": "true" }, letter), el("span.text", {}, name, about), badge, input, out);
  const wrong = el("p.error", { role: "alert" });
  const s = {
    box, input, wrong, label, take, files: [],
    get file() { return s.files[0] ?? null; },
    set file(f) { s.files = f ? [f] : []; },
  };

  /** scan, quality: what the daemon said of it. */
  function label(scan, quality) {
    name.textContent = s.files.length > 1 ? `${s.files.length} scans of one person` : s.file?.name ?? "New scan";
    about.textContent = !s.file ? empty
      : scan && s.files.length === 1 ? `${count(scan.points_read)} points${scan.units ? `, ${scan.units}` : ""}` : `${count(Math.ceil(s.files.reduce((sum, f) => sum + f.size, 0) / 1024))} KB`;
    badge.hidden = quality == null;
    if (quality != null) badge.textContent = `quality ${quality.toFixed(2)}`;
    out.hidden = !s.file;
  }

  function take(files) {
    if (pair && files.length === 2) return pair(files);
    const excess = files.length > most;
    const up = several ? `send up to ${most}, all of one person in one sitting` : "two are compared. Several of one sitting are taken under Identify and on a person's page";
    wrong.textContent = excess ? `${files.length} files are too many: ${up}. None was taken.` : "";
    if (excess) {
      input.value = "";
      return;
    }
    s.files = files.slice(0, most);
    label();
    put(s.file);
  }
  return s;
}
