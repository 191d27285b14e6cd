/* routes.h -- the table of routes, and the handlers in its rows.  A new route is a handler, declared here, a row of
 * the table and a path of openapi.json. */
#ifndef SERVER_ROUTES_H
#define SERVER_ROUTES_H
#include <stdbool.h>
#include <stddef.h>

struct request; /* request.h */
struct route;   /* route.h */
struct worker;  /* worker.h */

/* routes_table(n): Returns the static table, and sets *n to the number of its rows. */
const struct route *routes_table(size_t *n);

/* ---- comparisons: of a probe with the templates of a subject, with one template, with another scan
 * (service/verify.h), and of the templates of a subject with each other (service/pairs.h) */

void compare_subject(struct request *r, struct worker *w);
void compare_template(struct request *r, struct worker *w);
void compare_scans(struct request *r, struct worker *w);
void compare_templates(struct request *r, struct worker *w);

/* ---- enrolment */

/* enroll_handle(r, w): Enrols the scans of the body.  Refuses the subject before it works on them. */
void enroll_handle(struct request *r, struct worker *w);

/* ---- identification */

/* identify_scan_may(r): Returns true if there is a gallery to be searched, and the token may search now.  Else r->response
 * says why not. */
bool identify_scan_may(struct request *r);

void identify_scan(struct request *r, struct worker *w);

/* ---- scans that are not stored, and a template's surface */

/* scans_check(r, w): Reports whether the scan would be accepted, and what to change at the scanner.  With
 * detail=surface responds with a 3D file, if the scan has points. */
void scans_check(struct request *r, struct worker *w);

/* scans_asymmetry(r, w): Compares the scan with its own mirror image. */
void scans_asymmetry(struct request *r, struct worker *w);

/* scans_template(r, w): Sends the surface of a template as GLB, or as PLY with format=ply.  Records it as an
 * export. */
void scans_template(struct request *r, struct worker *w);

/* ---- subjects, and the descriptions of their templates */

void subjects_list(struct request *r, struct worker *w);
void subjects_show(struct request *r, struct worker *w);
void subjects_add(struct request *r, struct worker *w);
void subjects_change(struct request *r, struct worker *w);
void subjects_delete(struct request *r, struct worker *w);
void subjects_template(struct request *r, struct worker *w);
void subjects_template_delete(struct request *r, struct worker *w);

/* ---- tokens: a client can make, renew and revoke only tokens whose scopes its own token has */

/* tokens_own(r, w): Describes the token of r; without one, all scopes. */
void tokens_own(struct request *r, struct worker *w);

void tokens_list(struct request *r, struct worker *w);
void tokens_create(struct request *r, struct worker *w);
void tokens_rotate(struct request *r, struct worker *w);
void tokens_revoke(struct request *r, struct worker *w);

/* ---- what happens at a door */

/* live_recent(r, w): Lists the latest verifications and enrolments (recent.h), or, with after=SEQ, the newer
 * ones. */
void live_recent(struct request *r, struct worker *w);

/* live_reset(r, w): Deletes the failed attempts on a subject; a lock-out ends. */
void live_reset(struct request *r, struct worker *w);

/* live_reset_token(r, w): Deletes the failed attempts of a token; a lock-out ends. */
void live_reset_token(struct request *r, struct worker *w);

/* watch_events(r, w): GET /v1/events.  The response may come later (r->waits). */
void watch_events(struct request *r, struct worker *w);

/* ---- the audit log.  logs_verify() and logs_export() are slow routes (route.h) */

/* logs_list(r, w): Lists the entries that the query parameters choose. */
void logs_list(struct request *r, struct worker *w);

/* logs_verify(r, w): Verifies the whole log. */
void logs_verify(struct request *r, struct worker *w);

/* logs_export(r, w): Exports the log before it responds: to a file without a name, or, if the export contains the
 * ids of subjects, to memory. */
void logs_export(struct request *r, struct worker *w);

/* ---- the state of the daemon */

/* health_live(r, w): Responds 200 as long as the I/O thread runs. */
void health_live(struct request *r, struct worker *w);

/* health_ready(r, w): Responds 200 and the calibration in force, or 503 and the reason.  It passes the queue like
 * any other request: 200 means that a worker has served it. */
void health_ready(struct request *r, struct worker *w);

/* health_version(r, w): Responds with the version of the program. */
void health_version(struct request *r, struct worker *w);

/* health_stats(r, w): Responds with the state and the statistics of daemon and database. */
void health_stats(struct request *r, struct worker *w);

/* ---- the files for a browser, which are part of the program: the description of the API, /docs and the console.
 * Their Content-Security-Policy allows them to load nothing from other sites. */

/* pages_handle(r, w): Sends the file of the path of r, compressed if the client accepts it, or 304 or 404.  A
 * quick route (route.h). */
void pages_handle(struct request *r, struct worker *w);

/* pages_root(r, w): For "/": 303 to the console; to /docs with --no-console. */
void pages_root(struct request *r, struct worker *w);

/* pages_console(r, w): Like pages_handle(), for /console and its files; 404 with --no-console. */
void pages_console(struct request *r, struct worker *w);

#endif
