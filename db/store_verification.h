/* store_verification.h -- all that a verification or an enrolment's fit check reads, of one
 * moment and in one transaction, and all that it writes, in another. */
#ifndef DB_STORE_VERIFICATION_H
#define DB_STORE_VERIFICATION_H
#include "store_attempts.h"
#include "store_open.h"

struct log_txn;      /* log_txn.h */
struct surface_work; /* libsurface.h */

struct store_snapshot {
    struct store_subject subject; /* expired is set */
    struct store_attempts attempts;
    int64_t calibration; /* the version of the newest, 0: there never was one */
    /* the newest, if that is not what the caller has, or zeros */
    struct store_calibration k;
    struct store_template *t; /* [n], oldest first */
    size_t n;
    struct store_reading *reading; /* until store_snapshot_end() */
};

struct store_snapshot_of {
    const char *subject;     /* whose templates, or NULL and */
    const char *template_id; /* this one and its subject */
    const char *token;       /* whose attempts; NULL: "" */
    int64_t calibration;     /* the version that the caller decides by */
};

/* store_snapshot_begin(s, what, out, e): reads all but the faces; the transaction goes on until
 * store_snapshot_end(), which must be called also after a failure.  ST_ENOTFOUND: no such subject
 * or template; ST_ECORRUPT, also of the newest calibration: then nothing can be decided, or of
 * more templates than STORE_TEMPLATES_MAX.
 * store_snapshot_face(out, i, w, f, e): the face of template i, as store_template_load().
 * store_snapshot_end(out, st, e): st is what came of the reading; returned, unless the end fails.
 * A failed attempt that lies in the future (the clock was set back) is moved to now for good, so
 * that a wait that begins with it ends.  The rest of *out stays, until store_snapshot_free(). */
enum status store_snapshot_begin(struct store *s, const struct store_snapshot_of *what,
                                 struct store_snapshot *out, struct errinfo *e);
enum status store_snapshot_face(const struct store_snapshot *out, size_t i,
                                struct surface_work *w, struct surface_face **f,
                                struct errinfo *e);
enum status store_snapshot_end(struct store_snapshot *out, enum status st,
                               struct errinfo *e);
void store_snapshot_free(struct store_snapshot *out); /* *out is empty again */

enum store_record_as {
    STORE_RECORD_UNCOUNTED, /* attempts are left as they are */
    STORE_RECORD_PASSED,    /* none of the actor's failures are left */
    STORE_RECORD_FAILED     /* one more of the actor */
};

struct store_record {
    const struct store_subject *subject; /* of the snapshot */
    enum store_record_as as;
    const char *actor, *kind, *template_id, *outcome; /* of the event */
    const char
        *decision; /* a word, and the score, for the day; NULL: it is none of its */
    double score;

    /* A probe that matched, which is refused where it is no new scan: the cloud of a template of
     * the subject.  NULL: not asked. */
    const struct store_probe *probe;
    bool replayed; /* with probe: it is known to be no new scan */

    /* By the attempts as they are now, may the verification still be answered?  Others of the
     * subject may have failed since the snapshot.  A failed one can add warnings.  NULL, or without a
     * limit of failures: neither. */
    const struct store_limits *limits;
};

/* Failures of which the operator is to hear, by an event of this name, in the order of enum
 * metrics_warning.
 * STORE_LOCKED_OUT: The failure locks its token out of the subject.
 * STORE_MANY_SUBJECTS: With it the subjects that the token has failed at within STORE_FAILED_MS are
 * another third of limits->subjects.
 * STORE_ATTEMPTS_PATTERN: With it the suspicion of the subject's tokens reaches STORE_SUSPICION. */
enum store_warning {
    STORE_LOCKED_OUT,
    STORE_MANY_SUBJECTS,
    STORE_ATTEMPTS_PATTERN,
    STORE_WARNINGS
};

struct store_recorded {
    enum store_wait why;       /* not STORE_WAIT_NONE: locked out, nothing was written */
    int64_t wait_ms;           /* with it */
    struct store_attempts now; /* before this one */
    bool replayed; /* it was no new scan: recorded as "replayed", and counted as failed */
    unsigned warnings; /* sum of 1 << enum store_warning */
};

/* store_record_verification(s, what, out, e): attempts, entry of the access log, the day's scores,
 * and that the subject was seen, the latter at most once a minute.  A failure is on the disk when it returns;
 * anything else does not wait for the disk, as store_event().  ST_ENOTFOUND: the subject was erased
 * meanwhile. */
enum status store_record_verification(struct store *s, const struct store_record *what,
                                      struct store_recorded *out, struct errinfo *e);

/* store_record_attempt(t, what, now, out, e): The part of store_record_verification() that counts the
 * attempt, at time now.  out->now has the attempts before it; sets out->warnings. */
enum status store_record_attempt(struct log_txn *t, const struct store_record *what,
                                 int64_t now, struct store_recorded *out,
                                 struct errinfo *e);

/* store_days(s, out, n, e): of the last STORE_DAYS days those with verifications, oldest first;
 * released by free(). */
enum status store_days(struct store *s, struct store_day **out, size_t *n,
                       struct errinfo *e);

#endif
