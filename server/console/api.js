// api.js -- requests to the daemon that served this page.  The token is in memory alone: it is gone
// with the page and on locking.

import { reason } from "./dom.js";

let token = null;

/** What the daemon refused, in its own words: RFC 9457. */
export class Refusal extends Error {
  constructor(status, problem, wait) {
    super(problem.detail ? reason(problem.detail) : problem.title ?? `the daemon responded ${status}`);
    const { code = "", frames, templates } = problem;
    Object.assign(this, { status, code, frames, templates, wait });
  }
}

/** Where a path of the daemon is: beside the folder of this file, also behind a proxy's prefix. */
export const url = (path) => new URL(`..${path}`, import.meta.url).href;

export const setToken = (text) => (token = text);

/** "?a=1&b=2" of what is not empty, or "". */
export function query(of) {
  const given = Object.entries(of).filter(([, value]) => value !== "" && value != null);
  return given.length ? `?${new URLSearchParams(given)}` : "";
}

const BYTES = "application/octet-stream";

/** What a browser takes a scan's file for, by its name, may be wrong (.obj: an image): the daemon looks for itself. */
function asBytes(form) {
  const out = new FormData();
  for (const [name, file] of form) out.append(name, new File([file], file.name, { type: BYTES }));
  return out;
}

/** Sends a file or a form; the share that was sent is told by an event, as fetch() tells none. */
function sendFile(method, to, headers, body, stop) {
  return new Promise((done, failed) => {
    const x = new XMLHttpRequest();
    x.open(method, to);
    for (const [name, value] of Object.entries(headers)) x.setRequestHeader(name, value);
    x.responseType = "arraybuffer";
    x.upload.onprogress = (e) => dispatchEvent(new CustomEvent("sending", { detail: e.lengthComputable ? e.loaded / e.total : null }));
    x.onloadend = () => dispatchEvent(new CustomEvent("sending", { detail: null }));
    x.onload = () => done(new Response([204, 304].includes(x.status) ? null : x.response, {
      status: x.status,
      headers: x.getAllResponseHeaders().trim().split("\r\n").filter(Boolean).map((line) => [line.slice(0, line.indexOf(":")), line.slice(line.indexOf(":") + 1).trim()]),
    }));
    x.onerror = () => failed(new TypeError("no connection"));
    x.onabort = () => failed(new DOMException("aborted", "AbortError"));
    if (stop?.aborted) return x.onabort();
    stop?.addEventListener("abort", () => x.abort());
    x.send(body);
  });
}

/** The response; of what failed a Refusal.  body: a FormData or File as it is, anything else as JSON. */
async function ask(method, path, { body, stop, headers = {} } = {}) {
  const form = body instanceof FormData, file = body instanceof Blob;
  const all = { ...headers };
  if (token !== null) all.Authorization = `Bearer ${token}`;
  if (body !== undefined && !form) all["Content-Type"] = file ? BYTES : "application/json";
  let response;
  try {
    response = form || file ? await sendFile(method, url(path), all, form ? asBytes(body) : new Blob([body]), stop)
      : await fetch(url(path), {
        method, headers: all, signal: stop, cache: "no-store", credentials: "omit", redirect: "error",
        referrerPolicy: "no-referrer", body: body && JSON.stringify(body),
      });
  } catch (e) {
    if (e.name === "AbortError") throw e;
    throw new Refusal(0, { code: "unreachable", detail: "the daemon cannot be reached" });
  }
  if (response.status === 401 && token !== null) dispatchEvent(new Event("expired"));
  if (response.ok) return response;
  const problem = await response.json().catch(() => ({}));
  throw new Refusal(response.status, problem, Number(response.headers.get("Retry-After")) || null);
}

/** The response's JSON, or with binary its bytes (ArrayBuffer) if it is none.  stop: an AbortSignal. */
export async function request(method, path, { binary, ...options } = {}) {
  const response = await ask(method, path, options);
  if (binary && response.headers.get("Content-Type") !== "application/json") return response.arrayBuffer();
  return response.status === 204 ? null : response.json();
}

/** Calls act() now and every so many ms, but while nobody sees the page; until what it returns is called. */
export function repeat(ms, act) {
  let timer = 0, done = false;
  async function next() {
    if (!document.hidden) await act();
    if (!done) timer = setTimeout(next, ms);
  }
  next();
  return () => {
    done = true;
    clearTimeout(timer);
  };
}

const QUIET_MS = 40e3; // the daemon sends something each 15 s: a connection without it is dead
const AGAIN_MS = [500, 15e3]; // first and longest pause before the next try

/** The messages of a text/event-stream, one after the other: {id, event}; event: null: only where it is now. */
async function* messages(body, alive) {
  const reader = body.pipeThrough(new TextDecoderStream()).getReader();
  let rest = "";
  for (;;) {
    const { value, done } = await reader.read();
    if (done) return;
    alive();
    const blocks = (rest + value).split("\n\n");
    rest = blocks.pop();
    for (const block of blocks) {
      const field = (name) => block.split("\n").find((line) => line.startsWith(`${name}: `))?.slice(name.length + 2);
      yield { id: field("id"), event: JSON.parse(field("data") ?? "null") };
    }
  }
}

/** Follows the daemon's events, over every loss of the connection; until what it returns is called.
 *  last: how many of those before are told first.  tell(e, fresh): each; fresh: it happens now.
 *  state(problem): null once the daemon sends, the Refusal once it does not. */
export function follow({ last, tell, state }) {
  const end = new AbortController();
  let cursor = null, pause = AGAIN_MS[0], wake = null;

  async function read() {
    const own = new AbortController(), stop = AbortSignal.any([own.signal, end.signal]);
    let timer = 0, fresh = cursor !== null;
    const alive = () => {
      clearTimeout(timer);
      timer = setTimeout(() => own.abort(), QUIET_MS);
    };
    alive();
    try {
      if (!fresh) { // those before, and where they end
        const page = await (await ask("GET", `/v1/events${query({ last })}`, { stop })).json();
        page.events.forEach((e) => tell(e, false));
        cursor = page.next_cursor;
      }
      const response = await ask("GET", "/v1/events", { stop, headers: { Accept: "text/event-stream", "Last-Event-ID": cursor } });
      [pause] = AGAIN_MS;
      state(null);
      for await (const { id, event } of messages(response.body, alive)) {
        if (event) tell(event, true);
        cursor = id ?? cursor;
      }
    } finally {
      clearTimeout(timer);
      own.abort();
    }
  }

  async function run() {
    while (!end.signal.aborted) {
      const problem = await read().then(() => new Refusal(0, { detail: "the daemon has ended the connection" }), (e) => e);
      if (end.signal.aborted) return;
      if (problem.status >= 400 && problem.status < 500) cursor = null; // of a log that is not this one
      state(problem instanceof Refusal ? problem : new Refusal(0, { detail: "the connection was lost" }));
      await new Promise((go) => {
        wake = go;
        setTimeout(go, pause * (0.5 + Math.random() / 2));
      });
      pause = Math.min(2 * pause, AGAIN_MS[1]);
    }
  }
  const now = () => wake?.();
  addEventListener("online", now);
  run();
  return () => {
    removeEventListener("online", now);
    end.abort();
  };
}

export const get = (path, options) => request("GET", path, options);
export const post = (path, body, options) => request("POST", path, { body, ...options });
