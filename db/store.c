#include "store.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "codec.h"
#include "errinfo.h"
#include "mesh.h"
#include "model.h"
#include "store_engine.h"
#include "store_rules.h"
#include "store_sqlite.h"

enum status store_open(const char *path, enum store_mode mode,
                       const struct store_key *key, struct store **out, struct errinfo *e)
{
    static const struct store_key usual = {.make = VAULT_FILE};
    enum status st;

    *out = NULL;
    if (sodium_init() < 0)
        return errinfo_set(e, ST_EINTERNAL, "the cryptographic library does not start");
    if ((st = store_sqlite_open(path, mode, key != NULL ? key : &usual, out, e)) == ST_OK)
        store_use_model(*out, NULL);
    return st;
}

bool store_in_use(const char *path, int64_t *pid)
{
    return store_sqlite_in_use(path, pid);
}

enum status store_kind(const char *path, enum vault_kind *kind, struct errinfo *e)
{
    return store_sqlite_kind(path, kind, e);
}

void store_use_model(struct store *s, const struct model *m)
{
    s->model = m != NULL ? m : &model_default;
    face_engine(s->model, s->made_by);
}

const struct model *store_model(const struct store *s)
{
    return s->model;
}

const char *store_made_by(const struct store *s)
{
    return s->made_by;
}

void store_close(struct store *s)
{
    if (s != NULL)
        s->engine->close(s);
}

enum status store_ready(struct store *s, struct errinfo *e)
{
    return s->engine->ready(s, e);
}

/* ---- templates */

enum status store_enroll(struct store *s, const char *actor, const char *subject,
                         const char *label, const struct face *f,
                         struct store_template *t, bool *created, struct errinfo *e)
{
    return store_enroll_after(s, actor, subject, label, f, NULL, t, created, e);
}

enum status store_enroll_after(struct store *s, const char *actor, const char *subject,
                               const char *label, const struct face *f,
                               const char *newest, struct store_template *t,
                               bool *created, struct errinfo *e)
{
    struct store_act by;
    unsigned char *model;
    size_t len;
    enum status st;

    *created = false;
    memset(t, 0, sizeof *t);
    if ((st = store_rules_subject(subject, e)) != ST_OK ||
        (st = store_rules_act(&by, actor, e)) != ST_OK)
        return st;
    if (!store_rules_text(label, STORE_LABEL_MAX))
        return errinfo_set(
            e, ST_EINVAL, "a label is up to %d bytes of UTF-8 without control characters",
            STORE_LABEL_MAX);
    store_rules_random(t->id, STORE_ID_LEN / 2);
    (void)snprintf(t->subject, sizeof t->subject, "%s", subject);
    (void)snprintf(t->label, sizeof t->label, "%s", label);
    (void)snprintf(t->created, sizeof t->created, "%s", by.at);
    (void)snprintf(t->engine, sizeof t->engine, "%s", s->made_by);
    t->points = f->surface.mesh.nv;
    t->triangles = mesh_real(&f->surface.mesh);
    t->quality = f->quality;
    len = codec_size(&f->surface.mesh);
    if ((model = malloc(len)) == NULL ||
        codec_digest(&f->surface.mesh, t->digest) != ST_OK) {
        free(model);
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    }
    codec_encode(f, model);
    st = s->engine->template_add(s, &by, t, newest, model, len, created, e);
    sodium_memzero(model, len);
    free(model);
    return st;
}

bool store_stale(const struct store *s, const struct store_template *t)
{
    return !face_same_engine(t->engine, s->made_by);
}

struct decoding {
    const struct store *store;
    struct face_work *work;
    struct face *face;
};

static enum status renew(const struct decoding *d, const struct store_template *t,
                         struct errinfo *e)
{
    const enum status st = face_rebuild(d->face, d->work);

    if (st == ST_OK)
        return ST_OK;
    if (st == ST_ENOMEM)
        return errinfo_set(e, st, "out of memory");
    return errinfo_set(e, ST_EVERSION,
                       "template %s was made by %s, and %s cannot make it anew: %s",
                       t->id, t->engine, d->store->made_by, status_message(st));
}

static enum status decode(const struct decoding *d, const struct store_template *t,
                          const void *model, size_t len, struct errinfo *e)
{
    struct errinfo why;
    enum status st = codec_decode(model, len, d->work, d->face, &why);

    if (st != ST_OK)
        return errinfo_set(e, st, "template %s: %.180s", t->id, why.msg);
    if (d->face->surface.mesh.nv != t->points) {
        st = errinfo_set(e, ST_ECORRUPT,
                         "template %s: its row says %u points, its model %u", t->id,
                         t->points, d->face->surface.mesh.nv);
        d->face->surface.mesh.nv = d->face->surface.mesh.nt = 0;
        return st;
    }
    if (store_stale(d->store, t))
        return renew(d, t, e);
    d->face->quality = t->quality;
    return ST_OK;
}

static enum status use_decode(void *arg, const struct store_template *t,
                              const void *model, size_t len, struct errinfo *e)
{
    return decode(arg, t, model, len, e);
}

enum status store_template_get(struct store *s, const char *id, struct store_template *t,
                               struct errinfo *e)
{
    enum status st = store_rules_id(id, "template", e);

    return st != ST_OK ? st : s->engine->template_read(s, id, t, NULL, NULL, e);
}

enum status store_template_load(struct store *s, const char *id, struct store_template *t,
                                struct face_work *w, struct face *f, struct errinfo *e)
{
    struct decoding d = {s, w, f};
    enum status st = store_rules_id(id, "template", e);

    return st != ST_OK ? st : s->engine->template_read(s, id, t, use_decode, &d, e);
}

enum status store_template_delete(struct store *s, const char *actor, const char *id,
                                  struct errinfo *e)
{
    struct store_act by;
    enum status st;

    if ((st = store_rules_id(id, "template", e)) != ST_OK ||
        (st = store_rules_act(&by, actor, e)) != ST_OK)
        return st;
    return s->engine->template_delete(s, &by, id, e);
}

enum status store_template_list(struct store *s, const char *subject,
                                struct store_template **out, size_t *n, struct errinfo *e)
{
    enum status st = store_rules_subject(subject, e);

    *out = NULL;
    *n = 0;
    return st != ST_OK ? st : s->engine->template_list(s, subject, out, n, e);
}

/* ---- events */

enum status store_event(struct store *s, const char *kind, const char *actor,
                        const char *subject, const char *template_id, const char *outcome,
                        struct errinfo *e)
{
    struct store_act by;
    enum status st;

    if (!store_rules_printable(kind, 1, STORE_NAME_MAX) ||
        !store_rules_printable(outcome, 0, STORE_NAME_MAX) ||
        (subject[0] != '\0' && !store_subject_valid(subject)) ||
        (template_id[0] != '\0' && !store_id_valid(template_id)))
        return errinfo_set(e, ST_EINVAL,
                           "the event's kind, subject, template or outcome "
                           "is malformed");
    if ((st = store_rules_act(&by, actor, e)) != ST_OK)
        return st;
    return s->engine->event(s, &by, kind, subject, template_id, outcome, e);
}

/* ---- calibrations */

static bool calibration_valid(const struct store_calibration *k)
{
    return decision_valid(&k->decision) && k->fmr > 0 && k->fmr < 1 && k->low_mm >= 0 &&
           k->high_mm >= k->low_mm && k->high_mm < 1e3 && k->subjects <= INT64_MAX &&
           k->impostors <= INT64_MAX && k->genuine <= INT64_MAX;
}

enum status store_calibration_add(struct store *s, const char *actor,
                                  struct store_calibration *k, struct errinfo *e)
{
    struct store_act by;
    enum status st;

    if (!calibration_valid(k))
        return errinfo_set(e, ST_EINVAL, "the calibration's numbers are impossible");
    if ((st = store_rules_act(&by, actor, e)) != ST_OK)
        return st;
    (void)snprintf(k->created, sizeof k->created, "%s", by.at);
    (void)snprintf(k->actor, sizeof k->actor, "%s", actor);
    (void)snprintf(k->engine, sizeof k->engine, "%s", s->made_by);
    return s->engine->calibration_add(s, &by, k, e);
}

enum status store_calibration_get(struct store *s, struct store_calibration *k,
                                  struct errinfo *e)
{
    return s->engine->calibration_get(s, k, e);
}

enum status store_calibration_version(struct store *s, int64_t *version,
                                      struct errinfo *e)
{
    return s->engine->calibration_version(s, version, e);
}

enum status store_calibration_list(struct store *s, struct store_calibration **out,
                                   size_t *n, struct errinfo *e)
{
    return s->engine->calibration_list(s, out, n, e);
}

/* ---- keys */

enum status store_rekey(struct store *s, const char *actor, const struct store_rekey *to,
                        struct errinfo *e)
{
    struct store_act by;
    enum status st;

    if ((to->kind == VAULT_PASSPHRASE && to->given == NULL) ||
        (to->kind == VAULT_OPEN && to->given != NULL))
        return errinfo_set(e, ST_EINVAL, "a key of another kind");
    if ((st = store_rules_act(&by, actor, e)) != ST_OK)
        return st;
    return s->engine->rekey(s, &by, to, e);
}

/* ---- statistics, room */

enum status store_vacuum(struct store *s, struct errinfo *e)
{
    return s->engine->vacuum(s, e);
}

enum status store_stats(struct store *s, struct store_stats *out, struct errinfo *e)
{
    return s->engine->stats(s, out, e);
}
