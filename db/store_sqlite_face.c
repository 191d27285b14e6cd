#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include "errinfo.h"
#include "mesh.h"
#include "store_sqlite.h"

enum { /* the columns of TEMPLATE_COLUMNS */
       COL_ROW,
       COL_ID,
       COL_WHO,                   /* of the subject: uid, key, about, ... */
       COL_CREATED = COL_WHO + 8, /* of the template */
       COL_ENGINE,
       COL_POINTS,
       COL_TRIANGLES,
       COL_ABOUT,
       COL_MODEL
};

/* ---- rows */

/* Nothing of the row is trusted but what its subject's key proves; *k is that key. */
enum status store_sqlite_face_key(const struct store_sqlite_conn *c, sqlite3_stmt *stmt,
                                  struct store_template *t, struct store_seal_key *k,
                                  struct errinfo *e)
{
    struct store_subject who;
    const void *about;
    size_t n;
    bool ok;

    memset(t, 0, sizeof *t);
    ok = store_sqlite_text(stmt, COL_ID, t->id, sizeof t->id) && store_id_valid(t->id) &&
         store_sqlite_text(stmt, COL_CREATED, t->created, sizeof t->created) &&
         store_sqlite_text(stmt, COL_ENGINE, t->engine, sizeof t->engine) &&
         store_sqlite_count(stmt, COL_POINTS, MESH_MAX_POINTS, &t->points) &&
         store_sqlite_count(stmt, COL_TRIANGLES, 2 * (int64_t)t->points, &t->triangles) &&
         store_sqlite_subject_who(c, stmt, COL_WHO, &who, k) &&
         (about = store_sqlite_blob(stmt, COL_ABOUT, 1, STORE_SEAL_ABOUT, &n)) != NULL &&
         store_seal_open_template(k, about, n, t);
    if (!ok)
        return errinfo_set(e, ST_ECORRUPT, "template %s: its row is damaged",
                           store_id_valid(t->id) ? t->id : "?");
    memcpy(t->subject, who.id, sizeof t->subject);
    return ST_OK;
}

static enum status read_template(const struct store_sqlite_conn *c, sqlite3_stmt *stmt,
                                 void *out, struct errinfo *e)
{
    struct store_seal_key k;
    const enum status st = store_sqlite_face_key(c, stmt, out, &k, e);

    sodium_memzero(&k, sizeof k);
    return st;
}

static enum status use_model(struct store_sqlite_conn *c, sqlite3_stmt *stmt,
                             const struct store_template *t,
                             const struct store_seal_key *k, store_use *use, void *arg,
                             struct errinfo *e)
{
    const void *sealed = sqlite3_column_blob(stmt, COL_MODEL);
    const size_t len = (size_t)sqlite3_column_bytes(stmt, COL_MODEL);
    unsigned char *model;
    enum status st;

    if (sealed == NULL && sqlite3_errcode(c->db) != SQLITE_ROW)
        return store_sqlite_fail(c, "cannot read a model", e);
    if (sealed == NULL || sqlite3_column_type(stmt, COL_MODEL) != SQLITE_BLOB ||
        len <= VAULT_OVER)
        return errinfo_set(e, ST_ECORRUPT, "template %s: its model is missing", t->id);
    if ((model = malloc(len)) == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    if (store_seal_open_model(k, t, sealed, len, model))
        st = use(arg, t, model, len - VAULT_OVER, e);
    else
        st = errinfo_set(e, ST_ECORRUPT, "template %s: its model is damaged", t->id);
    sodium_memzero(model, len);
    free(model);
    return st;
}

/* ---- templates */

/* The subject's template of this digest into *t, if there is one. */
static enum status find_same(struct store_sqlite_conn *c,
                             const struct store_sqlite_person *p,
                             struct store_template *t, bool *found, struct errinfo *e)
{
    unsigned char same[VAULT_HASH];
    struct store_template old;
    sqlite3_stmt *stmt;
    enum status st = store_sqlite_prepare(c, SQL_TEMPLATE_SAME, &stmt, e);
    int rc;

    *found = false;
    if (st != ST_OK)
        return st;
    store_seal_same(c->vault, p->key.uid, t->digest, same);
    if (sqlite3_bind_int64(stmt, 1, p->row) != SQLITE_OK ||
        store_sqlite_bind_bytes(stmt, 2, same, sizeof same) != SQLITE_OK ||
        ((rc = sqlite3_step(stmt)) != SQLITE_ROW && rc != SQLITE_DONE)) {
        st = store_sqlite_fail(c, "cannot read a template", e);
    } else if (rc == SQLITE_ROW && (st = read_template(c, stmt, &old, e)) == ST_OK) {
        *t = old;
        *found = true;
    }
    (void)sqlite3_reset(stmt);
    return st;
}

/* ST_EEXISTS unless the subject's newest template has this id ("": there is none). */
static enum status expect_newest(struct store_sqlite_conn *c, int64_t subject_key,
                                 const char *newest, struct errinfo *e)
{
    char id[STORE_ID_LEN + 1] = "";
    sqlite3_stmt *stmt;
    enum status st = store_sqlite_prepare(c, SQL_TEMPLATE_NEWEST, &stmt, e);
    int rc;

    if (st != ST_OK)
        return st;
    if (sqlite3_bind_int64(stmt, 1, subject_key) != SQLITE_OK ||
        ((rc = sqlite3_step(stmt)) != SQLITE_ROW && rc != SQLITE_DONE))
        st = store_sqlite_fail(c, "cannot read a template", e);
    else if (rc == SQLITE_ROW && !store_sqlite_text(stmt, 0, id, sizeof id))
        st = errinfo_set(e, ST_ECORRUPT, "template ?: its row is damaged (id)");
    else if (strcmp(id, newest) != 0)
        st = errinfo_set(e, ST_EEXISTS, "the subject's templates have changed");
    (void)sqlite3_reset(stmt);
    return st;
}

static enum status add_row(struct store_sqlite_conn *c,
                           const struct store_sqlite_person *p,
                           const struct store_template *t, const void *sealed, size_t len,
                           struct errinfo *e)
{
    unsigned char about[STORE_SEAL_ABOUT], same[VAULT_HASH];
    const size_t n = store_seal_template(&p->key, t, about);
    sqlite3_stmt *stmt;
    enum status st = store_sqlite_prepare(c, SQL_TEMPLATE_ADD, &stmt, e);

    if (st != ST_OK)
        return st;
    store_seal_same(c->vault, p->key.uid, t->digest, same);
    if (store_sqlite_bind(stmt, 1, t->id) != SQLITE_OK ||
        sqlite3_bind_int64(stmt, 2, p->row) != SQLITE_OK ||
        store_sqlite_bind_bytes(stmt, 3, same, sizeof same) != SQLITE_OK ||
        store_sqlite_bind(stmt, 4, t->created) != SQLITE_OK ||
        store_sqlite_bind(stmt, 5, t->engine) != SQLITE_OK ||
        sqlite3_bind_int64(stmt, 6, t->points) != SQLITE_OK ||
        sqlite3_bind_int64(stmt, 7, t->triangles) != SQLITE_OK ||
        store_sqlite_bind_bytes(stmt, 8, about, n) != SQLITE_OK ||
        sqlite3_bind_blob64(stmt, 9, sealed, len, SQLITE_STATIC) != SQLITE_OK)
        st = store_sqlite_fail(c, "cannot add a template", e);
    else
        st = store_sqlite_run(c, stmt, e);
    (void)sqlite3_reset(stmt);
    (void)sqlite3_clear_bindings(stmt); /* the model is the caller's */
    return st;
}

enum status store_sqlite_face_store(struct store_sqlite_conn *c,
                                    const struct store_sqlite_person *p,
                                    const struct store_template *t, const void *model,
                                    size_t len, struct errinfo *e)
{
    unsigned char *sealed = malloc(len + VAULT_OVER);
    enum status st;

    if (sealed == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    store_seal_model(&p->key, t, model, len, sealed);
    st = add_row(c, p, t, sealed, len + VAULT_OVER, e);
    free(sealed);
    return st;
}

/* The subject, added where it is new. */
static enum status need_subject(struct store_sqlite_conn *c, const struct store_act *by,
                                const char *subject, struct store_sqlite_person *p,
                                bool *added, struct errinfo *e)
{
    struct store_subject about = {0};
    enum status st = store_sqlite_subject_find(c, subject, p, e);

    *added = st == ST_ENOTFOUND;
    if (!*added)
        return st;
    memcpy(about.id, subject, strlen(subject) + 1);
    memcpy(about.created, by->at, sizeof about.created);
    memcpy(about.seen, by->at, sizeof about.seen);
    return store_sqlite_subject_add(c, &about, p, e);
}

enum status store_sqlite_face_add(struct store *s, const struct store_act *by,
                                  struct store_template *t, const char *newest,
                                  const void *model, size_t len, bool *created,
                                  struct errinfo *e)
{
    struct store_sqlite_person p;
    struct store_sqlite_conn *c;
    bool added = false, found = false;
    enum status st;

    *created = false;
    if ((st = store_sqlite_write(s, true, &c, e)) != ST_OK)
        return st;
    st = need_subject(c, by, t->subject, &p, &added, e);
    if (st == ST_OK && !added &&
        (st = store_sqlite_edit_see(c, t->subject, by->at, e)) == ST_OK)
        st = find_same(c, &p, t, &found, e);
    if (st == ST_OK && !found && newest != NULL)
        st = expect_newest(c, p.row, newest, e);
    if (st == ST_OK && !found &&
        (st = store_sqlite_face_store(c, &p, t, model, len, e)) == ST_OK)
        st = store_sqlite_event_add(c, by, "enroll", t->subject, t->id, "created", e);
    sodium_memzero(&p, sizeof p);
    st = store_sqlite_written(s, st, e);
    *created = st == ST_OK && !found;
    return st;
}

enum status store_sqlite_face_read(struct store *s, const char *id,
                                   struct store_template *t, store_use *use, void *arg,
                                   struct errinfo *e)
{
    struct store_sqlite_conn *c;
    const enum store_sqlite_sql sql = use != NULL ? SQL_TEMPLATE_LOAD : SQL_TEMPLATE_GET;
    struct store_seal_key k = {0};
    sqlite3_stmt *stmt;
    enum status st;

    if ((st = store_sqlite_read(s, &c, e)) != ST_OK)
        return st;
    if ((st = store_sqlite_prepare(c, sql, &stmt, e)) != ST_OK)
        goto out;
    if (store_sqlite_bind(stmt, 1, id) != SQLITE_OK) {
        st = store_sqlite_fail(c, "cannot read a template", e);
        goto reset;
    }
    switch (sqlite3_step(stmt)) {
    case SQLITE_ROW:
        st = store_sqlite_face_key(c, stmt, t, &k, e);
        if (st == ST_OK && use != NULL)
            st = use_model(c, stmt, t, &k, use, arg, e);
        sodium_memzero(&k, sizeof k);
        break;
    case SQLITE_DONE:
        st = errinfo_set(e, ST_ENOTFOUND, "there is no template %s", id);
        break;
    default:
        st = store_sqlite_fail(c, "cannot read a template", e);
    }
reset:
    (void)sqlite3_reset(stmt);
out:
    store_sqlite_done(s, c);
    return st;
}

enum status store_sqlite_face_each(struct store *s, unsigned part, unsigned parts,
                                   store_use *use, store_report *report, void *arg,
                                   struct errinfo *e)
{
    struct store_seal_key k = {0};
    struct store_sqlite_conn *c;
    struct store_template t;
    struct errinfo row;
    sqlite3_stmt *stmt;
    enum status st;
    int rc;

    if ((st = store_sqlite_read(s, &c, e)) != ST_OK)
        return st;
    if ((st = store_sqlite_prepare(c, SQL_TEMPLATE_EACH, &stmt, e)) != ST_OK)
        goto out;
    if (sqlite3_bind_int64(stmt, 1, part) != SQLITE_OK ||
        sqlite3_bind_int64(stmt, 2, parts) != SQLITE_OK) {
        st = store_sqlite_fail(c, "cannot read the templates", e);
        goto out;
    }
    while ((rc = sqlite3_step(stmt)) == SQLITE_ROW && st == ST_OK) {
        char line[sizeof row.msg + 64];

        if (store_sqlite_face_key(c, stmt, &t, &k, &row) == ST_OK) {
            st = use_model(c, stmt, &t, &k, use, arg, &row);
            if (st != ST_ECORRUPT && st != ST_OK && e != NULL)
                *e = row;
            if (st != ST_ECORRUPT)
                continue;
        }
        st = ST_OK;
        (void)sqlite3_snprintf(sizeof line, line, "%s (row %lld)", row.msg,
                               sqlite3_column_int64(stmt, COL_ROW));
        report(arg, line);
    }
    if (st == ST_OK && rc != SQLITE_DONE)
        st = store_sqlite_fail(c, "cannot read the templates", e);
    (void)sqlite3_reset(stmt);
    sodium_memzero(&k, sizeof k);
out:
    store_sqlite_done(s, c);
    return st;
}

/* Nothing of a subject on hold is deleted; a damaged row can be. */
static enum status may_delete(struct store_sqlite_conn *c, const struct store_template *t,
                              struct errinfo *e)
{
    struct store_subject one;

    if (!store_subject_valid(t->subject) ||
        store_sqlite_subject_read(c, t->subject, &one, NULL) != ST_OK || !one.hold)
        return ST_OK;
    return errinfo_set(e, ST_EHELD, "subject %s is on hold", t->subject);
}

enum status store_sqlite_face_delete(struct store *s, const struct store_act *by,
                                     const char *id, struct errinfo *e)
{
    struct store_sqlite_conn *c;
    struct store_template t;
    sqlite3_stmt *stmt;
    enum status st;

    if ((st = store_sqlite_write(s, true, &c, e)) != ST_OK)
        return st;
    if ((st = store_sqlite_prepare(c, SQL_TEMPLATE_GET, &stmt, e)) != ST_OK)
        goto out;
    if (store_sqlite_bind(stmt, 1, id) != SQLITE_OK) {
        st = store_sqlite_fail(c, "cannot read a template", e);
    } else {
        switch (sqlite3_step(stmt)) {
        case SQLITE_ROW: /* a damaged row can be deleted too */
            (void)read_template(c, stmt, &t, NULL);
            break;
        case SQLITE_DONE:
            st = errinfo_set(e, ST_ENOTFOUND, "there is no template %s", id);
            break;
        default:
            st = store_sqlite_fail(c, "cannot read a template", e);
        }
    }
    (void)sqlite3_reset(stmt);
    if (st != ST_OK || (st = may_delete(c, &t, e)) != ST_OK ||
        (st = store_sqlite_prepare(c, SQL_TEMPLATE_DELETE, &stmt, e)) != ST_OK)
        goto out;
    if (store_sqlite_bind(stmt, 1, id) != SQLITE_OK)
        st = store_sqlite_fail(c, "cannot delete a template", e);
    else if ((st = store_sqlite_run(c, stmt, e)) == ST_OK)
        st = store_sqlite_event_add(c, by, "delete_template",
                                    store_subject_valid(t.subject) ? t.subject : "", id,
                                    "deleted", e);
out:
    st = store_sqlite_written(s, st, e);
    if (st == ST_OK)
        store_sqlite_erase_log(s);
    return st;
}

enum status store_sqlite_face_list(struct store *s, const char *subject,
                                   struct store_template **out, size_t *n,
                                   struct errinfo *e)
{
    struct store_sqlite_person p = {0};
    struct store_sqlite_conn *c;
    sqlite3_stmt *stmt;
    void *list = NULL;
    enum status st;

    *out = NULL;
    *n = 0;
    if ((st = store_sqlite_read(s, &c, e)) != ST_OK)
        return st;
    if ((st = store_sqlite_subject_find(c, subject, &p, e)) != ST_OK ||
        (st = store_sqlite_prepare(c, SQL_TEMPLATE_LIST, &stmt, e)) != ST_OK)
        goto out;
    if (sqlite3_bind_int64(stmt, 1, p.row) != SQLITE_OK)
        st = store_sqlite_fail(c, "cannot read the templates", e);
    else
        st = store_sqlite_rows(c, stmt, read_template, sizeof **out,
                               "cannot read the templates", &list, n, e);
    *out = list;
out:
    sodium_memzero(&p, sizeof p);
    store_sqlite_done(s, c);
    return st;
}
