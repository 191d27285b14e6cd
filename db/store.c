#include "store.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "codec.h"
#include "errinfo.h"
#include "mesh.h"
#include "model.h"
#include "store_engine.h"
#include "store_sqlite.h"

#define SECRET_BYTES 32

enum status store_open(const char *path, enum store_mode mode, struct store **out,
                       struct errinfo *e)
{
    enum status st;

    *out = NULL;
    if (sodium_init() < 0)
        return errinfo_set(e, ST_EINTERNAL, "the cryptographic library does not start");
    if ((st = store_sqlite_open(path, mode, out, e)) == ST_OK)
        store_use_model(*out, NULL);
    return st;
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

static bool is_one_of(const char *text, const char *set, size_t min, size_t max)
{
    const size_t n = strnlen(text, max + 1);

    return n >= min && n <= max && strspn(text, set) == n;
}

bool store_subject_valid(const char *subject)
{
    return is_one_of(
        subject, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-@:", 1,
        STORE_SUBJECT_MAX);
}

bool store_id_valid(const char *id)
{
    return is_one_of(id, "0123456789abcdef", STORE_ID_LEN, STORE_ID_LEN);
}

static bool printable(const char *text, size_t min, size_t max)
{
    const size_t n = strnlen(text, max + 1);

    for (size_t i = 0; i < n; i++)
        if (text[i] < ' ' || text[i] > '~')
            return false;
    return n >= min && n <= max;
}

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

static bool label_valid(const char *label)
{
    const unsigned char *p = (const unsigned char *)label;
    size_t n;

    if (strnlen(label, STORE_LABEL_MAX + 1) > STORE_LABEL_MAX)
        return false;
    for (; *p != '\0'; p += n) {
        if ((n = utf8_length(p)) == 0 || *p < ' ' || *p == 0x7f ||
            (*p == 0xc2 && p[1] < 0xa0)) /* control characters of either set */
            return false;
    }
    return true;
}

static enum status need_subject(const char *subject, struct errinfo *e)
{
    if (store_subject_valid(subject))
        return ST_OK;
    return errinfo_set(
        e, ST_EINVAL,
        "a subject id is 1 to %d characters of A-Z a-z 0-9 . _ - @ :", STORE_SUBJECT_MAX);
}

static enum status need_id(const char *id, const char *what, struct errinfo *e)
{
    if (store_id_valid(id))
        return ST_OK;
    return errinfo_set(e, ST_EINVAL, "a %s id is %d characters of 0-9 a-f", what,
                       STORE_ID_LEN);
}

/* ---- ids, times */

static void random_hex(char *out, size_t bytes)
{
    unsigned char raw[SECRET_BYTES];

    randombytes_buf(raw, bytes);
    (void)sodium_bin2hex(out, 2 * bytes + 1, raw, bytes);
    sodium_memzero(raw, sizeof raw);
}

static enum status act(struct store_act *by, const char *actor, struct errinfo *e)
{
    struct timespec now;
    struct tm tm;

    if (!printable(actor, 0, STORE_NAME_MAX))
        return errinfo_set(e, ST_EINVAL, "an actor is up to %d printable characters",
                           STORE_NAME_MAX);
    by->actor = actor;
    if (clock_gettime(CLOCK_REALTIME, &now) != 0 || gmtime_r(&now.tv_sec, &tm) == NULL ||
        tm.tm_year > 9999 - 1900 || tm.tm_year < 0)
        return errinfo_set(e, ST_EINTERNAL, "the system's clock cannot be read");
    (void)snprintf(by->at, sizeof by->at, "%04u-%02u-%02uT%02u:%02u:%02u.%03uZ",
                   (unsigned)(tm.tm_year + 1900) % 10000, (unsigned)(tm.tm_mon + 1) % 100,
                   (unsigned)tm.tm_mday % 100, (unsigned)tm.tm_hour % 100,
                   (unsigned)tm.tm_min % 100, (unsigned)tm.tm_sec % 100,
                   (unsigned)(now.tv_nsec / 1000000) % 1000);
    return ST_OK;
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
    if ((st = need_subject(subject, e)) != ST_OK || (st = act(&by, actor, e)) != ST_OK)
        return st;
    if (!label_valid(label))
        return errinfo_set(
            e, ST_EINVAL, "a label is up to %d bytes of UTF-8 without control characters",
            STORE_LABEL_MAX);
    random_hex(t->id, STORE_ID_LEN / 2);
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
    enum status st = need_id(id, "template", e);

    return st != ST_OK ? st : s->engine->template_read(s, id, t, NULL, NULL, e);
}

enum status store_template_load(struct store *s, const char *id, struct store_template *t,
                                struct face_work *w, struct face *f, struct errinfo *e)
{
    struct decoding d = {w, f};
    enum status st = need_id(id, "template", e);

    return st != ST_OK ? st : s->engine->template_read(s, id, t, use_decode, &d, e);
}

enum status store_template_delete(struct store *s, const char *actor, const char *id,
                                  struct errinfo *e)
{
    struct store_act by;
    enum status st;

    if ((st = need_id(id, "template", e)) != ST_OK || (st = act(&by, actor, e)) != ST_OK)
        return st;
    return s->engine->template_delete(s, &by, id, e);
}

enum status store_template_list(struct store *s, const char *subject,
                                struct store_template **out, size_t *n, struct errinfo *e)
{
    enum status st = need_subject(subject, e);

    *out = NULL;
    *n = 0;
    return st != ST_OK ? st : s->engine->template_list(s, subject, out, n, e);
}

/* ---- subjects */

enum status store_subject_get(struct store *s, const char *subject,
                              struct store_subject *out, struct errinfo *e)
{
    enum status st = need_subject(subject, e);

    return st != ST_OK ? st : s->engine->subject_get(s, subject, out, e);
}

enum status store_subject_list(struct store *s, const char *after, size_t limit,
                               struct store_subject **out, size_t *n, struct errinfo *e)
{
    enum status st = after[0] == '\0' ? ST_OK : need_subject(after, e);

    *out = NULL;
    *n = 0;
    return st != ST_OK ? st : s->engine->subject_list(s, after, limit, out, n, e);
}

enum status store_subject_delete(struct store *s, const char *actor, const char *subject,
                                 uint32_t *removed, struct errinfo *e)
{
    struct store_act by;
    enum status st;

    if (removed != NULL)
        *removed = 0;
    if ((st = need_subject(subject, e)) != ST_OK || (st = act(&by, actor, e)) != ST_OK)
        return st;
    return s->engine->subject_delete(s, &by, subject, removed, e);
}

/* ---- events, tokens */

enum status store_event(struct store *s, const char *kind, const char *actor,
                        const char *subject, const char *template_id, const char *outcome,
                        struct errinfo *e)
{
    struct store_act by;
    enum status st;

    if (!printable(kind, 1, STORE_NAME_MAX) || !printable(outcome, 0, STORE_NAME_MAX) ||
        (subject[0] != '\0' && !store_subject_valid(subject)) ||
        (template_id[0] != '\0' && !store_id_valid(template_id)))
        return errinfo_set(e, ST_EINVAL,
                           "the event's kind, subject, template or outcome "
                           "is malformed");
    if ((st = act(&by, actor, e)) != ST_OK)
        return st;
    return s->engine->event(s, &by, kind, subject, template_id, outcome, e);
}

/* The hash that is kept of a secret.  Secrets are 256 random bits: there is nothing to
 * guess, so a fast hash is enough. */
static void hash_secret(const char *secret, unsigned char hash[STORE_HASH_LEN])
{
    (void)crypto_generichash(hash, STORE_HASH_LEN, (const unsigned char *)secret,
                             strlen(secret), NULL, 0);
}

enum status store_token_create(struct store *s, const char *actor, const char *name,
                               char secret[65], struct store_token *t, struct errinfo *e)
{
    unsigned char hash[STORE_HASH_LEN];
    struct store_act by;
    enum status st;

    memset(t, 0, sizeof *t);
    secret[0] = '\0';
    if (!printable(name, 1, STORE_NAME_MAX))
        return errinfo_set(e, ST_EINVAL, "a token's name is 1 to %d printable characters",
                           STORE_NAME_MAX);
    if ((st = act(&by, actor, e)) != ST_OK)
        return st;
    random_hex(t->id, STORE_ID_LEN / 2);
    (void)snprintf(t->name, sizeof t->name, "%s", name);
    (void)snprintf(t->created, sizeof t->created, "%s", by.at);
    random_hex(secret, SECRET_BYTES);
    hash_secret(secret, hash);
    st = s->engine->token_add(s, &by, t, hash, e);
    if (st != ST_OK)
        sodium_memzero(secret, 65);
    return st;
}

enum status store_token_list(struct store *s, struct store_token **out, size_t *n,
                             struct errinfo *e)
{
    return s->engine->token_list(s, out, n, e);
}

enum status store_token_revoke(struct store *s, const char *actor, const char *id,
                               struct errinfo *e)
{
    struct store_act by;
    enum status st;

    if ((st = need_id(id, "token", e)) != ST_OK || (st = act(&by, actor, e)) != ST_OK)
        return st;
    return s->engine->token_revoke(s, &by, id, e);
}

/* The row is found by the hash, of which a stranger can choose neither the bits nor, by
 * how long the search takes, learn any that would help to find a secret. */
enum status store_token_check(struct store *s, const char *secret,
                              char id[STORE_ID_LEN + 1], struct errinfo *e)
{
    unsigned char hash[STORE_HASH_LEN], kept[STORE_HASH_LEN];
    struct store_token t;
    enum status st;

    id[0] = '\0';
    if (!is_one_of(secret, "0123456789abcdef", 2 * SECRET_BYTES, 2 * SECRET_BYTES))
        return errinfo_set(e, ST_EDENIED, "not a token");
    hash_secret(secret, hash);
    if ((st = s->engine->token_find(s, hash, &t, kept, e)) == ST_ENOTFOUND)
        return errinfo_set(e, ST_EDENIED, "no such token");
    if (st != ST_OK)
        return st;
    if (sodium_memcmp(hash, kept, sizeof hash) != 0)
        return errinfo_set(e, ST_EDENIED, "no such token");
    if (t.revoked)
        return errinfo_set(e, ST_EDENIED, "the token was revoked");
    memcpy(id, t.id, sizeof t.id);
    return ST_OK;
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
    if ((st = act(&by, actor, e)) != ST_OK)
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

/* ---- statistics */

enum status store_stats(struct store *s, struct store_stats *out, struct errinfo *e)
{
    return s->engine->stats(s, out, e);
}
