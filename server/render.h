/* render.h -- what the daemon responds, as JSON.
 * Texts returned are heap, NUL-terminated, released by free(); NULL: out of memory. */
#ifndef SERVER_RENDER_H
#define SERVER_RENDER_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "store.h"

struct asymmetry;
struct describe_comparison;
struct describe_times;
struct errmap;
struct face;
struct frame;
struct json;
struct scan_found;
struct dry_run;

/* render_problem(m, detail, request_id): RFC 9457.
 * render_problem_begin(...): the same, for further members (base/json.h). */
char *render_problem(const struct errmap *m, const char *detail, const char *request_id);
struct json *render_problem_begin(const struct errmap *m, const char *detail,
                                  const char *request_id);

/* As describe.h. */
char *render_comparison(const struct describe_comparison *c);
char *render_asymmetry(const struct asymmetry *a, const struct face *f,
                       const struct scan_found *scan, const char *engine,
                       const struct describe_times *times);

char *render_dry_run(const struct dry_run *t, const struct face *f,
                     const struct describe_times *times);

/* render_enrolled(t, frame, scan, how): a template with what was found in the scan that it was sent
 * as, and its frame, for the reasons of its quality; how: as in describe_template(). */
char *render_enrolled(const struct store_template *t, const struct frame *frame,
                      const struct scan_found *scan, bool how);
char *render_template(const struct store_template *t, bool how);
char *render_subject(const struct store_subject *s, const struct store_template *t,
                     size_t n, bool how);

/* render_subjects(s, n, more): one page; more: another one follows. */
char *render_subjects(const struct store_subject *s, size_t n, bool more);
char *render_erased(const struct store_receipt *r);
char *render_challenge(const char *nonce, const char *expires);
char *render_state(const char *state); /* {"status": state} */
char *render_version(const char *version);

#endif
