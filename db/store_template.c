#include "store_template.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "digest.h"
#include "rows_template.h"
#include "sql_read.h"
#include "store_txn.h"
#include "utf8.h"

/* ---- enrolling */

/* An enrolment that is under way. */
struct enrolling {
    struct log_txn t;
    const struct store_enroll *what;
    char outcome[LOG_TEXT + 1];
    unsigned char *encoded; /* has room for each sample's face */
    const char *newest;     /* what->newest, until a template is stored */
    struct rows_subject of;
};

static enum status find_subject(void *arg, struct errinfo *e)
{
    struct enrolling *g = arg;
    enum status st = store_actor_may(&g->t, e);

    if (sql_goes_on(g->t.sql, st))
        st = rows_subject_find(&g->t, g->what->subject, &g->of, e);
    return st;
}

/* Adds the subject if there is none, else records the time of its use. */
static enum status need_subject(struct enrolling *g, struct errinfo *e)
{
    struct store_subject about = {.identify = true};
    enum status st = find_subject(g, e);

    if (st == ST_OK)
        return rows_subject_seen(&g->t, g->of.one.uid, g->t.by.at, e);
    if (st != ST_ENOTFOUND || /* what is not found is there only for others' groups */
        (g->t.groups[0] != '\0' &&
         (st = rows_subject_free(&g->t, g->what->subject, e)) != ST_OK) ||
        (g->what->groups != NULL &&
         (st = groups_read(g->what->groups, about.groups, e)) != ST_OK) ||
        (st = store_rules_groups(&g->t, about.groups, e)) != ST_OK)
        return st;
    memcpy(about.id, g->what->subject, strlen(g->what->subject) + 1);
    memcpy(about.created, g->t.by.at, sizeof about.created);
    memcpy(about.seen, g->t.by.at, sizeof about.seen);
    if ((st = rows_subject_add(&g->t, &about, &g->of, e)) != ST_OK)
        return st;
    return log_change(&g->t, "add_subject", g->of.one.uid, "", "created", e);
}

/* May one more be stored, and was it compared with all that there are? */
static enum status may_add(struct enrolling *g, struct errinfo *e)
{
    struct rows_template *have;
    const char *last;
    size_t n;
    enum status st = rows_template_list(&g->t, &g->of, &have, &n, e);

    if (st != ST_OK)
        return st;
    last = n > 0 ? have[n - 1].one.id : "";
    if (g->newest != NULL && strcmp(last, g->newest) != 0)
        st = errinfo_set(e, ST_ECHANGED, "the subject's templates have changed");
    else
        st = store_rules_room(g->of.one.id, n, e);
    free(have);
    return st;
}

static enum status add_row(struct enrolling *g, const struct store_sample *sample,
                           const struct store_template *t, struct errinfo *e)
{
    unsigned char none[SURFACE_DESCRIPTOR];
    const struct rows_face face = {
        .face = g->encoded,
        .len = surface_encoded_size(sample->face),
        .descriptor = sample->descriptor != NULL ? sample->descriptor : none};
    struct rows_template row = {.one = *t};
    enum status st = may_add(g, e);

    if (st != ST_OK)
        return st;
    if (sample->read != NULL)
        (void)snprintf(row.one.read, sizeof row.one.read, "%s", sample->read);
    surface_encode(sample->face, g->encoded);
    memset(none, SURFACE_UNDESCRIBED, sizeof none);
    g->newest = NULL;
    if ((st = rows_template_add(&g->t, &g->of, &row, &face, e)) != ST_OK)
        return st;
    return log_change(&g->t, "enroll", g->of.one.uid, t->id, g->outcome, e);
}

static enum status enroll_row(struct enrolling *g, const struct store_sample *sample,
                              struct store_template *t, bool *created, struct errinfo *e)
{
    const char *read = sample->read != NULL ? sample->read : "";
    char id[STORE_ID_LEN + 1];
    struct rows_template old;
    struct rows_subject of;
    enum status st;

    if (sql_ahead(g->t.sql, true)) {
        (void)may_add(g, NULL);
        (void)sql_ahead(g->t.sql, false);
    }
    if ((st = rows_template_same(&g->t, g->of.one.uid, t->digest, read, id, e)) != ST_OK)
        return st;
    if (id[0] == '\0') {
        *created = true;
        return add_row(g, sample, t, e);
    }
    if ((st = rows_template_get(&g->t, id, &old, &of, e)) == ST_OK)
        *t = old.one;
    sodium_memzero(&of, sizeof of);
    return st;
}

static enum status describe(const struct store *s, const struct store_enroll *what,
                            const struct store_sample *sample, struct store_template *t,
                            struct errinfo *e)
{
    const struct surface_face *f = sample->face;

    store_rules_random(t->id, STORE_ID_LEN / 2);
    (void)snprintf(t->subject, sizeof t->subject, "%s", what->subject);
    (void)snprintf(t->label, sizeof t->label, "%s", what->label);
    (void)snprintf(t->engine, sizeof t->engine, "%s", s->made_by);
    t->points = surface_face_points(f, NULL);
    t->triangles = surface_face_triangles(f, NULL);
    t->quality = surface_face_quality(f);
    t->manager = what->manager;
    t->first_score = sample->first_score;
    return digest_face(f, t->digest) == ST_OK ? ST_OK : errinfo_memory(e);
}

static enum status enroll_rows(struct store *s, struct enrolling *g,
                               struct store_template *t, bool *created, struct errinfo *e)
{
    enum status st = store_start(s, g->what->actor, SQL_WRITE, NULL, &g->t, e);

    if (st != ST_OK)
        return st;
    store_read_ahead(&g->t, find_subject, g);
    if ((st = store_check(s, &g->t, e)) != ST_OK)
        return st;
    st = g->what->seq != 0 && g->what->seq != g->t.changes.seq
             ? errinfo_set(e, ST_ECHANGED, "the database has changed since the search")
             : need_subject(g, e);
    for (size_t i = 0; st == ST_OK && i < g->what->n; i++) {
        memcpy(t[i].created, g->t.by.at, sizeof g->t.by.at);
        st = enroll_row(g, &g->what->sample[i], &t[i], &created[i], e);
    }
    sodium_memzero(&g->of, sizeof g->of);
    return store_end(s, &g->t, st, e);
}

enum status store_enroll(struct store *s, const struct store_enroll *what,
                         struct store_template *t, bool *created, struct errinfo *e)
{
    struct enrolling g = {.what = what, .newest = what->newest};
    size_t room = 0;
    enum status st;

    memset(created, 0, what->n * sizeof *created);
    memset(t, 0, what->n * sizeof *t);
    if ((st = ident_subject(what->subject, e)) != ST_OK)
        return st;
    if (!utf8_is_text(what->label, STORE_LABEL_MAX))
        return errinfo_set(
            e, ST_EINVAL,
            "a label is up to %d bytes of UTF-8 without control characters, also those that "
            "are not seen or change the order of others",
            STORE_LABEL_MAX);
    for (size_t i = 0; i < what->n; i++) {
        const size_t size = surface_encoded_size(what->sample[i].face);

        if ((st = describe(s, what, &what->sample[i], &t[i], e)) != ST_OK)
            return st;
        room = size > room ? size : room;
    }
    if ((g.encoded = malloc(room)) == NULL)
        return errinfo_memory(e);
    (void)snprintf(g.outcome, sizeof g.outcome, "created%s",
                   what->captured != NULL ? what->captured : "");
    st = enroll_rows(s, &g, t, created, e);
    if (st != ST_OK)
        memset(created, 0, what->n * sizeof *created);
    rows_template_wipe(g.encoded, room);
    return st;
}

/* ---- reading */

bool store_template_outdated(const struct store *s, const struct store_template *t)
{
    return !surface_same_engine(t->engine, s->made_by);
}

static enum status reencode(const struct store *s, const struct store_template *t,
                            struct surface_work *w, struct surface_face **f,
                            struct errinfo *e)
{
    const enum status st = status_from(surface_rebuild(w, f));

    if (st == ST_OK)
        return ST_OK;
    if (st == ST_ENOMEM)
        return errinfo_set(e, st, "out of memory");
    return errinfo_set(e, ST_EVERSION,
                       "template %s was made by %s, and %s cannot re-encode it: %s",
                       t->id, t->engine, s->made_by, status_message(st));
}

enum status store_template_decode(const struct store *s, const struct store_template *t,
                                  const void *face, size_t len, struct surface_work *w,
                                  struct surface_face **f, struct errinfo *e)
{
    enum status st = status_from(surface_decode(w, face, len, f));

    if (st != ST_OK)
        return errinfo_set(e, st, "template %s: %s", t->id, status_message(st));
    if (len > surface_encoded_head(face, len) &&
        surface_face_points(*f, NULL) != t->points) {
        st = errinfo_set(e, ST_ECORRUPT,
                         "template %s: its row says %u points, its face %u", t->id,
                         t->points, surface_face_points(*f, NULL));
        surface_face_free(*f);
        *f = NULL;
        return st;
    }
    if (store_template_outdated(s, t))
        return reencode(s, t, w, f, e);
    surface_face_rate(*f, &t->quality);
    return ST_OK;
}

/* A template that is being read. */
struct getting {
    struct log_txn x;
    const char *id;
    struct rows_template row;
    struct rows_subject of;
    unsigned char **face; /* NULL: not wanted */
    size_t *len;
};

static enum status get_rows(void *arg, struct errinfo *e)
{
    struct getting *g = arg;
    enum status st = store_actor_may(&g->x, e);

    if (sql_goes_on(g->x.sql, st))
        st = rows_template_get(&g->x, g->id, &g->row, &g->of, e);
    if (g->face == NULL || !sql_goes_on(g->x.sql, st))
        return st;
    (void)snprintf(g->row.one.id, sizeof g->row.one.id, "%s", g->id);
    return rows_template_face(&g->x, &g->row, &g->of, g->face, g->len, e);
}

static enum status get(struct store *s, const char *actor, const char *id,
                       struct store_template *t, unsigned char **face, size_t *len,
                       struct errinfo *e)
{
    struct getting g = {.id = id, .face = face, .len = len};
    enum status st;

    memset(t, 0, sizeof *t);
    if ((st = ident_id(id, "template", e)) != ST_OK ||
        (st = store_start(s, actor, SQL_READ, NULL, &g.x, e)) != ST_OK)
        return st;
    store_read_ahead(&g.x, get_rows, &g);
    if ((st = store_check(s, &g.x, e)) != ST_OK)
        return st;
    if ((st = get_rows(&g, e)) == ST_OK)
        *t = g.row.one;
    sodium_memzero(&g.of, sizeof g.of);
    return store_end(s, &g.x, st, e);
}

enum status store_template_get(struct store *s, const char *actor, const char *id,
                               struct store_template *t, struct errinfo *e)
{
    size_t none;

    return get(s, actor, id, t, NULL, &none, e);
}

enum status store_template_load(struct store *s, const char *actor, const char *id,
                                struct store_template *t, struct surface_work *w,
                                struct surface_face **f, struct errinfo *e)
{
    unsigned char *face = NULL;
    size_t len = 0;
    enum status st = get(s, actor, id, t, &face, &len, e);

    if (st == ST_OK)
        st = store_template_decode(s, t, face, len, w, f, e);
    rows_template_wipe(face, len);
    return st;
}

/* Rows as they are described to callers. */
static enum status copy_rows(const struct rows_template *row, size_t n,
                             struct store_template **out, struct errinfo *e)
{
    if (n == 0)
        return ST_OK;
    if ((*out = malloc(n * sizeof **out)) == NULL)
        return errinfo_memory(e);
    for (size_t i = 0; i < n; i++)
        (*out)[i] = row[i].one;
    return ST_OK;
}

enum status store_template_list(struct store *s, const char *actor, const char *subject,
                                struct store_template **out, size_t *n, struct errinfo *e)
{
    struct rows_template *row = NULL;
    struct rows_subject of;
    struct log_txn x;
    enum status st;

    *out = NULL;
    *n = 0;
    if ((st = ident_subject(subject, e)) != ST_OK ||
        (st = store_act_begin(s, actor, SQL_READ, &x, e)) != ST_OK)
        return st;
    if ((st = rows_subject_find(&x, subject, &of, e)) == ST_OK &&
        (st = rows_template_list(&x, &of, &row, n, e)) == ST_OK)
        st = copy_rows(row, *n, out, e);
    free(row);
    sodium_memzero(&of, sizeof of);
    return store_end(s, &x, st, e);
}

/* ---- deleting */

/* Nothing of a subject on hold is deleted. */
static enum status delete_row(struct log_txn *x, const char *id, struct errinfo *e)
{
    struct rows_template row;
    struct rows_subject of;
    enum status st = rows_template_get(x, id, &row, &of, e);

    if (st == ST_OK && of.one.hold)
        st = errinfo_set(e, ST_EHELD, "subject %s is on hold", of.one.id);
    if (st == ST_OK && (st = rows_template_delete(x, &of, &row, e)) == ST_OK)
        st = log_change(x, "delete_template", of.one.uid, id, "deleted", e);
    sodium_memzero(&of, sizeof of);
    return st;
}

enum status store_template_delete(struct store *s, const char *actor, const char *id,
                                  struct errinfo *e)
{
    struct log_txn x;
    enum status st;

    if ((st = ident_id(id, "template", e)) != ST_OK ||
        (st = store_act_begin(s, actor, SQL_WRITE, &x, e)) != ST_OK)
        return st;
    st = store_end(s, &x, delete_row(&x, id, e), e);
    if (st == ST_OK)
        store_scrub(s);
    return st;
}

/* ---- another engine's */

static enum status write_reencoded(struct log_txn *x, const struct store_template *t,
                                   const struct rows_face *face, bool *done,
                                   struct errinfo *e)
{
    struct rows_template row;
    struct rows_subject of;
    enum status st = rows_template_get(x, t->id, &row, &of, e);

    if (st == ST_OK && strcmp(row.one.engine, t->engine) != 0) {
        *done = true;
        memcpy(row.one.engine, t->engine, sizeof row.one.engine);
        row.one.triangles = t->triangles;
        row.one.quality = t->quality;
        if ((st = rows_template_write(x, &of, &row, face, e)) == ST_OK)
            st = log_change(x, "reencode", of.one.uid, t->id, "reencoded", e);
    }
    sodium_memzero(&of, sizeof of);
    return st;
}

enum status store_reencode(struct store *s, const char *actor, const char *id,
                           struct surface_work *w, bool *done, struct errinfo *e)
{
    unsigned char descriptor[SURFACE_DESCRIPTOR], *encoded = NULL;
    struct rows_face face = {.descriptor = descriptor};
    struct surface_face *f = NULL;
    struct store_template t;
    struct log_txn x;
    enum status st = store_template_load(s, actor, id, &t, w, &f, e);

    *done = false;
    if (st == ST_OK && store_template_outdated(s, &t)) {
        (void)snprintf(t.engine, sizeof t.engine, "%s", s->made_by);
        t.triangles = surface_face_triangles(f, NULL);
        t.quality = surface_face_quality(f);
        face.len = surface_encoded_size(f);
        if ((face.face = encoded = malloc(face.len)) == NULL ||
            surface_describe(w, f, descriptor) == SURFACE_ENOMEM)
            st = errinfo_memory(e);
        else
            surface_encode(f, encoded);
        if (st == ST_OK && (st = store_act_begin(s, actor, SQL_WRITE, &x, e)) == ST_OK)
            st = store_end(s, &x, write_reencoded(&x, &t, &face, done, e), e);
    }
    *done = *done && st == ST_OK;
    sodium_memzero(descriptor, sizeof descriptor);
    rows_template_wipe(encoded, face.len);
    surface_face_free(f);
    return st;
}

/* $1: an engine from its first space on, as surface_same_engine() compares them. */
#define OUTDATED                                                                         \
    "substr(engine, length(engine) - length(CAST($1 AS text)) + 1) <> CAST($1 AS text)"

static enum status list_id(void *x, const struct sql_rows *r, void *out,
                           struct errinfo *e)
{
    (void)x;
    if (sql_read_text(r, 0, out, STORE_ID_LEN + 1) && ident_id_valid(out))
        return ST_OK;
    return errinfo_set(e, ST_ECORRUPT, "template ?: its row is damaged (id)");
}

enum status store_reencode_due(struct store *s, char (**out)[STORE_ID_LEN + 1], size_t *n,
                               struct errinfo *e)
{
    struct sql_rows *r;
    struct log_txn x;
    void *list = NULL;
    enum status st;

    *n = 0;
    if (out != NULL)
        *out = NULL;
    if ((st = store_begin(s, SQL_READ, &x, e)) != ST_OK)
        return st;
    st = SQL_QUERY(x.sql, &r, e,
                   "SELECT id FROM templates WHERE " OUTDATED " ORDER BY template_key",
                   sql_text(strchr(s->made_by, ' ')));
    st = sql_read_list(r, st, list_id, NULL, sizeof **out, &list, n, e);
    if (out != NULL)
        *out = list;
    else
        free(list);
    return store_end(s, &x, st, e);
}
