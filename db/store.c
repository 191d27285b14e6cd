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

/* ---- what may be stored */

/* utf8_length(p): bytes of the well-formed character at p (RFC 3629), 0 if it is none. */
static size_t utf8_length(const unsigned char *p)
{
    const unsigned char c = p[0];

    if (c < 0x80)
        return 1;
    if (c < 0xc2 || c > 0xf4 || (p[1] & 0xc0) != 0x80)
        return 0;
    if (c < 0xe0)
        return 2;
    if ((p[2] & 0xc0) != 0x80 || (c == 0xe0 && p[1] < 0xa0) || (c == 0xed && p[1] > 0x9f))
        return 0;
    if (c < 0xf0)
        return 3;
    if ((p[3] & 0xc0) != 0x80 || (c == 0xf0 && p[1] < 0x90) || (c == 0xf4 && p[1] > 0x8f))
        return 0;
    return 4;
}

/* Up to max bytes of UTF-8 without control characters. */
static bool text_valid(const char *text, size_t max)
{
    const unsigned char *p = (const unsigned char *)text;
    size_t n;

    if (strnlen(text, max + 1) > max)
        return false;
    for (; *p != '\0'; p += n) {
        if ((n = utf8_length(p)) == 0 || *p < ' ' || *p == 0x7f ||
            (*p == 0xc2 && p[1] < 0xa0)) /* control characters of either set */
            return false;
    }
    return true;
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
    if (!text_valid(label, STORE_LABEL_MAX))
        return errinfo_set(
            e, ST_EINVAL, "a label is up to %d bytes of UTF-8 without control characters",
            STORE_LABEL_MAX);
    store_rules_random(t->id, STORE_ID_LEN / 2);
    (void)snprintf(t->subject, sizeof t->subject, "%s", subject);
    (void)snprintf(t->label, sizeof t->label, "%s", label);
    (void)snprintf(t->created, sizeof t->created, "%s", by.at);
    (void)snprintf(t->engine, sizeof t->engine, "%s", s->made_by);
    t->points = f->mesh.nv;
    t->triangles = mesh_real(&f->mesh);
    t->quality = f->quality;
    len = codec_size(&f->mesh);
    if ((model = malloc(len)) == NULL || codec_digest(&f->mesh, t->digest) != ST_OK) {
        free(model);
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    }
    codec_encode(f, model);
    st = s->engine->template_add(s, &by, t, newest, model, len, created, e);
    sodium_memzero(model, len);
    free(model);
    return st;
}

struct decoding {
    struct face_work *work;
    struct face *face;
};

static enum status decode(const struct decoding *d, const struct store_template *t,
                          const void *model, size_t len, struct errinfo *e)
{
    struct errinfo why;
    enum status st = codec_decode(model, len, d->work, d->face, &why);

    if (st != ST_OK)
        return errinfo_set(e, st, "template %s: %.180s", t->id, why.msg);
    if (d->face->mesh.nv != t->points) {
        st = errinfo_set(e, ST_ECORRUPT,
                         "template %s: its row says %u points, its model %u", t->id,
                         t->points, d->face->mesh.nv);
        d->face->mesh.nv = d->face->mesh.nt = 0;
        return st;
    }
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
    struct decoding d = {w, f};
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

/* ---- subjects */

static bool time_valid(const char *at)
{
    return strlen(at) == 24 && at[10] == 'T' && at[19] == '.' && at[23] == 'Z';
}

static enum status need_about(const struct store_subject *s, struct errinfo *e)
{
    if (!text_valid(s->reference, STORE_NOTE_MAX) ||
        !text_valid(s->purpose, STORE_NOTE_MAX))
        return errinfo_set(e, ST_EINVAL,
                           "a reference or a purpose is up to %d bytes of UTF-8 without "
                           "control characters",
                           STORE_NOTE_MAX);
    if (s->expires[0] != '\0' && !time_valid(s->expires))
        return errinfo_set(e, ST_EINVAL, "the end is not a time");
    return ST_OK;
}

enum status store_subject_add(struct store *s, const char *actor,
                              struct store_subject *about, struct errinfo *e)
{
    struct store_act by;
    enum status st;

    if ((st = store_rules_subject(about->id, e)) != ST_OK ||
        (st = need_about(about, e)) != ST_OK ||
        (st = store_rules_act(&by, actor, e)) != ST_OK)
        return st;
    memcpy(about->created, by.at, sizeof about->created);
    return s->engine->subject_add(s, &by, about, e);
}

enum status store_subject_get(struct store *s, const char *subject,
                              struct store_subject *out, struct errinfo *e)
{
    enum status st = store_rules_subject(subject, e);

    return st != ST_OK ? st : s->engine->subject_get(s, subject, out, e);
}

enum status store_subject_list(struct store *s, int64_t after, size_t limit,
                               struct store_subject **out, size_t *n, struct errinfo *e)
{
    *out = NULL;
    *n = 0;
    return s->engine->subject_list(s, after, limit, out, n, e);
}

enum status store_subject_delete(struct store *s, const char *actor, const char *subject,
                                 uint32_t *removed, struct errinfo *e)
{
    struct store_receipt r;
    const enum status st = store_subject_erase(s, actor, subject, &r, e);

    if (removed != NULL)
        *removed = st == ST_OK ? r.templates : 0;
    store_receipt_free(&r);
    return st;
}

enum status store_subject_erase(struct store *s, const char *actor, const char *subject,
                                struct store_receipt *out, struct errinfo *e)
{
    struct store_act by;
    enum status st;

    memset(out, 0, sizeof *out);
    if ((st = store_rules_subject(subject, e)) != ST_OK ||
        (st = store_rules_act(&by, actor, e)) != ST_OK)
        return st;
    return s->engine->subject_delete(s, &by, subject, out, e);
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

/* ---- statistics */

enum status store_stats(struct store *s, struct store_stats *out, struct errinfo *e)
{
    return s->engine->stats(s, out, e);
}
