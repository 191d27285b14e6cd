/* Rows of version 3, which stood open, sealed into the tables of version 4.  Those tables
 * are this program's own only if nobody has changed the file: what does not fit ends the
 * upgrade. */
#include <sodium.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "errinfo.h"
#include "mesh.h"
#include "store_sqlite.h"

static const char subjects_3[] =
    "SELECT s.subject_key, s.id, s.created, a.failures, a.at_ms FROM subjects_3 s "
    "LEFT JOIN attempts_3 a USING (subject_key) ORDER BY s.subject_key";
static const char templates_3[] =
    "SELECT s.id, t.id, t.label, t.created, t.digest, t.engine, t.points, t.triangles, "
    "t.quality, t.coverage, t.density_mm, t.noise_mm, t.model "
    "FROM templates_3 t LEFT JOIN subjects_3 s USING (subject_key) "
    "ORDER BY t.template_key";
static const char events_3[] = "SELECT at, kind, actor, subject, template_id, outcome "
                               "FROM events_3 ORDER BY event_key";

typedef enum status convert_row(struct store_sqlite_conn *c, sqlite3_stmt *stmt,
                                struct errinfo *e);

static enum status each(struct store_sqlite_conn *c, const char *sql, convert_row *row,
                        struct errinfo *e)
{
    sqlite3_stmt *stmt = NULL;
    enum status st = ST_OK;
    int rc = SQLITE_DONE;

    if (sqlite3_prepare_v2(c->db, sql, -1, &stmt, NULL) != SQLITE_OK)
        return store_sqlite_fail(c, "cannot upgrade", e);
    while (st == ST_OK && (rc = sqlite3_step(stmt)) == SQLITE_ROW)
        st = row(c, stmt, e);
    if (st == ST_OK && rc != SQLITE_DONE)
        st = store_sqlite_fail(c, "cannot upgrade", e);
    (void)sqlite3_finalize(stmt);
    return st;
}

static enum status convert_attempts(struct store_sqlite_conn *c, sqlite3_stmt *from,
                                    int64_t row, struct errinfo *e)
{
    sqlite3_stmt *to = NULL;
    enum status st = ST_OK;

    if (sqlite3_prepare_v2(c->db, "INSERT INTO attempts VALUES (?1, ?2, ?3)", -1, &to,
                           NULL) != SQLITE_OK ||
        sqlite3_bind_int64(to, 1, row) != SQLITE_OK ||
        sqlite3_bind_value(to, 2, sqlite3_column_value(from, 3)) != SQLITE_OK ||
        sqlite3_bind_value(to, 3, sqlite3_column_value(from, 4)) != SQLITE_OK ||
        sqlite3_step(to) != SQLITE_DONE)
        st = store_sqlite_fail(c, "cannot upgrade", e);
    (void)sqlite3_finalize(to);
    return st;
}

static enum status convert_subject(struct store_sqlite_conn *c, sqlite3_stmt *stmt,
                                   struct errinfo *e)
{
    struct store_sqlite_person p;
    struct store_subject s = {0};
    enum status st;

    if (!store_sqlite_text(stmt, 1, s.id, sizeof s.id) || !store_subject_valid(s.id) ||
        !store_sqlite_text(stmt, 2, s.created, sizeof s.created))
        return errinfo_set(e, ST_ECORRUPT, "subject %s: its row is damaged",
                           store_subject_valid(s.id) ? s.id : "?");
    st = store_sqlite_subject_add(c, &s, &p, e);
    sodium_memzero(&p.key, sizeof p.key);
    if (st == ST_OK && sqlite3_column_type(stmt, 3) != SQLITE_NULL)
        st = convert_attempts(c, stmt, p.row, e);
    return st;
}

static bool read_measure(sqlite3_stmt *stmt, int col, double max, double *out)
{
    *out = sqlite3_column_double(stmt, col);
    return sqlite3_column_type(stmt, col) == SQLITE_FLOAT && isfinite(*out) &&
           *out >= 0 && *out <= max;
}

static bool digest_valid(const char *digest)
{
    return strlen(digest) == 64 && strspn(digest, "0123456789abcdef") == 64;
}

static enum status convert_template(struct store_sqlite_conn *c, sqlite3_stmt *stmt,
                                    struct errinfo *e)
{
    struct store_sqlite_person p;
    struct store_template t = {0};
    const void *model = NULL;
    size_t n;
    enum status st;

    if (!store_sqlite_text(stmt, 0, t.subject, sizeof t.subject) ||
        !store_sqlite_text(stmt, 1, t.id, sizeof t.id) || !store_id_valid(t.id) ||
        !store_sqlite_text(stmt, 2, t.label, sizeof t.label) ||
        !store_sqlite_text(stmt, 3, t.created, sizeof t.created) ||
        !store_sqlite_text(stmt, 4, t.digest, sizeof t.digest) ||
        !digest_valid(t.digest) ||
        !store_sqlite_text(stmt, 5, t.engine, sizeof t.engine) ||
        !store_sqlite_count(stmt, 6, MESH_MAX_POINTS, &t.points) ||
        !store_sqlite_count(stmt, 7, 2 * (int64_t)t.points, &t.triangles) ||
        !read_measure(stmt, 8, 1, &t.quality.score) ||
        !read_measure(stmt, 9, 1, &t.quality.coverage) ||
        !read_measure(stmt, 10, 1e6, &t.quality.density_mm) ||
        !read_measure(stmt, 11, 1e6, &t.quality.noise_mm) ||
        (model = store_sqlite_blob(stmt, 12, 1, SIZE_MAX, &n)) == NULL)
        return errinfo_set(e, ST_ECORRUPT, "template %s: its row is damaged",
                           store_id_valid(t.id) ? t.id : "?");
    if ((st = store_sqlite_subject_find(c, t.subject, &p, e)) == ST_OK)
        st = store_sqlite_face_store(c, &p, &t, model, n, e);
    sodium_memzero(&p.key, sizeof p.key);
    return st;
}

static enum status convert_event(struct store_sqlite_conn *c, sqlite3_stmt *stmt,
                                 struct errinfo *e)
{
    char actor[STORE_NAME_MAX + 1], kind[STORE_NAME_MAX + 1], outcome[STORE_NAME_MAX + 1],
        id[STORE_ID_LEN + 1], subject[STORE_SUBJECT_MAX + 1];
    struct store_act by = {.actor = actor};

    if (!store_sqlite_text(stmt, 0, by.at, sizeof by.at) ||
        !store_sqlite_text(stmt, 1, kind, sizeof kind) ||
        !store_sqlite_text(stmt, 2, actor, sizeof actor) ||
        !store_sqlite_text(stmt, 3, subject, sizeof subject) ||
        !store_sqlite_text(stmt, 4, id, sizeof id) ||
        !store_sqlite_text(stmt, 5, outcome, sizeof outcome))
        return errinfo_set(e, ST_ECORRUPT, "an event's row is damaged");
    return store_sqlite_event_add(c, &by, kind, subject, id, outcome, e);
}

enum status store_sqlite_convert(struct store_sqlite_conn *c, struct errinfo *e)
{
    enum status st;

    if ((st = each(c, subjects_3, convert_subject, e)) == ST_OK &&
        (st = each(c, templates_3, convert_template, e)) == ST_OK &&
        (st = each(c, events_3, convert_event, e)) == ST_OK &&
        (st = store_sqlite_token_prove(c, e)) == ST_OK)
        st = store_sqlite_calibration_prove(c, e);
    return st;
}
