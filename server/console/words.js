// words.js -- what the daemon's words mean, for whoever stands at a door.

import { VERDICTS } from "./verdict.js";

/** Why a scan or a request was refused, by code; others are in the daemon's words. */
export const WHY = {
  too_many_attempts: "Locked out: too many verifications failed.",
  too_many_subjects: "This token has tried too many people without a match.",
  too_many_searches: "This token has searched too often without a match.",
  gallery_unavailable: "Nobody can be identified for now.",
  subject_disabled: "This person is disabled: nobody is verified as them until somebody enables them.",
  subject_expired: "This person's time is over.",
  not_found: "Nobody is enrolled under this id.",
  no_face: "No face was found in the scan.",
  several_faces: "There was more than one face before the scanner.",
  low_quality: "The scan is too poor: scan again.",
  replayed: "This is a scan that was used before: scan again.",
  mirrored: "The scanner swaps left and right.",
  already_enrolled: "This face is enrolled already, under another id.",
  sample_mismatch: "The new scan does not fit the person's first one.",
  too_few_points: "The scan has too few points.",
  not_a_face: "What was scanned is no face.",
  units_suspicious: "The scan is far larger or smaller than a face: its unit is wrong.",
  too_many_templates: "This person has as many templates as a person can have.",
  unauthorized: "The token was wrong.",
  insufficient_scope: "The token may not do that.",
  capture_required: "The scan is not signed by a scanner.",
  capture_invalid: "The scan is not signed by a scanner that is known.",
  capture_stale: "The scanner took too long: scan again.",
  capture_replayed: "This is a scan that was used before: scan again.",
  liveness_failed: "The scanner has seen no living face.",
  storage_full: "The disk is full.",
  busy: "The daemon had too much to do.",
  malformed: "The request could not be read.",
  invalid_parameter: "The request asked for something that does not exist.",
  body_too_large: "The file is too large.",
  too_many_points: "The scan has too many points.",
  not_finite: "The scan has points without a place.",
  out_of_range: "The scan has points that are too far away.",
  degenerate: "The points of the scan are no surface.",
  several_people: "The scans are not all of one person.",
  forbidden: "The token may not do that.",
  unsupported_media_type: "The file is no scan.",
  damaged_content_encoding: "The file is damaged.",
};

/** What came of an event, by its type and outcome, or by its type; of a refusal see WHY. */
export const REASONS = {
  "verify match": "The shape of the face speaks for them.",
  "verify no_match": "The shape of the face speaks against them.",
  "verify inconclusive": "Too little of the face could be compared, or the scan was too noisy: scan again.",
  "identify match": "The shape of the face speaks for them, and for nobody else who was searched.",
  "identify no_match": "Nobody who was searched is alike enough.",
  "identify inconclusive": "The scan, or the number of people, allows no decision: scan again.",
  "enroll enrolled": "A template was made of the scan.",
  enroll_mismatch: "The new scan does not fit the person's first one.",
  locked_out: "Too many verifications failed.",
  attempts_reset: "They can be verified again.",
  many_subjects: "This token has failed for many people.",
  attempts_pattern: "Failures between the matches of one person: somebody else may be trying.",
};

/** What an entry of the audit log is about: its title, and its group. */
export const KINDS = {
  verify: ["Verification", "Doors"],
  identify: ["Identification", "Doors"],
  refused: ["Refused", "Doors"],
  capture: ["Capture refused", "Doors"],
  candidate: ["Listed as a candidate", "Doors"],
  locked_out: ["Locked out", "Doors"],
  many_subjects: ["Many people tried", "Doors"],
  attempts_pattern: ["Failures between matches", "Doors"],
  reset_attempts: ["Lock-out ended", "Doors"],
  compare: ["Two scans compared", "Doors"],
  add_subject: ["Person added", "People"],
  enroll: ["Scan enrolled", "People"],
  enroll_mismatch: ["Scan did not fit", "People"],
  set_subject: ["Consent changed", "People"],
  set_groups: ["Groups changed", "People"],
  opt_in: ["May be searched for", "People"],
  opt_out: ["Opted out of searches", "People"],
  rename_subject: ["Renamed", "People"],
  disable_subject: ["Disabled", "People"],
  enable_subject: ["Enabled", "People"],
  hold_subject: ["Put on hold", "People"],
  release_subject: ["Hold released", "People"],
  delete_template: ["Template deleted", "People"],
  delete_subject: ["Person erased", "People"],
  surface: ["Enrolled face looked at", "Faces seen"],
  compare_templates: ["Templates compared", "Faces seen"],
  explain: ["Decision explained", "Faces seen"],
  export_template: ["Template exported", "Faces seen"],
  create_token: ["Token made", "Keys"],
  rotate_token: ["Token rotated", "Keys"],
  revoke_token: ["Token revoked", "Keys"],
  add_device: ["Scanner added", "Keys"],
  remove_device: ["Scanner removed", "Keys"],
  rekey: ["New master key", "Keys"],
  create_database: ["Database made", "Database"],
  calibrate: ["Calibrated", "Database"],
  reencode: ["Templates re-encoded", "Database"],
  import: ["Imported", "Database"],
  create_archive: ["Archive made", "Database"],
  restore: ["Restored", "Database"],
  accept_state: ["State accepted", "Database"],
  checkpoint: ["Log signed", "Database"],
  trim_accesses: ["Oldest accesses deleted", "Database"],
  join: ["Daemon joined", "Database"],
  accesses_found: ["Accesses of another daemon confirmed", "Database"],
  export_audit: ["Log exported", "Database"],
};

export const kind = (name) => KINDS[name]?.[0] ?? name;

/** What a token may do with a scope. */
export const SCOPES = {
  verify: "verify people, and compare scans",
  enroll: "enroll people",
  identify: "find out who a scan is of",
  read: "see who is enrolled",
  delete: "erase people",
  manage: "consent, hold, disable, end lock-outs",
  tokens: "make and revoke tokens",
  audit: "see the audit log, live and health",
  events: "follow what happens",
  score: "see the numbers of a non-match",
  detail: "see enrolled faces in 3D",
};

/** The end of a consent is near when it is so many days off; the daemon's filter "ending" has the same. */
const SOON_MS = 30 * 86400e3;

/** What there is to say of a person: icon, kind and title each. */
export function personStates(s) {
  const left = s.expires_at ? Date.parse(s.expires_at) - Date.now() : Infinity;
  const out = [];
  if (s.disabled) out.push({ icon: "off", kind: "unsure", title: "Disabled" });
  if (left <= 0) out.push({ icon: "no", kind: "no", title: "Expired" });
  if (isLocked(s)) out.push({ icon: "lock", kind: "unsure", title: "Locked out" });
  if (!(s.templates.length ?? s.templates)) out.push({ icon: "face", kind: "note", title: "No scan yet" });
  if (!out.length) out.push({ icon: "yes", kind: "ok", title: "Active" });
  if (left > 0 && left < SOON_MS) out.push({ icon: "clock", kind: "unsure", title: "Ends soon" });
  if (s.hold) out.push({ icon: "shield", kind: "note", title: "On hold" });
  return out;
}

export const isLocked = (s) => Date.parse(s.locked_until ?? s.attempts?.locked_until ?? "") > Date.now();

const OUTCOMES = {
  ...VERDICTS,
  enrolled: { icon: "yes", kind: "ok", title: "Enrolled" },
  known: { icon: "yes", kind: "ok", title: "Known already" },
};

/** What an event says in a word, where its outcome does not. */
const EVENTS = {
  "identify no_match": { icon: "no", kind: "no", title: "Nobody found" },
  enroll_mismatch: { icon: "no", kind: "no", title: "Does not fit" },
  locked_out: { icon: "lock", kind: "unsure", title: "Locked out" },
  attempts_reset: { icon: "yes", kind: "note", title: "Lock-out ended" },
  many_subjects: { icon: "warning", kind: "unsure", title: "Many people tried" },
  attempts_pattern: { icon: "warning", kind: "unsure", title: "Failures between matches" },
};

/** Of an event, or of a decision by its name. */
export const outcome = (e) => EVENTS[e.type] ?? EVENTS[`${e.type} ${e.outcome}`] ?? OUTCOMES[e.outcome ?? e] ?? { icon: "warning", kind: "unsure", title: "Refused" };
