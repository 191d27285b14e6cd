// api.js -- requests to the daemon that served this page.  The token is in memory alone: it is gone
// with the page, on locking, and after 15 minutes without a pointer or a key.

let token = null;

/** What the daemon refused, in its own words: RFC 9457. */
export class Refusal extends Error {
  constructor(status, problem, wait) {
    super(problem.detail ?? problem.title ?? `the daemon responded ${status}`);
    Object.assign(this, { status, code: problem.code ?? "", wait });
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

/** The response's JSON, or with binary its bytes (ArrayBuffer) if it is none; of what failed a Refusal.  body: a
 *  FormData or File as it is, anything else as JSON.  stop: an AbortSignal. */
export async function request(method, path, { body, binary, stop, headers = {} } = {}) {
  const raw = body instanceof FormData || body instanceof Blob;
  const all = { ...headers };
  if (token !== null) all.Authorization = `Bearer ${token}`;
  if (body !== undefined && !raw) all["Content-Type"] = "application/json";
  if (body instanceof Blob && !body.type) all["Content-Type"] = "application/octet-stream";
  let response;
  try {
    response = await fetch(url(path), {
      method, headers: all, signal: stop, cache: "no-store", credentials: "omit", redirect: "error",
      referrerPolicy: "no-referrer", body: raw || body === undefined ? body : JSON.stringify(body),
    });
  } catch (e) {
    if (e.name === "AbortError") throw e;
    throw new Refusal(0, { code: "unreachable", detail: "the daemon cannot be reached" });
  }
  if (response.status === 401 && token !== null) dispatchEvent(new Event("expired"));
  if (!response.ok) {
    const problem = await response.json().catch(() => ({}));
    throw new Refusal(response.status, problem, Number(response.headers.get("Retry-After")) || null);
  }
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

export const get = (path, options) => request("GET", path, options);
export const post = (path, body, options) => request("POST", path, { body, ...options });
