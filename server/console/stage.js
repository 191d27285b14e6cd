// stage.js -- the picture of one or two surfaces: the view, its layers, the legend, the line between
// A and B, values at places of the face, and the section.

import { el, mm, signed, svg } from "./dom.js";
import { createCutter, createSection, cutOf, planeOf } from "./section.js";
import { createView, SCALE } from "./view.js";

/** end: of the scale; limit: the lines' amount; sign -1: what is positive is blue. */
const PART = { name: "_PART", title: "What decided", end: 0.6, limit: 0.15, sign: -1, ends: ["against", "for"],
  about: "What each place adds to the score: blue for, orange against one person. Places that say little stay pale." };
const GAP = { end: 3, limit: 1, sign: 1, ends: ["mm in front", "mm behind"], mm: true };
const LAYERS = [PART,
  { ...GAP, name: "_REST_MM", title: "Without change", about: "How far B lies in front of A, without what a face's movement and ageing explain." },
  { ...GAP, name: "_GAP_MM", title: "As measured", about: "How far B lies in front of A, as measured." }];
const PLAIN = [{ layer: "curtain", title: "A | B", about: "Both faces, laid over each other. Drag the line; hold Space to swap them." },
  { layer: "beside", title: "A and B", about: "Both faces beside each other; they turn together." }];
/** The second scale of a gap: for hair, glasses, a beard. */
const WIDER = { end: 10, limit: 3, wider: true };
const SCAN = "Solid: the face that was found. Dots: what else the scan has.";
const KEYS = "Arrow keys turn the surfaces, plus and minus change their size. Shift with an arrow key moves the cross, Enter labels the place under it, Escape removes the labels.";
const MOST_PINS = 6;

/** The colours of the surfaces, as an element has them. */
const colors = (of = document.documentElement) => {
  const style = getComputedStyle(of);
  return Object.fromEntries(["none", "skin", "dots", "a", "b"].map((k) => [k, style.getPropertyValue(`--${k.length > 1 ? k : `skin-${k}`}`).trim()]));
};

/** The region of a place of the frame, as core/face/grid.c has it. */
function regionAt([x, y]) {
  const away = Math.abs(x);
  if (y > 46) return "forehead";
  if (y < -50) return "chin";
  if (away < 18 && y > -12 && y < 34) return "nose";
  if (away < 50 && y > 14) return "eyes";
  return away < 34 && y < -12 ? "mouth" : "cheeks";
}

/** The scale with a histogram of what is shown (square roots), and a mark for what is pointed at. */
function createLegend() {
  const element = svg("svg", { class: "legend", viewBox: "0 0 120 330", "aria-hidden": "true" });
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
    element.classList.toggle("wide", Boolean(layer.wider));
    element.replaceChildren(
      svg("defs", {}, svg("linearGradient", { id, gradientUnits: "userSpaceOnUse", x1: 0, y1: 20, x2: 0, y2: 280 }, ...bands.reverse())),
      ...bins.map((n, i) => svg("rect", { class: "bin", fill: `url(#${id})`, x: 62 - 56 * Math.sqrt(n / most), y: 20 + (i * 260) / 48 + 0.5,
        width: 56 * Math.sqrt(n / most), height: 260 / 48 - 1 })),
      svg("rect", { class: "colors", x: 66, y: 20, width: 10, height: 260, rx: 3, fill: `url(#${id})` }),
      ...[-1, 1].map((k) => svg("rect", { class: "tick", x: 62, y: y(layer, k * layer.limit) - 0.6, width: 18, height: 1.2 })),
      label(4, layer.ends[0], 71, "middle"), label(297, layer.ends[1], 71, "middle"),
      ...[layer.end, layer.limit, 0, -layer.limit, -layer.end].map((v) =>
        label(y(layer, layer.sign * v), v === 0 ? "0" : signed(layer.sign * v, Number.isInteger(v) ? 0 : 2))),
      svg("rect", { class: "none", x: 6, y: 313, width: 10, height: 10, rx: 3 }), label(318, "not compared", 22),
      mark);
  }
  function point(layer, value) {
    mark.setAttribute("d", value == null ? "" : `M64 ${y(layer, value)}l-9 -5v10z`);
  }
  return { element, show, point };
}

/** A radio group that looks like tabs; choices: [value, title]; chosen(value). */
function createTabs(label, chosen) {
  const element = el("div.tabs", { role: "radiogroup", "aria-label": label });
  element.addEventListener("keydown", (e) => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[e.key], all = [...element.children];
    if (!step) return;
    e.preventDefault();
    const next = all[(all.indexOf(document.activeElement) + step + all.length) % all.length];
    next.click();
    next.focus();
  });
  return {
    element,
    set: (choices) => element.replaceChildren(...choices.map(([value, title], i) =>
      el("button", { type: "button", role: "radio", value, "aria-checked": "false", tabIndex: i ? -1 : 0, onclick: () => chosen(value) }, title))),
    choose: (value) => [...element.children].forEach((b, i) => {
      const some = [...element.children].some((x) => x.value === value);
      b.setAttribute("aria-checked", b.value === value);
      b.tabIndex = b.value === value || (!some && i === 0) ? 0 : -1;
    }),
  };
}

/** The labels at places of the face: what lies there, in mm, in parts of the score, and by region. */
function createPins(view, layerOf) {
  const element = el("ul.pins", { "aria-label": "Labels" });
  let pins = [];
  const words = (found) => [`${mm(Math.abs(found.gap), 1)} ${found.gap < 0 ? "behind" : "in front"}`, `${signed(found.part, 2)} · ${regionAt(found.at)}`];
  function move() {
    const shown = Boolean(layerOf()?.name);
    for (const pin of pins) {
      const { x, y, faces } = view().project(pin);
      pin.element.hidden = !shown;
      pin.element.classList.toggle("away", !faces);
      pin.element.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
      pin.element.classList.toggle("left", x > element.parentElement.clientWidth * 0.6);
    }
  }
  function set(next) {
    pins = next;
    element.replaceChildren(...pins.map((pin) => pin.element));
    move();
  }
  return {
    element, move, words,
    add(found) {
      const pin = { ...found }, [gap, part] = words(found);
      pin.element = el("li.pin", {}, el("button", { type: "button", "aria-label": `${gap}, ${part}. Remove the label`,
        onclick: () => set(pins.filter((p) => p !== pin)) }, el("strong", {}, gap), el("span", {}, part)));
      set([...pins, pin].slice(-MOST_PINS)); // the oldest goes
    },
    clear: () => set([]),
    get some() { return pins.length > 0; },
  };
}

let stages = 0;

export function createStage() {
  const canvas = el("canvas", { tabIndex: 0, role: "application", "aria-label": "The surfaces", "aria-roledescription": "3D picture" });
  const about = el("p.about"), tip = el("div.tip", { hidden: true }), said = el("p.sr", { role: "status" });
  const cross = el("span.cross", { hidden: true, "aria-hidden": "true" });
  const legend = createLegend(), section = createSection();
  const keys = el("p.sr", { id: `stage-keys-${++stages}` }, KEYS);
  canvas.setAttribute("aria-describedby", keys.id);
  const handle = el("div.handle", { role: "slider", tabIndex: 0, "aria-label": "The line between A and B", "aria-valuemin": 0, "aria-valuemax": 100 },
    el("span", {}, "A ⇔ B"));
  const tabs = createTabs("What is shown", setLayer);
  const poses = el("div.tabs.poses", {}, [["front", "Front"], ["three", "Three-quarter"], ["profile", "Profile"]].map(([name, title]) =>
    el("button", { type: "button", onclick: () => view?.pose(name) }, title)));
  // for fingers, which have no space bar
  const swap = el("button.tabs.blink", { type: "button", hidden: true, tabIndex: -1, "aria-hidden": "true", oncontextmenu: (e) => e.preventDefault() }, "Hold to swap");
  for (const [name, on] of [["pointerdown", true], ["pointerup", false], ["pointerleave", false], ["pointercancel", false]])
    swap.addEventListener(name, (e) => {
      e.preventDefault(); // the focus stays: leaving the canvas ends a swap
      view?.swap(on);
      handle.classList.toggle("swapped", on);
    });
  const wider = el("button.tabs.wider", { type: "button", hidden: true, "aria-pressed": "false", onclick: () => {
    wide = !wide;
    setLayer(shown);
  } }, "±10 mm");
  const sectionButton = el("button.tabs", { type: "button", "aria-pressed": "false", onclick: () => setCut(cut ? null : presets().profile) }, "Section");
  const scene = el("div.scene", {}, canvas, legend.element, handle, wider, tip, cross);
  const cutTabs = createTabs("Where it is cut", (name) => setCut(presets()[name]));
  const range = (label, low, high, unit) => el("input", { type: "range", min: low, max: high, step: 1, "aria-label": label, "aria-valuetext": "", oninput: fromRanges, "data-unit": unit });
  const place = range("Place of the cut, mm from the middle of the face", -90, 90, "mm");
  const turn = range("Turn of the cut, degrees", -89, 90, "degrees");
  const cutPanel = el("section.section", { hidden: true, "aria-label": "Section" },
    el("div.ranges", {}, el("label", {}, "Place", place), el("label", {}, "Turn", turn)), section.picture, section.said);
  const top = el("div.row.wrap", {}, tabs.element), bottom = el("div.row.wrap", {}, poses, sectionButton, cutTabs.element, swap);
  const element = el("div.stage", {}, top, about, scene, bottom, cutPanel, said, keys);
  let nodes = null, layer = null, shown = null, wide = false, share = 0.5, cut = null, cutters = [], aim = null;

  const view = createView(canvas, { drawn: () => pins.move(), tapped: (x, y) => pin(x, y), drawing: () => cut !== null, lined: (plane) => setCut(cutOf(plane)) });
  const pins = createPins(() => view, () => layer);
  scene.append(pins.element);
  scene.hidden = !view;
  canvas.frameTime = view?.time; // for tests
  canvas.cutTime = (turn, place) => view.time(() => {
    setCut({ turn, tilt: 0, place });
    section.picture.getBoundingClientRect();
  });
  cutTabs.set([["profile", "Profile"], ["nose", "Nose"], ["eyes", "Eyes"]]);

  const theme = () => view?.setTheme(colors());
  theme();
  addEventListener("theme", theme);

  function update() {
    handle.hidden = swap.hidden = layer !== "curtain" || !view;
    handle.style.left = `${share * 100}%`;
    handle.setAttribute("aria-valuenow", Math.round(share * 100));
    wider.hidden = !layer?.mm || !view;
    wider.setAttribute("aria-pressed", wide);
    sectionButton.hidden = !view || !nodes?.template && !nodes?.face;
    scene.classList.toggle("two", layer === "beside");
  }

  /** The layer of a name; on the wider scale, if that is chosen. */
  function layerOf(name) {
    const of = LAYERS.find((l) => l.name === name);
    return of ? (wide && of.mm ? { ...of, ...WIDER } : of) : name;
  }

  function setLayer(name) {
    shown = name;
    layer = layerOf(name);
    tabs.choose(name);
    about.textContent = layer?.wider ? `${layer.about} The scale is the wider one, ±10 mm.` : layer?.about ?? PLAIN.find((p) => p.layer === name)?.about ?? SCAN;
    legend.element.classList.toggle("off", !layer?.name || !view);
    if (layer?.name) legend.show(layer, nodes.probe[name].filter((_, i) => nodes.probe.color[4 * i + 3]));
    aimAt(null);
    view?.setLayer(layer);
    update();
  }

  // ---- the line between A and B
  const move = (to) => {
    share = Math.max(0.02, Math.min(0.98, to));
    view?.curtain(share);
    update();
  };
  handle.addEventListener("pointerdown", (e) => handle.setPointerCapture(e.pointerId));
  handle.addEventListener("pointermove", (e) => {
    const box = scene.getBoundingClientRect();
    if (handle.hasPointerCapture(e.pointerId)) move((e.clientX - box.left) / box.width);
  });
  handle.addEventListener("keydown", (e) => {
    const step = { ArrowLeft: -0.02, ArrowRight: 0.02 }[e.key];
    if (!step) return;
    e.preventDefault();
    move(share + step);
  });

  // ---- what is at a place: under the pointer, or under the cross that keys move
  function tell(x, y) {
    const found = layer?.name ? view?.pick(x, y) : null;
    if (layer?.name) legend.point(layer, found?.value);
    tip.hidden = !found;
    if (!found) return "No surface here.";
    if (found.none) tip.replaceChildren("Not compared");
    else tip.replaceChildren(el("strong", {}, `${signed(found.part, 2)} to the score here`),
      el("span", {}, `${mm(Math.abs(found.gap))} ${found.gap < 0 ? "behind" : "in front"}; without change ${mm(Math.abs(found.rest))}`));
    tip.style.left = `${Math.min(x + 14, scene.clientWidth - 190)}px`;
    tip.style.top = `${Math.min(y + 14, scene.clientHeight - 60)}px`;
    return found.none ? "Not compared." : pins.words(found).join(", ");
  }
  function pin(x, y) {
    const found = layer?.name ? view.pick(x, y) : null;
    if (!found || found.none) return false;
    pins.add(found);
    return true;
  }
  /** Puts the cross at a place; null: none. */
  function aimAt(next) {
    aim = next;
    cross.hidden = !aim;
    tip.hidden = true;
    if (layer?.name) legend.point(layer, null);
    if (!aim) return;
    cross.style.transform = `translate(${aim[0]}px, ${aim[1]}px)`;
    said.textContent = tell(...aim);
  }
  canvas.addEventListener("pointermove", (e) => {
    if (e.buttons || !view || aim) return void (tip.hidden = !aim);
    const box = canvas.getBoundingClientRect();
    tell(e.clientX - box.left, e.clientY - box.top);
  });
  canvas.addEventListener("pointerdown", () => aimAt(null));
  canvas.addEventListener("pointerleave", () => {
    if (!aim) aimAt(null);
  });
  canvas.addEventListener("blur", () => aimAt(null));
  canvas.addEventListener("keydown", (e) => {
    if (!layer?.name) return;
    const step = e.shiftKey && { ArrowLeft: [-12, 0], ArrowRight: [12, 0], ArrowUp: [0, -12], ArrowDown: [0, 12] }[e.key];
    const middle = [canvas.clientWidth / 2, canvas.clientHeight / 2];
    if (step) {
      const from = aim ?? middle;
      aimAt([Math.max(0, Math.min(2 * middle[0] - 1, from[0] + step[0])), Math.max(0, Math.min(2 * middle[1] - 1, from[1] + step[1]))]);
    } else if (e.key === "Enter") {
      if (!aim) aimAt(middle);
      else if (pin(...aim)) said.textContent = `Labelled: ${said.textContent}`;
    } else if (e.key === "Escape" && (pins.some || aim)) {
      pins.clear();
      aimAt(null);
    } else {
      return;
    }
    e.preventDefault();
  });

  // ---- the section
  const solid = () => nodes.template ?? nodes.face;

  /** Cuts that are offered: from top to chin, and across the nose's tip and the eyes. */
  function presets() {
    const { at } = solid();
    let tip = 0, high = -Infinity;
    for (let v = 0; v < at.length; v += 3)
      if (at[v + 2] > high && regionAt([at[v], at[v + 1]]) === "nose") [tip, high] = [at[v + 1], at[v + 2]];
    return { profile: { turn: 0, tilt: 0, place: 0 }, nose: { turn: 90, tilt: 0, place: tip }, eyes: { turn: 90, tilt: 0, place: 30 } };
  }

  /** Shows the section of a cut {turn, tilt, place}; null: none. */
  function setCut(next) {
    cut = next;
    sectionButton.setAttribute("aria-pressed", cut !== null);
    cutPanel.hidden = cutTabs.element.hidden = !cut;
    element.classList.toggle("cutting", cut !== null);
    view?.setCut(cut && planeOf(cut));
    if (!cut) return;
    const known = Object.entries(presets()).find(([, p]) => ["turn", "tilt", "place"].every((k) => Math.abs(p[k] - cut[k]) < 0.01));
    cutTabs.choose(known?.[0]);
    for (const [input, value] of [[place, cut.place], [turn, cut.turn]]) {
      input.value = value;
      input.setAttribute("aria-valuetext", `${Math.round(value)} ${input.dataset.unit}`);
    }
    drawCut();
  }
  function fromRanges() {
    setCut({ turn: Number(turn.value), tilt: cut.tilt, place: Number(place.value) });
  }
  function drawCut() {
    const width = cutPanel.clientWidth - 24 || 600;
    if (cut) section.draw(cutters, planeOf(cut), width, Math.min(216, 0.55 * width));
  }
  const observer = new ResizeObserver(() => {
    drawCut();
    if (aim) aimAt(null); // another place is under it
  });
  observer.observe(cutPanel);
  observer.observe(scene);

  function clear() {
    nodes = null;
    cutters = [];
    setCut(null);
    pins.clear();
    tabs.element.hidden = poses.hidden = true;
    about.textContent = "";
    legend.element.classList.add("off");
    layer = shown = null;
    view?.show({});
    update();
  }

  clear();
  return {
    element, clear,
    /** nodes of a file; layered: two surfaces that were compared; what: is shown, in a sentence. */
    show(given, layered, what = SCAN) {
      const first = nodes === null, old = cut;
      nodes = given;
      cutters = [solid(), nodes.probe].map((n) => (n ? createCutter(n) : null));
      tabs.element.hidden = !layered || !view;
      poses.hidden = !view;
      pins.clear();
      view?.show(given, first ? "three" : null);
      if (layered) {
        tabs.set([...LAYERS.map((l) => [l.name, l.title]), ...PLAIN.map((p) => [p.layer, p.title])]);
        setLayer(shown ?? PART.name);
      } else {
        setLayer(null);
        about.textContent = what;
      }
      setCut(solid() ? old ?? (view ? null : presets().profile) : null);
      if (!view) about.textContent = "This browser shows no 3D here (WebGL2); the section and the numbers are complete without it.";
    },
    /** What a sheet of paper shows: pictures with their titles, and a section; colours as the element has them. */
    sheet(paper) {
      const of = colors(paper), two = Boolean(nodes?.probe), drawing = createSection();
      const shots = !nodes || !view ? [] : two
        ? [["A", { layer: "a", pose: "three" }], ["B", { layer: "b", pose: "three" }], ["What decided: blue for, orange against one person", { layer: PART, pose: "front" }]]
        : [["Front", { pose: "front" }], ["Three-quarter", { pose: "three" }], ["Profile", { pose: "profile" }]];
      if (nodes && solid()) drawing.draw(cutters, planeOf(cut ?? presets().profile), 680, 186);
      return {
        shots: shots.map(([title, as]) => [title, view.picture(560, 640, { cut: null, ...as, colors: of })]),
        section: nodes && solid() ? drawing : null,
      };
    },
    /** What is seen, as a canvas of twice its size. */
    picture: () => view?.picture(2 * canvas.clientWidth, 2 * canvas.clientHeight),
    close: () => {
      removeEventListener("theme", theme);
      observer.disconnect();
      view?.close();
    },
    view,
  };
}
