/* store_verification.h -- the two transactions of a verification or of an enrolment's comparison: one reads
 * everything, of one moment, the other writes everything. */
#ifndef DB_STORE_VERIFICATION_H
#define DB_STORE_VERIFICATION_H
#include "store_attempts.h"
#include "store_open.h"

struct log_txn;      /* log_txn.h */
struct store_people; /* store_people.h */
struct surface_work; /* libsurface.h */

struct store_snapshot {
    struct store_subject subject;   /* the subject; expired is set */
    struct store_attempts attempts; /* failed attempts on the subject and by the token */
    int64_t calibration; /* version of the newest calibration; 0: there never was one */
    /* Newest calibration, if the caller decides by another one; else zeros. */
    struct store_calibration k;
    struct store_template *t;      /* templates [n], oldest first */
    size_t n;                      /* number of templates */
    struct store_reading *reading; /* the open transaction, until store_snapshot_end() */
};

/* A request for the templates of a subject, or for one template.  One of subject, template_id and uid is set. */
struct store_snapshot_of {
    const char *subject;     /* id of the subject */
    const char *template_id; /* id of the template, which is read with its subject */
    /* [STORE_UID], uid of the subject.  It is read within the transaction `people`, which stays open, without
     * attempts, calibration and meshes. */
    const unsigned char *uid;
    struct store_people *people;
    /* The actor, whose failed attempts are read; borrowed until store_snapshot_end(); NULL: "" */
    const char *token;
    int64_t calibration; /* version of the calibration that the caller decides by */
};

/* store_snapshot_begin(s, what, out, e): Reads everything except the faces.
 *   out  its transaction stays open until store_snapshot_end(), which must be called also after a
 *        failure; to be released by store_snapshot_free()
 * Returns ST_OK; ST_ENOTFOUND: no such subject or template; ST_ECORRUPT: a row is damaged, also that of
 * the newest calibration (nothing can be decided without it), or the subject has more templates than
 * STORE_TEMPLATES_MAX. */
enum status store_snapshot_begin(struct store *s, const struct store_snapshot_of *what,
                                 struct store_snapshot *out, struct errinfo *e);

/* store_snapshot_face(out, i, w, f, e): Loads the face of template i, as store_template_load(); of several templates
 * without its surface (surface_decode()), unless the template is outdated. */
enum status store_snapshot_face(const struct store_snapshot *out, size_t i,
                                struct surface_work *w, struct surface_face **f,
                                struct errinfo *e);

/* store_snapshot_end(out, st, e): Ends the transaction; *out stays until store_snapshot_free().  A failed
 * attempt with a time in the future (the clock was set back) is set to the present time in the database,
 * so that a lock-out that begins with it ends.
 *   st  result of the reading
 * Returns st, or the error of the end. */
enum status store_snapshot_end(struct store_snapshot *out, enum status st,
                               struct errinfo *e);

/* store_snapshot_free(out): Releases *out, and resets it to the empty state. */
void store_snapshot_free(struct store_snapshot *out);

enum store_record_as {
    STORE_RECORD_UNCOUNTED, /* the attempts are not changed */
    STORE_RECORD_PASSED,    /* the actor's failures on the subject are deleted */
    STORE_RECORD_FAILED     /* one more failure of the actor is counted */
};

struct store_record {
    const struct store_subject *subject; /* subject of the snapshot */
    enum store_record_as as;
    const char *actor, *kind, *template_id, *outcome; /* texts of the event */
    const char *decision; /* decision for the day's scores; NULL: not counted there */
    double score;         /* score of this decision */
    const struct store_scan *scan; /* the probe, for the day's scans; NULL: not counted */

    /* A probe that matched.  It is refused if it is no new scan, but the cloud of a template of the
     * subject.  NULL: not checked. */
    const struct store_probe *probe;
    bool replayed; /* with probe: the caller knows that it is no new scan */

    /* Limits that are checked again against the present attempts: other tokens may have failed on the
     * subject since the snapshot.  A failed verification can add warnings.  NULL, or a limit of 0
     * failures: no check and no warnings. */
    const struct store_limits *limits;
};

/* Warnings to the operator about a failed verification; each is an event of this name.  In the order of
 * enum metrics_warning.
 * STORE_LOCKED_OUT: The failure locks its token out of the subject.
 * STORE_MANY_SUBJECTS: The number of subjects that the token failed on within STORE_FAILED_MS passes
 * another third of limits->subjects.
 * STORE_ATTEMPTS_PATTERN: The suspicion of all tokens for the subject reaches STORE_SUSPICION. */
enum store_warning {
    STORE_LOCKED_OUT,
    STORE_MANY_SUBJECTS,
    STORE_ATTEMPTS_PATTERN,
    STORE_WARNINGS
};

struct store_recorded {
    /* Reason of a lock-out (then nothing is written); STORE_WAIT_NONE: not locked out. */
    enum store_wait why;
    int64_t wait_ms;           /* remaining lock-out, ms; 0 if not locked out */
    struct store_attempts now; /* the attempts before this one */
    bool replayed; /* it was no new scan: recorded as "replayed", and counted as failed */
    unsigned warnings; /* sum of 1 << enum store_warning */
};

/* store_record_verification(s, what, out, e): Records a verification in one transaction: the attempts, an
 * entry of the access log, the day's scores and scans, and the subject's time of last use (at most once a minute).
 * A failed verification is durable on return.  Any other is not flushed, as by store_event().
 * ST_ENOTFOUND: the subject was erased meanwhile. */
enum status store_record_verification(struct store *s, const struct store_record *what,
                                      struct store_recorded *out, struct errinfo *e);

/* store_record_attempt(t, what, now, out, e): The part of store_record_verification() that counts the
 * attempt, at time now.  out->now has the attempts before it; sets out->warnings. */
enum status store_record_attempt(struct log_txn *t, const struct store_record *what,
                                 int64_t now, struct store_recorded *out,
                                 struct errinfo *e);

/* store_days(s, out, n, e): Lists the days with verifications of the last STORE_DAYS days, oldest first.
 *   out  a new array of *n elements, to be released by free() */
enum status store_days(struct store *s, struct store_day **out, size_t *n,
                       struct errinfo *e);

/* store_scans(s, out, n, e): Lists the scans of the last STORE_SCAN_DAYS days, by token and then by day.
 *   out  a new array of *n elements, to be released by free() */
enum status store_scans(struct store *s, struct store_scans **out, size_t *n,
                        struct errinfo *e);

/* store_days_trim(s, e): Deletes the days that store_days() and store_scans() do not list any more. */
enum status store_days_trim(struct store *s, struct errinfo *e);

#endif
