// A client by the types that openapi-typescript makes of /openapi.json: tests/box/client-openapi.sh
// compiles and runs it.  It compiles only where the description has the members that are used here.
import type { components, paths } from "./api";

type Problem = components["schemas"]["Problem"];
type Json<Response> = Response extends { content: { "application/json": infer J } } ? J : never;
type Success<Operation> = Operation extends { responses: infer R } ? Json<R[Extract<keyof R, 200 | 201>]> : never;
type Posts = { [P in keyof paths]: paths[P] extends { post: object } ? P : never }[keyof paths];
type Query<P extends Posts> = paths[P] extends { post: { parameters: { query?: infer Q } } } ? Q : never;

export async function client(url: string, token: string, enrol: Blob, probe: Blob): Promise<string[]> {
  const headers = { Authorization: `Bearer ${token}`, "Content-Type": "application/octet-stream" };

  async function post<P extends Posts>(route: P, subject: string, body: Blob, query?: Query<P>): Promise<Success<paths[P]["post"]> | Problem> {
    const path = route.replace("{subject}", encodeURIComponent(subject));
    const parameters = new URLSearchParams(query as Record<string, string> | undefined);
    const response = await fetch(`${url}${path}?${parameters}`, { method: "POST", headers, body });
    return (await response.json()) as Success<paths[P]["post"]> | Problem;
  }

  const lines: string[] = [];
  const check = await post("/v1/check", "", enrol, { units: "mm" });
  if ("type" in check) throw new Error(check.detail);
  lines.push(`enrollable ${check.enrollable}`, ...check.advice);
  const enrolled = await post("/v1/subjects/{subject}/templates", "alice", enrol, { label: "first" });
  if ("type" in enrolled) throw new Error(enrolled.detail);
  if ("template_id" in enrolled) lines.push(`label ${enrolled.label}, quality ${enrolled.quality.score > 0.5}`);
  const verified = await post("/v1/subjects/{subject}/verify", "alice", probe);
  if ("type" in verified) throw new Error(verified.detail);
  const decision: "match" | "no_match" | "inconclusive" = verified.decision;
  lines.push(decision);
  if ("score" in verified && verified.score !== undefined && verified.threshold !== undefined)
    lines.push(`above ${verified.score >= verified.threshold}`);
  const found = await post("/v1/identify", "", probe, { candidates: 2 });
  if ("type" in found) throw new Error(found.detail);
  if ("candidates" in found) lines.push(`${found.decision} ${found.subject} of ${found.searched}, ${found.candidates?.[0].subject}`);
  const nobody = await post("/v1/subjects/{subject}/verify", "nobody", probe);
  if (!("type" in nobody)) throw new Error("nobody was verified");
  const code: Problem["code"] = nobody.code;
  lines.push(code);
  return lines;
}
