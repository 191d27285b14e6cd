/* log_walk.h -- a walk along the logs that reports what is not as it was written, with the keys of
 * the database or with the public key alone. */
#ifndef DB_LOG_WALK_H
#define DB_LOG_WALK_H
#include "log_entry.h"

typedef void log_report(void *arg, enum log_name log, uint64_t seq, const char *line);

struct log_walk {
    log_report *report;
    void *arg;
    const struct crypt *crypt;       /* NULL: MACs are not verified */
    unsigned char public[CRYPT_KEY]; /* that signs the changes */
    enum log_name log;               /* that it walks along: first the changes */
    uint32_t daemon;                 /* whose accesses */
    struct log_end at;               /* the last entry */
    struct log_end
        accesses[LOG_DAEMONS]; /* the end of each by the last change that names it */
    struct log_end trimmed[LOG_DAEMONS]; /* what they follow, by the last trim */
    uint64_t entries, problems;          /* walked, reported */
    uint64_t changes;                    /* of the entries, and the last of them: */
    struct log_end head;
    uint64_t checkpoints;    /* with a signature of the key */
    uint64_t signed_to;      /* the last of them, 0: none */
    uint64_t bad;            /* the first of the entries that are wrong just now */
    bool lost;               /* what came before is missing */
    enum log_name first_log; /* of the least entry that a problem is about, */
    uint64_t first;          /* and that entry, 0: none */
};

/* log_walk_begin(w, crypt, public, report, arg): from the first change.
 * log_walk_accesses(w): the changes have ended; from here on the accesses, a daemon's after the
 * other's.
 * log_walk_step(w, entry): the next entry.  A run of wrong ones is one report.
 * log_walk_damaged(w, seq): an entry that cannot be read.
 * log_walk_end(w): the accesses have ended too, or they are not walked.  Without keys, those after
 * the last that a change found are nobody's. */
void log_walk_begin(struct log_walk *w, const struct crypt *crypt,
                    const unsigned char public[CRYPT_KEY], log_report *report, void *arg);
void log_walk_accesses(struct log_walk *w);
void log_walk_step(struct log_walk *w, const struct log_entry *entry);
void log_walk_damaged(struct log_walk *w, uint64_t seq);
void log_walk_end(struct log_walk *w);

/* log_walk_problem(w, seq, line): report a problem of the caller's own. */
void log_walk_problem(struct log_walk *w, uint64_t seq, const char *line);

#endif
