/* findings.h -- what is wrong with a database, and what to do: the same from daemon and command. */
#ifndef SERVICE_FINDINGS_H
#define SERVICE_FINDINGS_H
#include "store.h"

struct json; /* json.h */

enum findings_severity { FINDINGS_OK, FINDINGS_WARNING, FINDINGS_ERROR };

struct finding {
    enum findings_severity severity;
    const char *about, *what, *todo; /* todo: "" of FINDINGS_OK */
};

struct findings {
    void (*tell)(void *arg, const struct finding *f);
    void *arg;
    unsigned errors; /* so far */
};

/* findings_say(x, severity, about, todo, format, ...): tell one.
 * findings_store(x, s): of templates, tokens, failed verifications and the calibration, by the model
 * that s is used with; not whether the rows are as they were written (store_verify()).
 * findings_word(severity): "ok", "warning", "error".
 * findings_describe(j, f): members of the object that is open in j. */
__attribute__((format(printf, 5, 6))) void
findings_say(struct findings *x, enum findings_severity severity, const char *about,
             const char *todo, const char *format, ...);
void findings_store(struct findings *x, struct store *s);
const char *findings_word(enum findings_severity severity);
void findings_describe(struct json *j, const struct finding *f);

#endif
