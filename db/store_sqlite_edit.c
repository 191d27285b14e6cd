#include <sodium.h>
#include <stdio.h>
#include <string.h>

#include "errinfo.h"
#include "store_sqlite.h"

static enum status need_free(struct store_sqlite_conn *c, const char *id,
                             struct errinfo *e)
{
    struct store_sqlite_person p;
    enum status st = store_sqlite_subject_find(c, id, &p, e);

    sodium_memzero(&p, sizeof p);
    if (st == ST_ENOTFOUND)
        return ST_OK;
    if (st == ST_OK || st == ST_ECORRUPT)
        st = errinfo_set(e, ST_EEXISTS, "there is a subject %s already", id);
    return st;
}

static void copy(char *to, size_t size, const char *from)
{
    if (from != NULL)
        (void)snprintf(to, size, "%s", from);
}

static void apply(struct store_subject *one, const struct store_edit *edit)
{
    copy(one->id, sizeof one->id, edit->id);
    copy(one->reference, sizeof one->reference, edit->reference);
    copy(one->purpose, sizeof one->purpose, edit->purpose);
    copy(one->expires, sizeof one->expires, edit->expires);
    if (edit->hold != NULL)
        one->hold = *edit->hold;
    if (edit->disabled != NULL)
        one->disabled = *edit->disabled;
}

/* The row anew: what is proved with what is sealed changes with it. */
static enum status write_row(struct store_sqlite_conn *c,
                             const struct store_sqlite_person *p,
                             const struct store_subject *one, struct errinfo *e)
{
    unsigned char about[STORE_SEAL_ABOUT];
    const size_t n = store_seal_subject(&p->key, one, about);
    sqlite3_stmt *stmt;
    enum status st = store_sqlite_prepare(c, SQL_SUBJECT_EDIT, &stmt, e);

    if (st != ST_OK)
        return st;
    if (sqlite3_bind_int64(stmt, 1, p->row) != SQLITE_OK ||
        store_sqlite_bind_subject(c, stmt, 2, one->id) != SQLITE_OK ||
        store_sqlite_bind_bytes(stmt, 3, about, n) != SQLITE_OK ||
        store_sqlite_bind_or(stmt, 4, one->expires) != SQLITE_OK ||
        sqlite3_bind_int(stmt, 5, one->hold) != SQLITE_OK ||
        sqlite3_bind_int(stmt, 6, one->disabled) != SQLITE_OK)
        return store_sqlite_fail(c, "cannot change a subject", e);
    return store_sqlite_run(c, stmt, e);
}

enum status store_sqlite_edit(struct store *s, const struct store_act *by,
                              const char *subject, const struct store_edit *edit,
                              struct errinfo *e)
{
    struct store_sqlite_person p = {0};
    struct store_sqlite_conn *c;
    struct store_subject one;
    enum status st;

    if ((st = store_sqlite_write(s, true, &c, e)) != ST_OK)
        return st;
    if ((st = store_sqlite_subject_find(c, subject, &p, e)) != ST_OK ||
        (st = store_sqlite_subject_read(c, subject, &one, e)) != ST_OK ||
        (edit->id != NULL && (st = need_free(c, edit->id, e)) != ST_OK))
        goto out;
    apply(&one, edit);
    st = write_row(c, &p, &one, e);
    for (int i = 0; st == ST_OK && i < edit->events; i++)
        st = store_sqlite_event_add(c, by, edit->event[i].kind, subject, "",
                                    edit->event[i].outcome, e);
    /* The events know it by its new id too from now on. */
    if (st == ST_OK && edit->id != NULL)
        st = store_sqlite_event_add(c, by, edit->event[0].kind, one.id, "", "named", e);
out:
    sodium_memzero(&p, sizeof p);
    sodium_memzero(&one, sizeof one);
    return store_sqlite_written(s, st, e);
}

/* ---- seen */

enum status store_sqlite_edit_see(struct store_sqlite_conn *c, const char *subject,
                                  const char *at, struct errinfo *e)
{
    sqlite3_stmt *stmt;
    enum status st = store_sqlite_prepare(c, SQL_SUBJECT_SEEN, &stmt, e);

    if (st != ST_OK)
        return st;
    if (store_sqlite_bind_subject(c, stmt, 1, subject) != SQLITE_OK ||
        store_sqlite_bind(stmt, 2, at) != SQLITE_OK)
        return store_sqlite_fail(c, "cannot note that a subject was seen", e);
    return store_sqlite_run(c, stmt, e);
}

enum status store_sqlite_edit_seen(struct store *s, const char *subject, const char *at,
                                   struct errinfo *e)
{
    struct store_sqlite_conn *c;
    enum status st;

    if ((st = store_sqlite_try(s, &c, e)) != ST_OK)
        return st;
    st = store_sqlite_edit_see(c, subject, at, e);
    return store_sqlite_written(s, st, e);
}
