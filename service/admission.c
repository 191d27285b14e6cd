#include "admission.h"

#include <stdlib.h>

#include "in_force.h"
#include "errinfo.h"

/* What the callbacks of store_admit() see. */
struct reading {
    struct admission_context *context;
    const struct admission_request *ask;
    struct admission *out;
    size_t i; /* the template whose model is read */
};

static void give_back(struct admission_context *c, const struct face *f)
{
    if (c->release != NULL) {
        c->release(c->arg, f);
    } else {
        struct face *own =
            (struct face *)(uintptr_t)f; /* of keep(), never really const */

        face_free(own);
        free(own);
    }
}

static const struct face *find(struct admission_context *c, const char *id)
{
    return c->find != NULL ? c->find(c->arg, id) : NULL;
}

/* *f, decoded with status st, becomes *out; *f is empty then. */
static enum status keep(struct admission_context *c, uint64_t mark,
                        const struct store_template *t, enum status st, struct face *f,
                        const struct face **out, struct errinfo *e)
{
    *out = NULL;
    if (st == ST_OK && c->keep != NULL) {
        *out = c->keep(c->arg, mark, t, f);
    } else if (st == ST_OK) {
        struct face *own = malloc(sizeof *own);

        if (own != NULL)
            *own = *f;
        *out = own;
    }
    if (*out != NULL)
        return ST_OK;
    face_free(f);
    if (st == ST_EVERSION && c->pass_over != NULL)
        c->pass_over(c->arg, e);
    return st != ST_OK ? st : errinfo_set(e, ST_ENOMEM, "out of memory");
}

static enum status listed(void *arg, const struct store_admission *a, struct errinfo *e)
{
    struct reading *r = arg;
    bool missing = false;
    enum status st;

    if (a->n > STORE_TEMPLATES_MAX)
        return errinfo_set(e, ST_ECORRUPT, "subject %s has %zu templates, more than %d",
                           a->subject.id, a->n, STORE_TEMPLATES_MAX);
    r->out->admit = admit_subject(&a->subject, e);
    if (r->out->admit != ADMIT_YES)
        return ST_EDENIED;
    if (r->ask->admitted != NULL && (st = r->ask->admitted(r->ask->arg, a, e)) != ST_OK)
        return st;
    for (size_t i = 0; i < a->n && i < ADMISSION_MODELS; i++) {
        r->out->model[i].face = find(r->context, a->t[i].id);
        missing |= r->out->model[i].face == NULL;
    }
    if (missing && r->ask->reading != NULL)
        r->ask->reading(r->ask->arg);
    return ST_OK;
}

static bool wanted(void *arg, const struct store_template *t)
{
    struct reading *r = arg;

    r->i = (size_t)(t - r->out->of.t);
    return r->i < ADMISSION_MODELS && r->out->model[r->i].face == NULL;
}

static enum status use(void *arg, const struct store_template *t, const void *model,
                       size_t len, struct errinfo *e)
{
    struct reading *r = arg;
    struct admission_context *c = r->context;
    struct face f = {0};
    enum status st = store_template_decode(c->store, t, model, len, c->work, &f, e);

    st = keep(c, r->out->mark, t, st, &f, &r->out->model[r->i].face, e);
    r->out->model[r->i].foreign = st == ST_EVERSION;
    return st == ST_EVERSION ? ST_OK : st;
}

enum status admission_read(struct admission_context *c,
                           const struct admission_request *ask, struct admission *out,
                           struct errinfo *e)
{
    struct reading r = {.context = c, .ask = ask};
    enum status st;

    *out = (struct admission){0};
    r.out = out;
    out->mark = c->mark != NULL ? c->mark(c->arg) : 0;
    st = store_admit(c->store,
                     &(struct store_admit){.subject = ask->subject,
                                           .template_id = ask->template_id,
                                           .token = ask->token,
                                           .calibration = c->calibration,
                                           .listed = listed,
                                           .wanted = wanted,
                                           .use = use,
                                           .arg = &r},
                     &out->of, e);
    if (st != ST_OK) {
        const enum admit admit = out->admit;

        admission_free(c, out);
        out->admit = admit;
        return st;
    }
    if (out->of.calibration != c->calibration) {
        in_force_use(c->store, out->of.k, c->work);
        c->calibration = out->of.calibration;
    }
    return ST_OK;
}

enum status admission_hold(struct admission_context *c, const struct admission *a,
                           size_t i, const struct face **f, struct errinfo *e)
{
    struct face loaded = {0};
    struct store_template t;
    uint64_t mark;
    enum status st;

    *f = i < ADMISSION_MODELS ? a->model[i].face : NULL;
    if (*f != NULL)
        return ST_OK;
    if (i < ADMISSION_MODELS && a->model[i].foreign)
        return errinfo_set(e, ST_EVERSION, "template %s is of another engine",
                           a->of.t[i].id);
    if ((*f = find(c, a->of.t[i].id)) != NULL)
        return ST_OK;
    mark = c->mark != NULL ? c->mark(c->arg) : 0;
    st = store_template_load(c->store, a->of.t[i].id, &t, c->work, &loaded, e);
    return keep(c, mark, &t, st, &loaded, f, e);
}

void admission_release(struct admission_context *c, const struct admission *a, size_t i,
                       const struct face *f)
{
    if (i >= ADMISSION_MODELS || a->model[i].face != f)
        give_back(c, f);
}

void admission_free(struct admission_context *c, struct admission *a)
{
    for (size_t i = 0; i < ADMISSION_MODELS; i++)
        if (a->model[i].face != NULL)
            give_back(c, a->model[i].face);
    free(a->of.t);
    *a = (struct admission){0};
}

enum status admission_calibrate(struct admission_context *c, struct errinfo *e)
{
    return in_force_follow(c->store, c->work, &c->calibration, e);
}
