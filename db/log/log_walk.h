/* log_walk.h -- a scan of the logs, entry by entry, that reports entries which are not authentic, missing or
 * out of order.  It uses the keys of the database, or only its public key.  One thread at a time. */
#ifndef DB_LOG_WALK_H
#define DB_LOG_WALK_H
#include "log_entry.h"

/* Receives a problem: the log, the number of the entry, a text. */
typedef void log_report(void *arg, enum log_name log, uint64_t seq, const char *line);

struct log_walk {
    log_report *report;
    void *arg;
    const struct crypt *crypt;       /* NULL: MACs are not verified */
    unsigned char public[CRYPT_KEY]; /* key that verifies the signatures of changes */
    enum log_name log; /* the present log: first the changes, then the accesses */
    uint32_t daemon;   /* number of the daemon of the present access log */
    struct log_end at; /* the last entry of the present log so far */
    /* Ends of the access logs, each by the last change that names it. */
    struct log_end accesses[LOG_DAEMONS];
    struct log_end trimmed[LOG_DAEMONS]; /* last trimmed entry of each access log */
    uint64_t entries, problems;          /* numbers of entries and of problems so far */
    uint64_t changes;                    /* number of entries of the change log */
    struct log_end head;                 /* last entry of the change log */
    uint64_t checkpoints; /* number of entries with a valid signature by public */
    uint64_t signed_to;   /* number of the last entry with one; 0: none */
    uint64_t bad;         /* first entry of the present run of bad entries; 0: no run */
    bool lost;            /* the entries before the next one are missing or unreadable */
    enum log_name first_log; /* log of the entry first; unset if first is 0 */
    uint64_t first;          /* lowest number of an entry with a problem; 0: no problem */
};

/* log_walk_begin(w, crypt, public, report, arg): Begins a walk; the first log_walk_step() takes entry 1 of the
 * change log.
 *   crypt   keys of the database, borrowed; NULL: MACs are not verified
 *   report  called with arg for each problem */
void log_walk_begin(struct log_walk *w, const struct crypt *crypt,
                    const unsigned char public[CRYPT_KEY], log_report *report, void *arg);

/* log_walk_accesses(w): Switches to the access logs: log_walk_step() then takes the entries of one daemon
 * after the other, in the order of their numbers. */
void log_walk_accesses(struct log_walk *w);

/* log_walk_step(w, entry): Verifies the next entry.  A run of bad entries is reported once. */
void log_walk_step(struct log_walk *w, const struct log_entry *entry);

/* log_walk_damaged(w, seq): Takes the next entry, with this number, which cannot be read, as a bad one. */
void log_walk_damaged(struct log_walk *w, uint64_t seq);

/* log_walk_end(w): Ends the walk, after the accesses or, if these are not walked, after the changes.  Without
 * keys it reports the accesses after the last one that a change names: no signature covers them. */
void log_walk_end(struct log_walk *w);

/* log_walk_problem(w, seq, line): Reports a problem that the caller has found in entry seq of the present
 * log. */
void log_walk_problem(struct log_walk *w, uint64_t seq, const char *line);

#endif
