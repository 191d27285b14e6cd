/* recent.h -- the latest verifications and enrolments, and why some were refused: in
 * memory alone, for a guard at a door.  Any thread. */
#ifndef SERVER_RECENT_H
#define SERVER_RECENT_H
#include <stddef.h>
#include <stdint.h>
#include "request.h"

#define RECENT_MOST 1000

struct recent;

struct recent_entry {
    uint64_t seq;  /* 1, 2, ... since the daemon's start */
    int64_t at_ms; /* of the epoch */
    char kind[8];  /* "verify", "enroll" */
    char subject[STORE_SUBJECT_MAX + 1];
    char token_name[STORE_NAME_MAX + 1];
    char request_id[REQUEST_ID_MAX + 1];
    const char *outcome; /* a decision, "enrolled", "known", "refused" */
    const char *code;    /* of a refusal; static; NULL: none */
    char detail[512];    /* with it */
    bool scored;
    double score, threshold, overlap; /* where it is */
};

struct recent *recent_new(void);    /* NULL: no memory */
void recent_free(struct recent *m); /* wiped; NULL is allowed */

/* recent_note(m, r): what came of r, where r->result has a kind. */
void recent_note(struct recent *m, const struct request *r);

/* recent_read(m, after, most, out, last): the latest entries, `most` of them, beyond seq `after`,
 * oldest first; returns how many.  *last: the newest one's seq, 0: there is none. */
size_t recent_read(struct recent *m, uint64_t after, size_t most,
                   struct recent_entry *out, uint64_t *last);

#endif
