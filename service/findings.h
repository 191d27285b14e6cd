/* findings.h -- faults of a database, with advice, for daemon and command. */
#ifndef SERVICE_FINDINGS_H
#define SERVICE_FINDINGS_H
#include <stdint.h>
#include "store.h"

struct json; /* json.h */

enum findings_severity { FINDINGS_OK, FINDINGS_WARNING, FINDINGS_ERROR };

struct finding {
    enum findings_severity severity;
    const char *about, *what, *todo; /* topic, finding, advice ("" for FINDINGS_OK) */
};

struct findings {
    void (*tell)(void *arg, const struct finding *f); /* receives each finding */
    void *arg;
    unsigned errors; /* number of findings with FINDINGS_ERROR so far */
};

/* findings_say(x, severity, about, todo, format, ...): Reports one finding to x->tell(). */
__attribute__((format(printf, 5, 6))) void
findings_say(struct findings *x, enum findings_severity severity, const char *about,
             const char *todo, const char *format, ...);

#define FINDINGS_COUNT 32

/* findings_count(out, n): Writes n as people read it, "100,286", and returns the text, in out. */
const char *findings_count(char out[FINDINGS_COUNT], uint64_t n);

/* findings_store(x, s): Reports findings on templates, tokens, failed verifications, the quality of scans (drift.h)
 * and the calibration, for the model that s uses.  Does not verify the rows (store_verify()). */
void findings_store(struct findings *x, struct store *s);

/* findings_word(severity): Returns "ok", "warning" or "error". */
const char *findings_word(enum findings_severity severity);

/* findings_describe(j, f): Writes a finding, as members of the object that is open in j. */
void findings_describe(struct json *j, const struct finding *f);

#endif
