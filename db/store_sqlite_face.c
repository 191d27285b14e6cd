#include <math.h>
#include <string.h>

#include "errinfo.h"
#include "mesh.h"
#include "store_sqlite.h"

enum { /* the columns of TEMPLATE_COLUMNS */
       COL_ID,
       COL_SUBJECT,
       COL_LABEL,
       COL_CREATED,
       COL_DIGEST,
       COL_ENGINE,
       COL_POINTS,
       COL_TRIANGLES,
       COL_QUALITY,
       COL_COVERAGE,
       COL_DENSITY,
       COL_NOISE,
       COL_MODEL,
       COL_KEY
};

/* ---- rows */

static bool column_count(sqlite3_stmt *stmt, int col, int64_t max, uint32_t *out)
{
    const int64_t v = sqlite3_column_int64(stmt, col);

    *out = 0;
    if (sqlite3_column_type(stmt, col) != SQLITE_INTEGER || v < 0 || v > max)
        return false;
    *out = (uint32_t)v;
    return true;
}

static bool column_measure(sqlite3_stmt *stmt, int col, double max, double *out)
{
    *out = sqlite3_column_double(stmt, col);
    return sqlite3_column_type(stmt, col) == SQLITE_FLOAT && isfinite(*out) &&
           *out >= 0 && *out <= max;
}

/* The description in the current row.  The schema's checks hold for what this program
 * wrote; the file may have been written by anyone. */
static enum status read_template(sqlite3_stmt *stmt, void *out, struct errinfo *e)
{
    struct store_template *t = out;
    const char *bad = NULL;

    memset(t, 0, sizeof *t);
    if (!store_sqlite_text(stmt, COL_ID, t->id, sizeof t->id) || !store_id_valid(t->id))
        bad = "id";
    else if (!store_sqlite_text(stmt, COL_SUBJECT, t->subject, sizeof t->subject) ||
             !store_subject_valid(t->subject))
        bad = "subject";
    else if (!store_sqlite_text(stmt, COL_LABEL, t->label, sizeof t->label))
        bad = "label";
    else if (!store_sqlite_text(stmt, COL_CREATED, t->created, sizeof t->created))
        bad = "created";
    else if (!store_sqlite_text(stmt, COL_DIGEST, t->digest, sizeof t->digest))
        bad = "digest";
    else if (!store_sqlite_text(stmt, COL_ENGINE, t->engine, sizeof t->engine))
        bad = "engine";
    else if (!column_count(stmt, COL_POINTS, MESH_MAX_POINTS, &t->points))
        bad = "points";
    else if (!column_count(stmt, COL_TRIANGLES, 2 * (int64_t)t->points, &t->triangles))
        bad = "triangles";
    else if (!column_measure(stmt, COL_QUALITY, 1, &t->quality.score) ||
             !column_measure(stmt, COL_COVERAGE, 1, &t->quality.coverage) ||
             !column_measure(stmt, COL_DENSITY, 1e6, &t->quality.density_mm) ||
             !column_measure(stmt, COL_NOISE, 1e6, &t->quality.noise_mm))
        bad = "quality";
    if (bad != NULL)
        return errinfo_set(e, ST_ECORRUPT, "template %s: its row is damaged (%s)",
                           store_id_valid(t->id) ? t->id : "?", bad);
    return ST_OK;
}

static enum status read_subject(sqlite3_stmt *stmt, void *out, struct errinfo *e)
{
    struct store_subject *s = out;

    memset(s, 0, sizeof *s);
    if (!store_sqlite_text(stmt, 0, s->id, sizeof s->id) || !store_subject_valid(s->id) ||
        !store_sqlite_text(stmt, 1, s->created, sizeof s->created) ||
        !column_count(stmt, 2, UINT32_MAX, &s->templates))
        return errinfo_set(e, ST_ECORRUPT, "subject %s: its row is damaged",
                           store_subject_valid(s->id) ? s->id : "?");
    return ST_OK;
}

static enum status use_model(struct store_sqlite_conn *c, sqlite3_stmt *stmt,
                             const struct store_template *t, store_use *use, void *arg,
                             struct errinfo *e)
{
    const void *model = sqlite3_column_blob(stmt, COL_MODEL);
    const int len = sqlite3_column_bytes(stmt, COL_MODEL);

    if (model == NULL && sqlite3_errcode(c->db) != SQLITE_ROW)
        return store_sqlite_fail(c, "cannot read a model", e);
    if (model == NULL || sqlite3_column_type(stmt, COL_MODEL) != SQLITE_BLOB)
        return errinfo_set(e, ST_ECORRUPT, "template %s: its model is missing", t->id);
    return use(arg, t, model, (size_t)len, e);
}

/* find_subject(c, subject, key, e): *key is its row, or ST_ENOTFOUND. */
static enum status find_subject(struct store_sqlite_conn *c, const char *subject,
                                int64_t *key, struct errinfo *e)
{
    sqlite3_stmt *stmt;
    enum status st = store_sqlite_prepare(c, SQL_SUBJECT_FIND, &stmt, e);

    if (st != ST_OK)
        return st;
    if (store_sqlite_bind(stmt, 1, subject) != SQLITE_OK) {
        st = store_sqlite_fail(c, "cannot read a subject", e);
    } else {
        switch (sqlite3_step(stmt)) {
        case SQLITE_ROW:
            *key = sqlite3_column_int64(stmt, 0);
            break;
        case SQLITE_DONE:
            st = errinfo_set(e, ST_ENOTFOUND, "there is no subject %s", subject);
            break;
        default:
            st = store_sqlite_fail(c, "cannot read a subject", e);
        }
    }
    (void)sqlite3_reset(stmt);
    return st;
}

/* ---- templates */

static enum status add_subject(struct store_sqlite_conn *c, const struct store_act *by,
                               const char *subject, int64_t *key, struct errinfo *e)
{
    sqlite3_stmt *stmt;
    enum status st = store_sqlite_prepare(c, SQL_SUBJECT_ADD, &stmt, e);

    if (st != ST_OK)
        return st;
    if (store_sqlite_bind(stmt, 1, subject) != SQLITE_OK ||
        store_sqlite_bind(stmt, 2, by->at) != SQLITE_OK) {
        st = store_sqlite_fail(c, "cannot add a subject", e);
        (void)sqlite3_reset(stmt);
        return st;
    }
    st = store_sqlite_run(c, stmt, e);
    *key = sqlite3_last_insert_rowid(c->db);
    return st;
}

/* The subject's template of this digest into *t, if there is one. */
static enum status find_same(struct store_sqlite_conn *c, int64_t subject_key,
                             struct store_template *t, bool *found, struct errinfo *e)
{
    struct store_template old;
    sqlite3_stmt *stmt;
    enum status st = store_sqlite_prepare(c, SQL_TEMPLATE_SAME, &stmt, e);
    int rc;

    *found = false;
    if (st != ST_OK)
        return st;
    if (sqlite3_bind_int64(stmt, 1, subject_key) != SQLITE_OK ||
        store_sqlite_bind(stmt, 2, t->digest) != SQLITE_OK ||
        ((rc = sqlite3_step(stmt)) != SQLITE_ROW && rc != SQLITE_DONE)) {
        st = store_sqlite_fail(c, "cannot read a template", e);
    } else if (rc == SQLITE_ROW && (st = read_template(stmt, &old, e)) == ST_OK) {
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

static enum status add_template(struct store_sqlite_conn *c, int64_t subject_key,
                                const struct store_template *t, const void *model,
                                size_t len, struct errinfo *e)
{
    sqlite3_stmt *stmt;
    enum status st = store_sqlite_prepare(c, SQL_TEMPLATE_ADD, &stmt, e);

    if (st != ST_OK)
        return st;
    if (store_sqlite_bind(stmt, 1, t->id) != SQLITE_OK ||
        sqlite3_bind_int64(stmt, 2, subject_key) != SQLITE_OK ||
        store_sqlite_bind(stmt, 3, t->label) != SQLITE_OK ||
        store_sqlite_bind(stmt, 4, t->created) != SQLITE_OK ||
        store_sqlite_bind(stmt, 5, t->digest) != SQLITE_OK ||
        store_sqlite_bind(stmt, 6, t->engine) != SQLITE_OK ||
        sqlite3_bind_int64(stmt, 7, t->points) != SQLITE_OK ||
        sqlite3_bind_int64(stmt, 8, t->triangles) != SQLITE_OK ||
        sqlite3_bind_double(stmt, 9, t->quality.score) != SQLITE_OK ||
        sqlite3_bind_double(stmt, 10, t->quality.coverage) != SQLITE_OK ||
        sqlite3_bind_double(stmt, 11, t->quality.density_mm) != SQLITE_OK ||
        sqlite3_bind_double(stmt, 12, t->quality.noise_mm) != SQLITE_OK ||
        sqlite3_bind_blob64(stmt, 13, model, len, SQLITE_STATIC) != SQLITE_OK)
        st = store_sqlite_fail(c, "cannot add a template", e);
    else
        st = store_sqlite_run(c, stmt, e);
    (void)sqlite3_reset(stmt);
    (void)sqlite3_clear_bindings(stmt); /* the model is the caller's */
    return st;
}

enum status store_sqlite_face_add(struct store *s, const struct store_act *by,
                                  struct store_template *t, const char *newest,
                                  const void *model, size_t len, bool *created,
                                  struct errinfo *e)
{
    struct store_sqlite_conn *c;
    bool found = false;
    int64_t key;
    enum status st;

    *created = false;
    if ((st = store_sqlite_write(s, true, &c, e)) != ST_OK)
        return st;
    if ((st = find_subject(c, t->subject, &key, NULL)) == ST_ENOTFOUND)
        st = add_subject(c, by, t->subject, &key, e);
    else if (st == ST_OK)
        st = find_same(c, key, t, &found, e);
    else
        st = store_sqlite_fail(c, "cannot read a subject", e);
    if (st == ST_OK && !found && newest != NULL)
        st = expect_newest(c, key, newest, e);
    if (st == ST_OK && !found && (st = add_template(c, key, t, model, len, e)) == ST_OK)
        st = store_sqlite_admin_add_event(c, by, "enroll", t->subject, t->id, "created",
                                          e);
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
        st = read_template(stmt, t, e);
        if (st == ST_OK && use != NULL)
            st = use_model(c, stmt, t, use, arg, e);
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

enum status store_sqlite_face_each(struct store *s, store_use *use, store_report *report,
                                   void *arg, struct errinfo *e)
{
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
    while ((rc = sqlite3_step(stmt)) == SQLITE_ROW && st == ST_OK) {
        char line[sizeof row.msg + 64];

        if (read_template(stmt, &t, &row) == ST_OK) {
            st = use_model(c, stmt, &t, use, arg, &row);
            if (st != ST_ECORRUPT && st != ST_OK && e != NULL)
                *e = row;
            if (st != ST_ECORRUPT)
                continue;
        }
        st = ST_OK;
        (void)sqlite3_snprintf(sizeof line, line, "%s (row %lld)", row.msg,
                               sqlite3_column_int64(stmt, COL_KEY));
        report(arg, line);
    }
    if (st == ST_OK && rc != SQLITE_DONE)
        st = store_sqlite_fail(c, "cannot read the templates", e);
    (void)sqlite3_reset(stmt);
out:
    store_sqlite_done(s, c);
    return st;
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
            (void)read_template(stmt, &t, NULL);
            break;
        case SQLITE_DONE:
            st = errinfo_set(e, ST_ENOTFOUND, "there is no template %s", id);
            break;
        default:
            st = store_sqlite_fail(c, "cannot read a template", e);
        }
    }
    (void)sqlite3_reset(stmt);
    if (st != ST_OK ||
        (st = store_sqlite_prepare(c, SQL_TEMPLATE_DELETE, &stmt, e)) != ST_OK)
        goto out;
    if (store_sqlite_bind(stmt, 1, id) != SQLITE_OK)
        st = store_sqlite_fail(c, "cannot delete a template", e);
    else if ((st = store_sqlite_run(c, stmt, e)) == ST_OK)
        st = store_sqlite_admin_add_event(c, by, "delete_template",
                                          store_subject_valid(t.subject) ? t.subject : "",
                                          id, "deleted", e);
out:
    st = store_sqlite_written(s, st, e);
    if (st == ST_OK)
        store_sqlite_erase_log(s);
    return st;
}

/* ---- lists */

enum status store_sqlite_face_list(struct store *s, const char *subject,
                                   struct store_template **out, size_t *n,
                                   struct errinfo *e)
{
    struct store_sqlite_conn *c;
    sqlite3_stmt *stmt;
    void *list = NULL;
    int64_t key;
    enum status st;

    *out = NULL;
    *n = 0;
    if ((st = store_sqlite_read(s, &c, e)) != ST_OK)
        return st;
    if ((st = find_subject(c, subject, &key, e)) != ST_OK ||
        (st = store_sqlite_prepare(c, SQL_TEMPLATE_LIST, &stmt, e)) != ST_OK)
        goto out;
    if (sqlite3_bind_int64(stmt, 1, key) != SQLITE_OK)
        st = store_sqlite_fail(c, "cannot read the templates", e);
    else
        st = store_sqlite_rows(c, stmt, read_template, sizeof **out,
                               "cannot read the templates", &list, n, e);
    *out = list;
out:
    store_sqlite_done(s, c);
    return st;
}

enum status store_sqlite_face_subject(struct store *s, const char *subject,
                                      struct store_subject *out, struct errinfo *e)
{
    struct store_sqlite_conn *c;
    sqlite3_stmt *stmt;
    enum status st;
    int rc;

    if ((st = store_sqlite_read(s, &c, e)) != ST_OK)
        return st;
    if ((st = store_sqlite_prepare(c, SQL_SUBJECT_GET, &stmt, e)) != ST_OK)
        goto out;
    if (store_sqlite_bind(stmt, 1, subject) != SQLITE_OK ||
        ((rc = sqlite3_step(stmt)) != SQLITE_ROW && rc != SQLITE_DONE))
        st = store_sqlite_fail(c, "cannot read a subject", e);
    else if (rc == SQLITE_DONE)
        st = errinfo_set(e, ST_ENOTFOUND, "there is no subject %s", subject);
    else
        st = read_subject(stmt, out, e);
    (void)sqlite3_reset(stmt);
out:
    store_sqlite_done(s, c);
    return st;
}

enum status store_sqlite_face_subjects(struct store *s, const char *after, size_t limit,
                                       struct store_subject **out, size_t *n,
                                       struct errinfo *e)
{
    const int64_t most = limit < INT64_MAX ? (int64_t)limit : INT64_MAX;
    struct store_sqlite_conn *c;
    sqlite3_stmt *stmt;
    void *list = NULL;
    enum status st;

    *out = NULL;
    *n = 0;
    if ((st = store_sqlite_read(s, &c, e)) != ST_OK)
        return st;
    if ((st = store_sqlite_prepare(c, SQL_SUBJECT_LIST, &stmt, e)) != ST_OK)
        goto out;
    if (store_sqlite_bind(stmt, 1, after) != SQLITE_OK ||
        sqlite3_bind_int64(stmt, 2, most) != SQLITE_OK)
        st = store_sqlite_fail(c, "cannot read the subjects", e);
    else
        st = store_sqlite_rows(c, stmt, read_subject, sizeof **out,
                               "cannot read the subjects", &list, n, e);
    *out = list;
out:
    store_sqlite_done(s, c);
    return st;
}

enum status store_sqlite_face_erase(struct store *s, const struct store_act *by,
                                    const char *subject, uint32_t *removed,
                                    struct errinfo *e)
{
    struct store_sqlite_conn *c;
    struct store_subject old;
    sqlite3_stmt *stmt;
    int64_t key;
    enum status st;

    memset(&old, 0, sizeof old);
    if ((st = store_sqlite_write(s, true, &c, e)) != ST_OK)
        return st;
    if ((st = find_subject(c, subject, &key, e)) != ST_OK ||
        (st = store_sqlite_prepare(c, SQL_SUBJECT_GET, &stmt, e)) != ST_OK)
        goto out;
    if (store_sqlite_bind(stmt, 1, subject) != SQLITE_OK ||
        sqlite3_step(stmt) != SQLITE_ROW)
        st = store_sqlite_fail(c, "cannot read a subject", e);
    else
        (void)read_subject(stmt, &old, NULL); /* a damaged row can be deleted too */
    (void)sqlite3_reset(stmt);
    if (st != ST_OK ||
        (st = store_sqlite_prepare(c, SQL_SUBJECT_DELETE, &stmt, e)) != ST_OK)
        goto out;
    if (sqlite3_bind_int64(stmt, 1, key) != SQLITE_OK)
        st = store_sqlite_fail(c, "cannot delete a subject", e);
    else if ((st = store_sqlite_run(c, stmt, e)) == ST_OK)
        st = store_sqlite_admin_add_event(c, by, "delete_subject", subject, "", "deleted",
                                          e);
out:
    st = store_sqlite_written(s, st, e);
    if (st == ST_OK)
        store_sqlite_erase_log(s);
    if (removed != NULL)
        *removed = st == ST_OK ? old.templates : 0;
    return st;
}
