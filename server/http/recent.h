/* recent.h -- the latest verifications and enrolments, with the reasons of refusals, for a guard at a door.  In
 * memory alone.  Any thread. */
#ifndef SERVER_RECENT_H
#define SERVER_RECENT_H
#include <stddef.h>
#include <stdint.h>
#include "request.h"

#define RECENT_MOST 1000

struct recent;

struct recent_entry {
    uint64_t seq;  /* number since the daemon's start: 1, 2, ... */
    int64_t at_ms; /* time, ms since 1970 */
    char kind[12]; /* "verify", "identify", "enroll" */
    char subject[STORE_SUBJECT_MAX + 1];
    char token_name[STORE_NAME_MAX + 1];
    char request_id[REQUEST_ID_MAX + 1];
    const char *outcome; /* a decision, "enrolled", "known" or "refused" */
    const char *code;    /* code of a refusal; static; NULL: no refusal */
    char detail[512];    /* detail of a refusal */
    bool scored;
    double score, threshold, overlap; /* set if scored */
};

/* recent_new(): Returns an empty list.  NULL: no memory. */
struct recent *recent_new(void);

/* recent_free(m): Wipes and releases m.  NULL is allowed. */
void recent_free(struct recent *m);

/* recent_note(m, r): Adds an entry for r if r->result has a kind. */
void recent_note(struct recent *m, const struct request *r);

/* recent_read(m, after, most, out, last): Copies the latest entries with a seq beyond after, at most `most` of
 * them, oldest first.  Returns their number.
 *   last  set to the seq of the newest entry; 0: there is none */
size_t recent_read(struct recent *m, uint64_t after, size_t most,
                   struct recent_entry *out, uint64_t *last);

#endif
