/* admission.h -- may a subject be verified or enrolled now, and which templates is a probe
 * compared with?  Both are read, with the models, in one transaction of the store, so that no
 * template is compared that was deleted before it. */
#ifndef VERIFY_ADMISSION_H
#define VERIFY_ADMISSION_H
#include <stdint.h>
#include "admit.h"
#include "face.h"
#include "status.h"
#include "store.h"

struct errinfo; /* errinfo.h */

/* Of a subject with more templates than this the models of the others are loaded one at a time
 * when they are compared: memory must not grow with the number of templates. */
#define ADMISSION_MODELS 16

/* What compares, and where it keeps models.  One thread at a time. */
struct admission_context {
    struct store *store;
    struct face_work *work;
    int64_t calibration;      /* the version that work decides by; 0 for a new work */
    double (*clock_ms)(void); /* as in face_compare(); may be NULL */

    /* A cache of models, or NULL each:
     * find(arg, id)          the model of a template, held until release(arg, it); or NULL
     * mark(arg)              of a moment before models are read
     * keep(arg, mark, t, f)  takes over what *f has of t, read after mark; returns it, held;
     *                        NULL: out of memory, *f is still the caller's */
    const struct face *(*find)(void *arg, const char *id);
    uint64_t (*mark)(void *arg);
    const struct face *(*keep)(void *arg, uint64_t mark, const struct store_template *t,
                               struct face *f);
    void (*release)(void *arg, const struct face *f);
    /* pass_over(arg, e): a template of another engine, of no use to this one, was left out. */
    void (*pass_over)(void *arg, const struct errinfo *e);
    void *arg;
};

struct admission {
    struct store_admission of;
    enum admit admit;
    struct {
        const struct face *face; /* held; NULL: not read yet, or foreign */
        bool foreign;            /* this engine cannot re-encode it */
    } model[ADMISSION_MODELS];   /* of the first templates */
    uint64_t mark;
};

struct admission_request {
    const char *subject;     /* or NULL and */
    const char *template_id; /* this one alone */
    const char *token;       /* whose attempts; NULL: "" */
    /* admitted(arg, a, e): everything but the models is read; its status ends the reading where
     * it is not ST_OK.  reading(arg): models are about to be read and decoded, which takes
     * time that another thread can use.  Either may be NULL, and neither may call the store. */
    enum status (*admitted)(void *arg, const struct store_admission *a,
                            struct errinfo *e);
    void (*reading)(void *arg);
    void *arg;
};

/* admission_read(c, ask, out, e): what is there now; c->work decides by the calibration in
 * force then.  Returns ST_OK; ST_EDENIED: out->admit says that the subject is disabled or has
 * expired; or as store_admit(), store_template_decode().  *out is empty on failure, but admit. */
enum status admission_read(struct admission_context *c,
                           const struct admission_request *ask, struct admission *out,
                           struct errinfo *e);

/* admission_hold(c, a, i, f, e): the model of template i, read where it was not yet, until
 * admission_release(c, a, i, f).  Returns as store_template_load(). */
enum status admission_hold(struct admission_context *c, const struct admission *a,
                           size_t i, const struct face **f, struct errinfo *e);
void admission_release(struct admission_context *c, const struct admission *a, size_t i,
                       const struct face *f);

void admission_free(struct admission_context *c,
                    struct admission *a); /* a is empty again */

/* admission_calibrate(c, e): c->work decides by the calibration in force from now on, for a
 * comparison without templates.  Returns as in_force_follow(). */
enum status admission_calibrate(struct admission_context *c, struct errinfo *e);

#endif
