// dom.js -- elements, icons, and how numbers and times are written.  Text enters a page as text
// alone: nothing here takes markup.

/** el("button.primary", {onclick, title, ...}, child, ...): children are nodes, texts, or null. */
export function el(tag, props, ...children) {
  const [name, ...classes] = tag.split(".");
  const e = document.createElement(name);
  if (classes.length) e.className = classes.join(" ");
  for (const [key, value] of Object.entries(props ?? {})) {
    if (value === undefined || value === null || value === false) continue;
    if (key.startsWith("on")) e.addEventListener(key.slice(2), value);
    else if (key in e && key !== "list" && !key.includes("-")) e[key] = value;
    else e.setAttribute(key, value === true ? "" : value);
  }
  e.append(...children.flat().filter((c) => c !== null && c !== undefined && c !== false));
  return e;
}

export function svg(name, attributes, ...children) {
  const e = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes ?? {})) e.setAttribute(key, value);
  e.append(...children);
  return e;
}

/** A place for the chart that draw(width) gives, in pixels of the screen, so that its texts are as large as others: drawn anew
 *  when the place has another width, and on paper no larger. */
export function drawn(draw) {
  const place = el("div");
  let width = 0;
  new ResizeObserver(([{ contentRect }]) => {
    if (contentRect.width < 1 || Math.round(contentRect.width) === width) return;
    const chart = draw(width = Math.round(contentRect.width));
    chart.style.maxWidth = `${width}px`;
    place.replaceChildren(chart);
  }).observe(place);
  return place;
}

const ICONS = {
  face: "M12 3c4 0 7 2.7 7 7.5 0 5.5-3.2 10.5-7 10.5S5 16 5 10.5C5 5.7 8 3 12 3zM9 10h.01M15 10h.01M12 10v4l-1 .6M9.5 17c1.6 1 3.4 1 5 0",
  live: "M12 12h.01M8.5 15.500a5 5 0 0 1 0-7M15.5 8.500a5 5 0 0 1 0 7M5.6 18.400a9 9 0 0 1 0-12.800M18.4 5.600a9 9 0 0 1 0 12.8",
  people: "M9 11a4 4 0 1 0 0-8 4 4 0 0 0 0 8zM2 21v-1a6 6 0 0 1 6-6h2a6 6 0 0 1 6 6v1M16 3.200a4 4 0 0 1 0 7.600M18.5 14.600A6 6 0 0 1 22 20v1",
  audit: "M6 2h8l5 5v15H6zM14 2v5h5M9 12h7M9 16h7",
  health: "M2 12h4l3-8 5 16 3-8h5",
  lock: "M5 11h14v10H5zM8 11V7a4 4 0 0 1 8 0v4",
  sun: "M12 16a4 4 0 1 0 0-8 4 4 0 0 0 0 8zM12 2v2M12 20v2M2 12h2M20 12h2M5 5l1.4 1.400M17.6 17.6 19 19M19 5l-1.4 1.400M6.4 17.6 5 19",
  yes: "M12 21a9 9 0 1 0 0-18 9 9 0 0 0 0 18zM8 12.500l2.7 2.700L16 9.5",
  no: "M12 21a9 9 0 1 0 0-18 9 9 0 0 0 0 18zM9 9l6 6M15 9l-6 6",
  unsure: "M12 21a9 9 0 1 0 0-18 9 9 0 0 0 0 18zM9.5 9.500a2.5 2.5 0 1 1 3.5 2.300c-.7.4-1 .8-1 1.700M12 16.800h.01",
  warning: "M12 4 2.5 20h19zM12 10v5M12 17.500h.01",
  save: "M12 3v12M7 11l5 5 5-5M4 20h16",
  swap: "M4 9h14l-4-4M20 15H6l4 4",
  close: "M6 6l12 12M18 6 6 18",
  search: "M11 18a7 7 0 1 0 0-14 7 7 0 0 0 0 14zM16 16l4.5 4.500",
  plus: "M12 5v14M5 12h14",
  back: "M15 5l-7 7 7 7",
  shield: "M12 3l7.5 3v5.500c0 4.500-3 8-7.5 9.500-4.500-1.500-7.500-5-7.500-9.500V6z",
  off: "M12 21a9 9 0 1 0 0-18 9 9 0 0 0 0 18zM6 6l12 12",
  trash: "M4 7h16M9 7V4h6v3M6 7l1 13h10l1-13M10 11v5M14 11v5",
  key: "M8 18a4.500 4.500 0 1 0 0-9 4.500 4.500 0 0 0 0 9zM11.500 10.500 20 2M16 6l3 3",
  clock: "M12 21a9 9 0 1 0 0-18 9 9 0 0 0 0 18zM12 7v5l3.500 2",
};

/** An icon beside a text that says the same, so that it is hidden from screen readers. */
export function icon(name, size = 16) {
  return svg("svg", { viewBox: "0 0 24 24", width: size, height: size, class: "icon", "aria-hidden": "true" },
    svg("path", { d: ICONS[name] }));
}

export const count = (n) => n.toLocaleString("en");
export const mm = (value, digits = 2) => `${value.toFixed(digits)} mm`;
export const percent = (share) => `${Math.round(share * 100)} %`;
export const signed = (value, digits) => (value < 0 ? "−" : "+") + Math.abs(value).toFixed(digits);

export const plain = (value, digits) => (value < 0 ? "−" : "") + Math.abs(value).toFixed(digits);

/** "2026-11-23 02:29:53": UTC, as the logs have it. */
export const time = (iso) => (iso ? iso.replace("T", " ").replace(/(\.\d+)?Z$/, "") : "–");

const clock = new Intl.DateTimeFormat("sv-SE", { dateStyle: "short", timeStyle: "medium" });
const zone = new Intl.DateTimeFormat("en-GB", { timeZoneName: "short" });

/** "2026-11-23 02:29:53 UTC", and before it the time of the viewer's clock if that is another. */
export function moment(iso) {
  const at = new Date(iso), utc = `${time(iso)} UTC`;
  if (at.getTimezoneOffset() === 0) return utc;
  const name = zone.formatToParts(at).find((p) => p.type === "timeZoneName").value;
  return `${clock.format(at)} ${name} (${utc})`;
}

/** The day, UTC; the moment for who points at it. */
export const day = (iso, none = "–") => (iso ? el("time", { dateTime: iso, title: moment(iso) }, iso.slice(0, 10)) : none);

/** The last moment of a day that was chosen, or null. */
export const dayEnd = (date) => (date ? `${date}T23:59:59Z` : null);

const SPANS = [["year", 365 * 86400], ["month", 30 * 86400], ["day", 86400], ["hour", 3600], ["minute", 60]];
const relative = new Intl.RelativeTimeFormat("en", { numeric: "auto" });

/** "3 days ago", "in 2 months"; what: for null. */
export function away(iso, what = "never") {
  if (!iso) return what;
  const s = (Date.parse(iso) - Date.now()) / 1000;
  const [unit, length] = SPANS.find(([, n]) => Math.abs(s) >= n) ?? [];
  return unit ? relative.format(Math.trunc(s / length), unit) : s > 0 ? "in a moment" : "just now";
}

/** The same as an element that has the moment for who points at it. */
export const when = (iso, what) => (iso ? el("time.ago", { dateTime: iso, title: moment(iso) }, away(iso)) : el("span", {}, away(iso, what)));

/** 402341 s: "4 days 15 h" */
export function span(s) {
  const [d, h, m] = [Math.floor(s / 86400), Math.floor(s / 3600) % 24, Math.floor(s / 60) % 60];
  return d ? `${d} ${d === 1 ? "day" : "days"} ${h} h` : h ? `${h} h ${m} min` : `${m} min`;
}

/** One of them, or many: "1 template", "2 templates". */
export const many = (n, one, others = `${one}s`) => `${count(n)} ${n === 1 ? one : others}`;

/** A reason in the daemon's words, without its name of the only scan, "points: no face", and with the page's name of one of two.
 *  An error begins with a capital (style.css), and a file's name does not. */
export const reason = (text) => text.replace(/^(?=[^\s:]+\.\w{2,4}[: ])/, "Scan ").replace(/^points: ./, (start) => start.at(-1).toUpperCase()).replace(/^([ab])(\.points)?: /, (_, which) => `Scan ${which.toUpperCase()}: `);

/** A rate of false matches in words: "about 1 in 17 million".  least: the lowest that the evaluation supports. */
export function oneIn(rate, least = 0) {
  if (!(rate > 0)) return "fewer than can be told";
  if (rate > 0.095) return `about ${Math.round(rate * 100)} in 100`;
  const n = Number((1 / rate).toPrecision(2)), how = rate <= least ? "fewer than" : "about";
  if (n >= 1e9) return `${how} 1 in ${n / 1e9} billion`;
  if (n >= 1e6) return `${how} 1 in ${n / 1e6} million`;
  return `${how} 1 in ${count(n)}`;
}

/** What is new, for who does not see it: read aloud once what is read now has ended. */
const news = el("div.sr", { id: "news", role: "status" });
export function say(text) {
  if (!news.isConnected) document.body.append(news);
  news.textContent = text;
}

export const labelOf = (e) => e.getAttribute("aria-label") ?? e.textContent.trim();

/** What had the focus under this name, where it was made anew; else the page. */
export function focusAgain(name, within = document.getElementById("main")) {
  const again = name && [...within.querySelectorAll("a, button, input, select, summary")].find((e) => labelOf(e) === name && e.checkVisibility());
  (again || document.getElementById("main"))?.focus({ preventScroll: true });
}

/** Replaces the children of an element; the focus stays with what has the same name. */
export function refill(element, ...children) {
  const held = document.activeElement, name = element.contains(held) && held !== element && labelOf(held);
  element.replaceChildren(...children);
  if (name !== false && !held.isConnected) focusAgain(name, element);
}

/** Offers bytes or a text to be saved under a name. */
export function save(name, parts, type) {
  const url = URL.createObjectURL(new Blob([parts].flat(), { type }));
  el("a", { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 10000);
}
