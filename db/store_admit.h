/* store_admit.h -- all that a verification or an enrolment's fit check reads, of one moment and
 * in one transaction. */
#ifndef DB_STORE_ADMIT_H
#define DB_STORE_ADMIT_H
#include "store_open.h"

struct store_admission {
    struct store_subject subject; /* expired is set */
    struct store_attempts attempts;
    int64_t calibration; /* the version of the newest, 0: there never was one */
    /* the newest, if that is not what the caller has, or zeros */
    struct store_calibration k;
    struct store_template *t; /* [n], oldest first; released by free() */
    size_t n;
};

struct store_admit {
    const char *subject;     /* whose templates, or NULL and */
    const char *template_id; /* this one and its subject */
    const char *token;       /* whose attempts; NULL: "" */
    int64_t calibration;     /* the version that the caller decides by */

    /* listed: all but the faces is read; its status ends the reading where it is not ST_OK.
     * wanted: is this template's face to be read?  For each, in their order, before
     * use: it is.  face is encoded, to be read by store_template_decode(); valid during the
     * call only.  A status other than ST_OK ends the reading.
     * Each may be NULL; then nothing more is read.  They must not call the store: it may be
     * waiting for a connection that this thread has. */
    enum status (*listed)(void *arg, const struct store_admission *a, struct errinfo *e);
    bool (*wanted)(void *arg, const struct store_template *t);
    enum status (*use)(void *arg, const struct store_template *t, const void *face,
                       size_t len, struct errinfo *e);
    void *arg;
};

/* store_admit(s, what, out, e): ST_ENOTFOUND: no such subject or template; ST_ECORRUPT, also of
 * the newest calibration: then nothing can be decided.  On failure out->t is NULL.
 * A failed attempt that lies in the future (the clock was set back) is moved to now for good, so
 * that a wait that begins with it ends. */
enum status store_admit(struct store *s, const struct store_admit *what,
                        struct store_admission *out, struct errinfo *e);

#endif
