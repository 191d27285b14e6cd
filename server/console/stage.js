// stage.js -- the picture of one or two surfaces: the view, its layers, the legend, the line between
// A and B, and what is under the pointer.

import { el, mm, signed, svg } from "./dom.js";
import { createView, SCALE } from "./view.js";

/** end: of the scale; limit: the lines' amount; sign -1: what is positive is blue. */
const LAYERS = [
  { name: "_PART", title: "What decided", end: 0.6, limit: 0.15, sign: -1, ends: ["against", "for"], digits: 1,
    about: "What each place adds to the score: blue for, orange against one person. Places that say little stay pale." },
  { name: "_REST_MM", title: "Without change", end: 3, limit: 1, sign: 1, ends: ["in front", "behind"], digits: 0, unit: " mm",
    about: "How far B lies in front of A, without what a face's movement and ageing explain." },
  { name: "_GAP_MM", title: "As measured", end: 3, limit: 1, sign: 1, ends: ["in front", "behind"], digits: 0, unit: " mm",
    about: "How far B lies in front of A, as measured." },
];
const CURTAIN = "Both faces, laid over each other. Drag the line; hold Space to swap them.";
const SCAN = "Solid: the face that was found. Dots: the scan as it came.";

const colors = () => {
  const style = getComputedStyle(document.documentElement);
  return Object.fromEntries(["none", "skin", "dots", "a", "b"].map((k) => [k, style.getPropertyValue(`--${k}`).trim()]));
};

/** The scale with a histogram of what is shown (square roots), and a mark for what is pointed at. */
function createLegend() {
  const element = svg("svg", { class: "legend", viewBox: "0 0 120 300", "aria-hidden": "true" });
  const mark = svg("path", { class: "mark", d: "" });
  const y = (layer, value) => 150 - 130 * Math.max(-1, Math.min(1, (layer.sign * value) / layer.end));
  function show(layer, values) {
    const label = (at, what, x = 84, anchor = "start") => {
      const t = svg("text", { x, y: at + 4, "text-anchor": anchor });
      t.textContent = what;
      return t;
    };
    const id = "legend-colors";
    const bands = SCALE.map((c, i) => svg("stop", { offset: 1 - i / 6, "stop-color": c }));
    const bins = new Array(48).fill(0);
    for (const v of values) bins[Math.min(47, Math.max(0, Math.floor(((y(layer, v) - 20) / 260) * 48)))]++;
    const most = Math.max(...bins, 1);
    element.replaceChildren(
      svg("defs", {}, svg("linearGradient", { id, gradientUnits: "userSpaceOnUse", x1: 0, y1: 20, x2: 0, y2: 280 }, ...bands.reverse())),
      ...bins.map((n, i) => svg("rect", { class: "bin", fill: `url(#${id})`, x: 62 - 56 * Math.sqrt(n / most), y: 20 + (i * 260) / 48 + 0.5,
        width: 56 * Math.sqrt(n / most), height: 260 / 48 - 1 })),
      svg("rect", { x: 66, y: 20, width: 10, height: 260, rx: 3, fill: `url(#${id})` }),
      ...[-1, 1].map((k) => svg("rect", { class: "tick", x: 62, y: y(layer, k * layer.limit) - 0.6, width: 18, height: 1.2 })),
      label(4, layer.ends[0], 71, "middle"), label(297, layer.ends[1], 71, "middle"),
      ...[layer.end, layer.limit, 0, -layer.limit, -layer.end].map((v) =>
        label(y(layer, layer.sign * v), v === 0 ? "0" : signed(layer.sign * v, Number.isInteger(v) ? 0 : 2) + (layer.unit ?? ""))),
      mark);
  }
  function point(layer, value) {
    mark.setAttribute("d", value == null ? "" : `M64 ${y(layer, value)}l-9 -5v10z`);
  }
  return { element, show, point };
}

export function createStage() {
  const canvas = el("canvas", { tabIndex: 0, role: "img", "aria-label": "The surfaces. Arrow keys turn them, plus and minus change the size." });
  const about = el("p.about"), tip = el("div.tip", { hidden: true });
  const legend = createLegend();
  const handle = el("div.handle", { role: "slider", tabIndex: 0, "aria-label": "The line between A and B", "aria-valuemin": 0, "aria-valuemax": 100 },
    el("span", {}, "A ⇔ B"));
  const tabs = el("div.tabs", { role: "radiogroup", "aria-label": "What is shown" });
  const poses = el("div.tabs.poses", {}, [["front", "Front"], ["three", "Three-quarter"], ["profile", "Profile"]].map(([name, title]) =>
    el("button", { type: "button", onclick: () => view?.pose(name) }, title)));
  // for fingers, which have no space bar
  const swap = el("button.tabs.blink", { type: "button", hidden: true, tabIndex: -1, "aria-hidden": "true", oncontextmenu: (e) => e.preventDefault() }, "Hold to swap");
  for (const [name, on] of [["pointerdown", true], ["pointerup", false], ["pointerleave", false], ["pointercancel", false]])
    swap.addEventListener(name, (e) => {
      e.preventDefault(); // the focus stays: leaving the canvas ends a swap
      view?.swap(on);
    });
  const element = el("div.stage", {}, canvas, tabs, about, legend.element, handle, tip, poses, swap);
  const view = createView(canvas, update);
  canvas.frameTime = view?.time; // for tests
  let nodes = null, layer = null, share = 0.5;

  const theme = () => view?.setTheme(colors());
  theme();
  addEventListener("theme", theme);

  function update() {
    handle.hidden = swap.hidden = layer !== "curtain" || !view;
    handle.style.left = `${share * 100}%`;
    handle.setAttribute("aria-valuenow", Math.round(share * 100));
    handle.classList.toggle("swapped", Boolean(view?.state().swapped));
  }

  function setLayer(next) {
    layer = next;
    for (const b of tabs.children) {
      const on = b.value === (next === "curtain" ? "curtain" : next?.name);
      b.setAttribute("aria-checked", on);
      b.tabIndex = on ? 0 : -1;
    }
    about.textContent = next === "curtain" ? CURTAIN : next?.about ?? SCAN;
    legend.element.classList.toggle("off", !next || next === "curtain");
    if (next && next !== "curtain") legend.show(next, nodes.probe[next.name].filter((_, i) => nodes.probe.color[4 * i + 3]));
    tip.hidden = true;
    view?.setLayer(next);
    update();
  }

  function setTabs() {
    const choices = [...LAYERS, { name: "curtain", title: "A | B" }];
    tabs.replaceChildren(...choices.map((c) => el("button", {
      type: "button", role: "radio", value: c.name, onclick: () => setLayer(c.title === "A | B" ? "curtain" : c),
    }, c.title)));
  }
  tabs.addEventListener("keydown", (e) => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[e.key], all = [...tabs.children];
    if (!step) return;
    const next = all[(all.indexOf(document.activeElement) + step + all.length) % all.length];
    next.click();
    next.focus();
  });

  // ---- the line between A and B
  const move = (to) => {
    share = Math.max(0.02, Math.min(0.98, to));
    view?.curtain(share);
    update();
  };
  handle.addEventListener("pointerdown", (e) => handle.setPointerCapture(e.pointerId));
  handle.addEventListener("pointermove", (e) => {
    const box = element.getBoundingClientRect();
    if (handle.hasPointerCapture(e.pointerId)) move((e.clientX - box.left) / box.width);
  });
  handle.addEventListener("keydown", (e) => {
    const step = { ArrowLeft: -0.02, ArrowRight: 0.02 }[e.key];
    if (!step) return;
    e.preventDefault();
    move(share + step);
  });

  // ---- what is under the pointer
  canvas.addEventListener("pointermove", (e) => {
    if (e.buttons || !view || !layer || layer === "curtain") return void (tip.hidden = true);
    const box = canvas.getBoundingClientRect(), x = e.clientX - box.left, y = e.clientY - box.top;
    const found = view.pick(x, y);
    legend.point(layer, found?.value);
    tip.hidden = !found;
    if (!found) return;
    tip.replaceChildren(el("strong", {}, `${signed(found.part, 2)} to the score here`),
      el("span", {}, `${mm(Math.abs(found.gap))} ${found.gap < 0 ? "behind" : "in front"}; without change ${mm(Math.abs(found.rest))}`));
    tip.style.left = `${Math.min(x + 14, box.width - 190)}px`;
    tip.style.top = `${Math.min(y + 14, box.height - 60)}px`;
  });
  canvas.addEventListener("pointerleave", () => {
    tip.hidden = true;
    if (layer && layer !== "curtain") legend.point(layer, null);
  });

  function clear() {
    nodes = null;
    tabs.hidden = poses.hidden = true;
    about.textContent = "";
    legend.element.classList.add("off");
    layer = null;
    view?.show({});
    update();
  }

  clear();
  return {
    element, clear,
    /** nodes of a file; layered: two surfaces that were compared; what: is shown, in a sentence. */
    show(given, layered, what = SCAN) {
      const first = nodes === null;
      nodes = given;
      tabs.hidden = !layered;
      poses.hidden = !view;
      view?.show(given, first ? "three" : null);
      if (layered) {
        const old = layer;
        setTabs();
        setLayer(old ?? LAYERS[0]);
      } else {
        setLayer(null);
        about.textContent = what;
      }
      if (!view) {
        tabs.hidden = true;
        about.textContent = "This browser shows no 3D here (WebGL2); the numbers are complete without it.";
      }
    },
    close: () => {
      removeEventListener("theme", theme);
      view?.close();
    },
    view,
  };
}
