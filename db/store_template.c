#include "store_template.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "codec.h"
#include "errinfo.h"
#include "mesh.h"
#include "row_cloud.h"
#include "row_event.h"
#include "row_template.h"
#include "store_rules.h"
#include "store_txn.h"
#include "utf8.h"

/* ---- enrolling */

/* The subject, added with this template where it is new, else seen. */
static enum status need_subject(struct store_txn *x, const struct store_act *by,
                                const char *subject, struct row_subject *p, bool *added,
                                struct errinfo *e)
{
    struct store_subject about = {0};
    enum status st = row_subject_find(x, subject, p, e);

    *added = st == ST_ENOTFOUND;
    if (st == ST_OK)
        return row_subject_seen(x, subject, by->at, e);
    if (!*added)
        return st;
    memcpy(about.id, subject, strlen(subject) + 1);
    memcpy(about.created, by->at, sizeof about.created);
    memcpy(about.seen, by->at, sizeof about.seen);
    about.templates = 1;
    if ((st = row_subject_add(x, &about, p, e)) != ST_OK)
        return st;
    return row_subject_tell(x, by, "add_subject", subject, p, "created", e);
}

/* ST_EEXISTS unless the subject's newest template has this id ("": there is none). */
static enum status expect_newest(struct store_txn *x, int64_t subject, const char *newest,
                                 struct errinfo *e)
{
    char id[STORE_ID_LEN + 1];
    const enum status st = row_template_newest(x, subject, id, e);

    if (st != ST_OK || strcmp(id, newest) == 0)
        return st;
    return errinfo_set(e, ST_EEXISTS, "the subject's templates have changed");
}

/* The template of the subject that was made of the same cloud: of the same points as they were
 * used, or as they were read: which of many are used depends on their order and unit. */
static enum status find_same(struct store_txn *x, const struct row_subject *p,
                             const struct store_sample *sample,
                             const struct store_template *t, struct store_template *old,
                             bool *found, struct errinfo *e)
{
    char id[STORE_ID_LEN + 1] = "";
    enum status st = row_template_same(x, p, t->digest, old, found, e);

    if (st != ST_OK || *found || sample->read == NULL ||
        (st = row_cloud_template(x, p, sample->read, id, e)) != ST_OK || id[0] == '\0')
        return st;
    *found = true;
    return row_template_get(x, id, old, e);
}

/* An enrolment that is under way. */
struct enrolling {
    struct store_txn x;
    const struct store_enroll *what;
    struct store_act by;
    char outcome[STORE_NAME_MAX + 1];
    unsigned char *model; /* has room for each sample's */
    const char *newest;   /* what->newest, until a template is stored */
};

static enum status enroll_row(struct enrolling *g, const struct store_sample *sample,
                              struct store_template *t, bool *created, struct errinfo *e)
{
    struct store_txn *x = &g->x;
    struct store_template old = {0};
    struct row_subject p;
    bool added, found = false;
    enum status st = need_subject(x, &g->by, t->subject, &p, &added, e);

    if (st == ST_OK && !added)
        st = find_same(x, &p, sample, t, &old, &found, e);
    if (st == ST_OK && !found && g->newest != NULL)
        st = expect_newest(x, p.row, g->newest, e);
    if (st == ST_OK && !found && !added)
        st = store_rules_room(t->subject, p.templates, e);
    if (st == ST_OK && !found) {
        codec_encode(sample->face, g->model);
        st = row_template_add(x, &p, t, g->model, codec_size(sample->face), e);
        g->newest = NULL;
    }
    if (st == ST_OK && !found)
        st = row_template_tell(x, &g->by, "enroll", t->subject, t->id, g->outcome, e);
    if (st == ST_OK && !found && !added)
        st = row_subject_count(x, &g->by, t->subject, &p, 1, e);
    if (st == ST_OK && !found && sample->read != NULL)
        st = row_cloud_enroll(x, &p, t->id, sample->read, e);
    sodium_memzero(&p, sizeof p);
    if (st == ST_OK && found)
        *t = old;
    *created = !found;
    return st;
}

static enum status describe(const struct store *s, const struct store_act *by,
                            const struct store_enroll *what,
                            const struct store_sample *sample, struct store_template *t,
                            struct errinfo *e)
{
    const struct face *f = sample->face;

    store_rules_random(t->id, STORE_ID_LEN / 2);
    (void)snprintf(t->subject, sizeof t->subject, "%s", what->subject);
    (void)snprintf(t->label, sizeof t->label, "%s", what->label);
    (void)snprintf(t->created, sizeof t->created, "%s", by->at);
    (void)snprintf(t->engine, sizeof t->engine, "%s", s->made_by);
    t->points = f->surface.mesh.nv;
    t->triangles = mesh_real(&f->surface.mesh);
    t->quality = f->quality;
    t->manager = what->manager;
    t->first_score = sample->first_score;
    return codec_digest(&f->surface.mesh, t->digest) == ST_OK
               ? ST_OK
               : errinfo_set(e, ST_ENOMEM, "out of memory");
}

static enum status enroll_rows(struct store *s, struct enrolling *g,
                               struct store_template *t, bool *created, struct errinfo *e)
{
    enum status st = store_txn_begin(s, SQL_WRITE, &g->x, e);

    if (st != ST_OK)
        return st;
    for (size_t i = 0; st == ST_OK && i < g->what->n; i++)
        st = enroll_row(g, &g->what->sample[i], &t[i], &created[i], e);
    return store_txn_end(&g->x, st, e);
}

enum status store_enroll(struct store *s, const struct store_enroll *what,
                         struct store_template *t, bool *created, struct errinfo *e)
{
    struct enrolling g = {.what = what, .newest = what->newest};
    size_t room = 0;
    enum status st;

    memset(created, 0, what->n * sizeof *created);
    memset(t, 0, what->n * sizeof *t);
    if ((st = store_rules_subject(what->subject, e)) != ST_OK ||
        (st = store_rules_act(&g.by, what->actor, e)) != ST_OK)
        return st;
    if (!utf8_is_text(what->label, STORE_LABEL_MAX))
        return errinfo_set(
            e, ST_EINVAL, "a label is up to %d bytes of UTF-8 without control characters",
            STORE_LABEL_MAX);
    for (size_t i = 0; i < what->n; i++) {
        const struct face *f = what->sample[i].face;

        if ((st = describe(s, &g.by, what, &what->sample[i], &t[i], e)) != ST_OK)
            return st;
        room = codec_size(f) > room ? codec_size(f) : room;
    }
    if ((g.model = malloc(room)) == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    (void)snprintf(g.outcome, sizeof g.outcome, "created%s",
                   what->captured != NULL ? what->captured : "");
    st = enroll_rows(s, &g, t, created, e);
    if (st != ST_OK)
        memset(created, 0, what->n * sizeof *created);
    sodium_memzero(g.model, room);
    free(g.model);
    return st;
}

/* ---- reading */

bool store_template_outdated(const struct store *s, const struct store_template *t)
{
    return !face_same_engine(t->engine, s->made_by);
}

static enum status reencode(const struct store *s, const struct store_template *t,
                            struct face_work *w, struct face *f, struct errinfo *e)
{
    const enum status st = face_rebuild(f, w);

    if (st == ST_OK)
        return ST_OK;
    if (st == ST_ENOMEM)
        return errinfo_set(e, st, "out of memory");
    return errinfo_set(e, ST_EVERSION,
                       "template %s was made by %s, and %s cannot re-encode it: %s",
                       t->id, t->engine, s->made_by, status_message(st));
}

enum status store_template_decode(const struct store *s, const struct store_template *t,
                                  const void *model, size_t len, struct face_work *w,
                                  struct face *f, struct errinfo *e)
{
    struct errinfo why;
    enum status st = codec_decode(model, len, w, f, &why);

    if (st != ST_OK)
        return errinfo_set(e, st, "template %s: %.180s", t->id, why.msg);
    if (f->surface.mesh.nv != t->points) {
        st = errinfo_set(e, ST_ECORRUPT,
                         "template %s: its row says %u points, its model %u", t->id,
                         t->points, f->surface.mesh.nv);
        f->surface.mesh.nv = f->surface.mesh.nt = 0;
        return st;
    }
    if (store_template_outdated(s, t))
        return reencode(s, t, w, f, e);
    f->quality = t->quality;
    return ST_OK;
}

enum status store_template_get(struct store *s, const char *id, struct store_template *t,
                               struct errinfo *e)
{
    struct store_txn x;
    enum status st;

    if ((st = store_rules_id(id, "template", e)) != ST_OK ||
        (st = store_txn_begin(s, SQL_READ, &x, e)) != ST_OK)
        return st;
    return store_txn_end(&x, row_template_get(&x, id, t, e), e);
}

struct decoding {
    const struct store *store;
    struct face_work *work;
    struct face *face;
};

static enum status use_decode(void *arg, const struct store_template *t,
                              const void *model, size_t len, struct errinfo *e)
{
    const struct decoding *d = arg;

    return store_template_decode(d->store, t, model, len, d->work, d->face, e);
}

enum status store_template_load(struct store *s, const char *id, struct store_template *t,
                                struct face_work *w, struct face *f, struct errinfo *e)
{
    struct decoding d = {s, w, f};
    struct store_txn x;
    enum status st;

    if ((st = store_rules_id(id, "template", e)) != ST_OK ||
        (st = store_txn_begin(s, SQL_READ, &x, e)) != ST_OK)
        return st;
    return store_txn_end(&x, row_template_load(&x, id, t, use_decode, &d, e), e);
}

enum status store_template_list(struct store *s, const char *subject,
                                struct store_template **out, size_t *n, struct errinfo *e)
{
    struct row_subject p = {0};
    struct store_txn x;
    enum status st;

    *out = NULL;
    *n = 0;
    if ((st = store_rules_subject(subject, e)) != ST_OK ||
        (st = store_txn_begin(s, SQL_READ, &x, e)) != ST_OK)
        return st;
    if ((st = row_subject_find(&x, subject, &p, e)) == ST_OK)
        st = row_template_list(&x, p.row, p.templates, out, n, e);
    sodium_memzero(&p, sizeof p);
    return store_txn_end(&x, st, e);
}

/* ---- deleting */

/* Nothing of a subject on hold is deleted; a damaged row may be. */
static enum status delete_row(struct store_txn *x, const struct store_act *by,
                              const char *id, struct errinfo *e)
{
    struct store_template t;
    struct store_subject who;
    struct row_subject p = {0};
    bool good, known;
    enum status st = row_template_get(x, id, &t, e);

    if (st != ST_OK && st != ST_ECORRUPT)
        return st;
    good = st == ST_OK;
    known = row_subject_of(x, id, &p, &who, NULL) == ST_OK;
    sodium_memzero(&p.key, sizeof p.key);
    if (good && known && who.hold)
        return errinfo_set(e, ST_EHELD, "subject %s is on hold", who.id);
    if ((st = row_template_delete(x, id, e)) != ST_OK ||
        (st = row_template_tell(x, by, "delete_template", known ? who.id : "", id,
                                "deleted", e)) != ST_OK ||
        !known || p.templates == 0) /* moved there by somebody else */
        return st;
    return row_subject_count(x, by, who.id, &p, -1, e);
}

enum status store_template_delete(struct store *s, const char *actor, const char *id,
                                  struct errinfo *e)
{
    struct store_act by;
    struct store_txn x;
    enum status st;

    if ((st = store_rules_id(id, "template", e)) != ST_OK ||
        (st = store_rules_act(&by, actor, e)) != ST_OK ||
        (st = store_txn_begin(s, SQL_WRITE, &x, e)) != ST_OK)
        return st;
    st = store_txn_end(&x, delete_row(&x, &by, id, e), e);
    if (st == ST_OK)
        store_txn_scrub(s);
    return st;
}
