/* Subjects and templates of an archive, in one transaction. */
#include <sodium.h>
#include <string.h>

#include "errinfo.h"
#include "store_archive.h"
#include "store_sqlite.h"

struct importing {
    struct store_sqlite_conn *c;
    const struct store_act *by;
    struct store_imported *out;
    struct store_sqlite_person p; /* the last subject */
    struct store_subject who;     /* the same, as it is here */
    bool left_out;                /* it was erased here */
};

/* Is there a row among the erased?  A uid, or where that is NULL an id. */
static enum status is_erased(struct importing *m, const unsigned char *uid,
                             const char *subject, bool *erased, struct errinfo *e)
{
    sqlite3_stmt *stmt;
    enum status st = store_sqlite_prepare(
        m->c, uid != NULL ? SQL_ERASED_UID : SQL_ERASED_LOOKUP, &stmt, e);
    int rc;

    if (st != ST_OK)
        return st;
    rc = uid != NULL ? store_sqlite_bind_bytes(stmt, 1, uid, STORE_UID)
                     : store_sqlite_bind_subject(m->c, stmt, 1, subject);
    if (rc == SQLITE_OK)
        rc = sqlite3_step(stmt);
    *erased = rc == SQLITE_ROW;
    if (rc != SQLITE_ROW && rc != SQLITE_DONE)
        st = store_sqlite_fail(m->c, "cannot read who was erased", e);
    (void)sqlite3_reset(stmt);
    return st;
}

/* Whose templates come next: the same person, whose id may be another by now, or whoever has
 * the id; ST_ENOTFOUND: neither, or it is left out. */
static enum status find_subject(struct importing *m, const struct store_subject *s,
                                struct errinfo *e)
{
    enum status st = is_erased(m, s->uid, NULL, &m->left_out, e);

    if (st != ST_OK)
        return st;
    if (m->left_out)
        return ST_ENOTFOUND;
    st = store_sqlite_subject_same(m->c, s->uid, &m->p, &m->who, e);
    if (st != ST_ENOTFOUND)
        return st;
    m->who = *s;
    if ((st = store_sqlite_subject_find(m->c, s->id, &m->p, e)) != ST_ENOTFOUND)
        return st;
    st = is_erased(m, NULL, s->id, &m->left_out, e);
    return st == ST_OK ? ST_ENOTFOUND : st;
}

static enum status add_subject(struct importing *m, const struct store_subject *s,
                               struct errinfo *e)
{
    enum status st = find_subject(m, s, e);

    m->out->subjects++;
    if (st != ST_ENOTFOUND)
        return st;
    if (m->left_out) {
        m->out->erased++;
        return ST_OK;
    }
    if ((st = store_sqlite_subject_add(m->c, s, &m->p, e)) != ST_OK)
        return st;
    m->out->new_subjects++;
    return store_sqlite_event_add(m->c, m->by, "import", s->id, "", "created", e);
}

/* Does a template statement find a row? */
static enum status finds(struct importing *m, sqlite3_stmt *stmt, bool *found,
                         struct errinfo *e)
{
    const int rc = sqlite3_step(stmt);
    enum status st = ST_OK;

    *found = rc == SQLITE_ROW;
    if (rc != SQLITE_ROW && rc != SQLITE_DONE)
        st = store_sqlite_fail(m->c, "cannot read a template", e);
    (void)sqlite3_reset(stmt);
    return st;
}

static enum status has_same(struct importing *m, const struct store_template *t,
                            bool *found, struct errinfo *e)
{
    unsigned char same[VAULT_HASH];
    sqlite3_stmt *stmt;
    enum status st = store_sqlite_prepare(m->c, SQL_TEMPLATE_SAME, &stmt, e);

    *found = false;
    if (st != ST_OK)
        return st;
    store_seal_same(m->c->vault, m->p.key.uid, t->digest, same);
    if (sqlite3_bind_int64(stmt, 1, m->p.row) != SQLITE_OK ||
        store_sqlite_bind_bytes(stmt, 2, same, sizeof same) != SQLITE_OK)
        return store_sqlite_fail(m->c, "cannot read a template", e);
    return finds(m, stmt, found, e);
}

static enum status add_template(struct importing *m, const struct store_archive_item *i,
                                struct errinfo *e)
{
    const struct store_template *t = &i->template;
    sqlite3_stmt *stmt;
    bool found;
    enum status st;

    m->out->templates++;
    if (m->left_out)
        return ST_OK;
    if ((st = has_same(m, t, &found, e)) != ST_OK || found)
        return st;
    if ((st = store_sqlite_prepare(m->c, SQL_TEMPLATE_GET, &stmt, e)) != ST_OK)
        return st;
    if (store_sqlite_bind(stmt, 1, t->id) != SQLITE_OK)
        return store_sqlite_fail(m->c, "cannot read a template", e);
    if ((st = finds(m, stmt, &found, e)) != ST_OK)
        return st;
    if (found)
        return errinfo_set(e, ST_EEXISTS,
                           "there is another template with the id %s already", t->id);
    if ((st = store_sqlite_face_store(m->c, &m->p, t, i->model, i->len, e)) != ST_OK)
        return st;
    m->out->new_templates++;
    return store_sqlite_event_add(m->c, m->by, "import", m->who.id, t->id, "created", e);
}

enum status store_sqlite_import(struct store *s, const struct store_act *by,
                                store_next *next, void *arg, bool dry,
                                struct store_imported *out, struct errinfo *e)
{
    struct importing m = {.by = by, .out = out};
    struct store_archive_item *item = NULL;
    enum status st;

    if ((st = store_sqlite_write(s, true, &m.c, e)) != ST_OK)
        return st;
    do {
        if ((st = next(arg, &item, e)) != ST_OK)
            break;
        if (item->kind == STORE_ARCHIVE_SUBJECT)
            st = add_subject(&m, &item->subject, e);
        else if (item->kind == STORE_ARCHIVE_TEMPLATE)
            st = add_template(&m, item, e);
    } while (st == ST_OK && item->kind != STORE_ARCHIVE_END);
    sodium_memzero(&m.p, sizeof m.p);
    sodium_memzero(&m.who, sizeof m.who);
    if (st == ST_OK && dry) {
        (void)store_sqlite_written(s, ST_EDENIED, NULL); /* rolled back */
        return ST_OK;
    }
    return store_sqlite_written(s, st, e);
}
