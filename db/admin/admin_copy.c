#include "admin_copy.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "errinfo.h"
#include "log_row.h"
#include "rows_calibration.h"
#include "rows_device.h"
#include "rows_digest.h"
#include "rows_root.h"
#include "rows_token.h"
#include "sql_file.h"
#include "sql_open.h"
#include "sql_read.h"
#include "store_txn.h"

#define PAGE 1000

/* ---- the logs */

/* Each entry is as it was written: its MAC is made anew.  at[LOG_DAEMONS]: what those of each daemon
 * follow; of changes the first alone. */
static enum status copy_log(struct log_txn *from, struct log_txn *to, enum log_name log,
                            struct log_end *at, struct log_end *trimmed,
                            struct errinfo *e)
{
    struct log_entry entry;
    struct sql_rows *r;
    enum status st =
        sql_stream(from->sql,
                   log == LOG_CHANGES
                       ? "SELECT " LOG_ROW_CHANGE " FROM change_log ORDER BY seq"
                       : "SELECT " LOG_ROW_ACCESS " FROM access_log ORDER BY daemon, seq",
                   NULL, 0, &r, e);

    while (st == ST_OK && sql_next(r)) {
        struct log_end *after = NULL;

        if (log_row_read(r, log, &entry))
            after = &at[log == LOG_CHANGES ? 0 : entry.daemon];
        if (after == NULL || !log_follows(from->crypt, after, &entry)) {
            st = errinfo_set(e, ST_ECORRUPT,
                             "entry %" PRIu64 " of the audit log (%s) is not as it was "
                             "written",
                             after != NULL ? after->seq + 1 : entry.seq, log_word(log));
            break;
        }
        (void)log_trimmed(&entry, trimmed);
        log_mac(to->crypt, entry.hash, entry.mac);
        st = log_row_add(to->sql, &entry, e);
    }
    return sql_done(r, st, e);
}

static enum status copy_logs(struct log_txn *from, struct log_txn *to, struct errinfo *e)
{
    struct log_end none[LOG_DAEMONS], trimmed[LOG_DAEMONS] = {{.seq = 0}};
    enum status st = copy_log(from, to, LOG_CHANGES, &to->changes, trimmed, e);

    if (st == ST_OK && memcmp(to->changes.hash, from->changes.hash, LOG_HASH) != 0)
        st = errinfo_set(e, ST_ECORRUPT, "the change log has no end");
    to->accesses = from->accesses;
    return st == ST_OK ? copy_log(from, to, LOG_ACCESSES, trimmed, none, e) : st;
}

/* ---- subjects */

enum status admin_each(struct log_txn *t, admin_use *use, void *arg, struct errinfo *e)
{
    struct store_subject *page = NULL;
    struct rows_subject of = {.revision = 0};
    int64_t after = 0;
    size_t n;
    enum status st;

    while ((st = rows_subject_list(t, after, PAGE, &page, &n, e)) == ST_OK && n > 0) {
        for (size_t i = 0; i < n && st == ST_OK; i++)
            if ((st = rows_subject_get(t, page[i].uid, &of, e)) == ST_OK)
                st = use(arg, t, &of, e);
        after = page[n - 1].key;
        free(page);
        if (st != ST_OK)
            break;
    }
    sodium_memzero(&of, sizeof of);
    return st;
}

enum status admin_each_template(struct log_txn *t, const struct rows_subject *of,
                                admin_use_template *use, void *arg, struct errinfo *e)
{
    struct rows_template *list = NULL;
    size_t n, len;
    enum status st = rows_template_list(t, of, &list, &n, e);

    for (size_t i = 0; i < n && st == ST_OK; i++) {
        unsigned char descriptor[SURFACE_DESCRIPTOR], *face;

        if ((st = rows_template_face(t, &list[i], of, &face, &len, e)) == ST_OK &&
            (st = rows_template_descriptor(&list[i], of, descriptor, e)) == ST_OK)
            st = use(arg, &list[i], &(struct rows_face){face, len, descriptor}, e);
        sodium_memzero(descriptor, sizeof descriptor);
        rows_template_wipe(face, len);
    }
    free(list);
    return st;
}

struct copying {
    struct log_txn *to;
    unsigned char *sum;     /* of the rows that were read */
    struct rows_subject as; /* in the copy */
};

static enum status copy_template(void *arg, struct rows_template *row,
                                 const struct rows_face *face, struct errinfo *e)
{
    struct copying *c = arg;

    return rows_template_add(c->to, &c->as, row, face, e);
}

static enum status copy_subject(void *arg, struct log_txn *from,
                                const struct rows_subject *of, struct errinfo *e)
{
    struct copying *c = arg;
    enum status st = rows_subject_add(c->to, &of->one, &c->as, e);

    log_txn_sum(from->crypt, NULL, of->mac, c->sum);
    sodium_add(c->sum, of->templates, LOG_DIGEST); /* which are read against that */
    if (st == ST_OK)
        st = admin_each_template(from, of, copy_template, c, e);
    sodium_memzero(&c->as, sizeof c->as);
    return st;
}

enum status admin_copy_subject(struct log_txn *to, struct log_txn *from,
                               const struct rows_subject *of, struct errinfo *e)
{
    unsigned char sum[LOG_DIGEST] = {0};
    struct copying c = {.to = to, .sum = sum};

    return copy_subject(&c, from, of, e);
}

/* ---- the other rows */

/* Rows of which no more than the MAC depends on a key. */
static enum status copy_table(struct log_txn *from, const struct copying *c,
                              const struct rows_table *table, struct errinfo *e)
{
    unsigned char *row = malloc(table->size);
    struct sql_rows *r = NULL;
    enum status st = row != NULL ? sql_stream(from->sql, table->all, NULL, 0, &r, e)
                                 : errinfo_memory(e);

    while (st == ST_OK && sql_next(r))
        if ((st = rows_table_read(from, table, r, 0, row, e)) == ST_OK) {
            log_txn_sum(from->crypt, NULL, row + table->mac, c->sum);
            st = rows_table_insert(c->to, table, row, e);
        }
    free(row);
    return sql_done(r, st, e);
}

/* Rows that are not authenticated, as they are: of n columns, of which add takes each. */
static enum status copy_plain(struct log_txn *from, struct log_txn *to, const char *list,
                              const char *add, int n, struct errinfo *e)
{
    struct sql_value value[7];
    struct sql_rows *r;
    enum status st = sql_stream(from->sql, list, NULL, 0, &r, e);

    while (st == ST_OK && sql_next(r)) {
        for (int i = 0; i < n; i++)
            value[i] = sql_column(r, i);
        st = sql_run(to->sql, add, value, (size_t)n, e);
    }
    return sql_done(r, st, e);
}

/* Copies the rows without a MAC: times of last use, scores and scans of the days, failed attempts, used
 * nonces. */
static enum status copy_unauthenticated(struct log_txn *from, struct log_txn *to,
                                        struct errinfo *e)
{
    enum status st;

    if ((st = copy_plain(from, to, "SELECT used, id FROM tokens WHERE used IS NOT NULL",
                         "UPDATE tokens SET used = $1 WHERE id = $2", 2, e)) != ST_OK ||
        (st = copy_plain(from, to, "SELECT day, decision, daemon, bins FROM days",
                         "INSERT INTO days (day, decision, daemon, bins) "
                         "VALUES ($1, $2, $3, $4)",
                         4, e)) != ST_OK ||
        (st = copy_plain(from, to,
                         "SELECT day, token, daemon, n, unusable, noise_um, quality "
                         "FROM scans",
                         "INSERT INTO scans (day, token, daemon, n, unusable, noise_um, "
                         "quality) VALUES ($1, $2, $3, $4, $5, $6, $7)",
                         7, e)) != ST_OK ||
        (st = copy_plain(
             from, to,
             "SELECT s.uid, a.token, a.failures, a.at_ms, a.suspicion "
             "FROM attempts a JOIN subjects s USING (subject_key)",
             "INSERT INTO attempts (subject_key, token, failures, at_ms, suspicion) "
             "VALUES ((SELECT subject_key FROM subjects WHERE uid = $1), $2, "
             "$3, $4, $5)",
             5, e)) != ST_OK)
        return st;
    return copy_plain(from, to, "SELECT until_ms, nonce FROM nonces",
                      "INSERT INTO nonces (until_ms, nonce) VALUES ($1, $2)", 2, e);
}

/* The rows that were read are those of the last change. */
static enum status need_all(struct log_txn *from, const unsigned char sum[LOG_DIGEST],
                            struct errinfo *e)
{
    bool same;
    const enum status st = log_txn_agrees(from, sum, &same, e);

    return st != ST_OK || same ? st
                               : errinfo_set(e, ST_EREFUSED, "%s", rows_digest_problem);
}

enum status admin_copy_all(void *arg, struct log_txn *from, struct log_txn *to,
                           struct errinfo *e)
{
    unsigned char sum[LOG_DIGEST] = {0};
    struct copying c = {.to = to, .sum = sum};
    enum status st;

    (void)arg;
    if ((st = copy_logs(from, to, e)) != ST_OK ||
        (st = admin_each(from, copy_subject, &c, e)) != ST_OK ||
        (st = copy_table(from, &c, &rows_tokens, e)) != ST_OK ||
        (st = copy_table(from, &c, &rows_devices, e)) != ST_OK ||
        (st = copy_table(from, &c, &rows_calibrations, e)) != ST_OK ||
        (st = need_all(from, sum, e)) != ST_OK)
        return st;
    return copy_unauthenticated(from, to, e);
}

/* ---- as it is */

/* Each row as it is written, in the order of its table: its MAC stays. */
static enum status copy_rows(struct log_txn *from, struct log_txn *to,
                             const struct rows_table *table,
                             unsigned char sum[LOG_DIGEST], struct errinfo *e)
{
    struct sql_value value[ROWS_COLUMNS + 1];
    unsigned char mac[CRYPT_HASH];
    const int n = table->columns + 1;
    struct sql_rows *r;
    enum status st = sql_stream(from->sql, table->all, NULL, 0, &r, e);

    while (st == ST_OK && sql_next(r)) {
        if (!rows_table_is(from, table, r, 0, mac)) {
            st = rows_table_damaged(table, r, 0, e);
            break;
        }
        log_txn_sum(from->crypt, NULL, mac, sum);
        for (int i = 0; i < n; i++)
            value[i] = sql_column(r, i);
        st = sql_run_one(to->sql, table->insert, value, (size_t)n, e);
    }
    return sql_done(r, st, e);
}

/* A file is verified after it was written.  On a server no other connection sees the copy before the commit. */
static enum status verify_copy(struct log_txn *to, struct errinfo *e)
{
    const enum status st = log_txn_begin(to, e);

    return st != ST_OK || sql_file_is(to->sql) ? st : store_txn_verify(to, NULL, NULL, e);
}

enum status admin_copy_as_is(void *arg, struct log_txn *from, struct log_txn *to,
                             struct errinfo *e)
{
    unsigned char sum[LOG_DIGEST] = {0};
    enum status st = copy_logs(from, to, e);

    (void)arg;
    for (size_t i = 0; i < ROWS_TABLES && st == ST_OK; i++)
        st = copy_rows(from, to, rows_tables[i], sum, e);
    if (st != ST_OK || (st = need_all(from, sum, e)) != ST_OK ||
        (st = copy_plain(from, to,
                         "SELECT t.id, f.face, f.mesh FROM templates t JOIN faces f "
                         "USING (template_key) ORDER BY t.template_key",
                         "INSERT INTO faces (template_key, face, mesh) VALUES "
                         "((SELECT template_key FROM templates WHERE id = $1), $2, $3)",
                         3, e)) != ST_OK ||
        (st =
             copy_plain(from, to, "SELECT seen, uid FROM subjects WHERE seen IS NOT NULL",
                        "UPDATE subjects SET seen = $1 WHERE uid = $2", 2, e)) != ST_OK ||
        (st = copy_unauthenticated(from, to, e)) != ST_OK)
        return st;
    return verify_copy(to, e);
}

/* ---- the copy */

static enum status write_copy(struct log_txn *from, struct log_txn *to,
                              const struct admin_copy *c, struct errinfo *e)
{
    struct crypt_root same;
    enum status st = sql_create(to->sql, e);

    if (st == ST_OK && c->root == NULL)
        st = rows_root_read(from->sql, &same, e);
    if (st != ST_OK ||
        (st = rows_root_write(to->sql, c->root != NULL ? c->root : &same, e)) != ST_OK ||
        (st = c->fill(c->arg, from, to, e)) != ST_OK || c->kind == NULL)
        return st;
    return log_change(to, c->kind, NULL, "", c->outcome, e);
}

static enum status fill_one(struct store *from, struct sql *d, struct admin_copy *c,
                            struct errinfo *e)
{
    struct log seen;
    struct log_txn source, to = {.log = &seen,
                                 .crypt = c->crypt != NULL ? c->crypt : from->crypt,
                                 .how = SQL_COPY};
    enum status st;

    if ((st = log_act(&to.by, c->actor != NULL ? c->actor : "", e)) != ST_OK)
        return st;
    log_init(&seen);
    log_txn_create(&to);
    if ((st = store_begin(from, SQL_READ, &source, e)) == ST_OK) {
        if ((st = sql_begin(d, SQL_COPY, &to.sql, e)) == ST_OK) {
            st = write_copy(&source, &to, c, e);
            to.added = LOG_CHANGES; /* the last of them proves the commit */
            log_txn_prove(&to);
            st = sql_end(to.sql, st, e);
        }
        st = store_end(from, &source, st, e);
    }
    log_free(&seen);
    c->end = to.changes;
    return st;
}

enum status admin_copy(struct store *from, const char *path, struct admin_copy *c,
                       struct newfile *n, struct errinfo *e)
{
    const bool file = !store_on_server(path);
    struct store *copy;
    struct sql *d = NULL;
    enum status st = ST_OK;

    *n = (struct newfile)NEWFILE_NONE;
    if (file)
        st = newfile_open(path, n, e);
    path = file ? n->part : path;
    if (st == ST_OK &&
        (st = sql_open(path, file ? SQL_OPEN_WRITE : SQL_OPEN_CREATE, &d, e)) == ST_OK)
        st = sql_version(d) == 0
                 ? fill_one(from, d, c, e)
                 : errinfo_set(e, ST_EEXISTS, "there is a database %.160s already", path);
    sql_close(d);
    if (st == ST_OK &&
        (st = admin_open(path, c->key, NULL, &copy, &c->found, e)) == ST_OK)
        store_close(copy);
    return st;
}

/* ---- the swap */

enum status admin_in_file(const char *path, const char *instead, struct errinfo *e)
{
    return !store_on_server(path)
               ? ST_OK
               : errinfo_set(e, ST_EINVAL, "%.160s is on a server: %s", path, instead);
}

/* Another link to the database that is there, of a swap that was killed before it replaced it. */
static enum status clear_name(const char *path, const char *aside, struct errinfo *e)
{
    if (newfile_missing(aside))
        return ST_OK;
    if (sql_file_same(path, aside) && unlink(aside) == 0)
        return ST_OK;
    return errinfo_set(e, ST_EEXISTS,
                       "there is a file %.200s already: move it away first", aside);
}

enum status admin_swap(const char *path, struct store *held, struct newfile *n,
                       const char *aside, struct errinfo *e)
{
    enum status st = ST_OK;

    if (held != NULL && (st = clear_name(path, aside, e)) == ST_OK &&
        (st = sql_file_fold(held->sql, e)) == ST_OK && link(path, aside) != 0)
        st = errinfo_set(e, ST_EIO, "cannot call %.150s %.150s: %s", path, aside,
                         strerror(errno));
    if (st != ST_OK)
        return st;
    newfile_like(n->fd, path);
    if ((st = newfile_commit(n, e)) == ST_OK)
        return st;
    if (st != ST_EUNSYNCED && held != NULL && sql_file_same(path, aside))
        (void)unlink(aside); /* its other name is still there */
    return st;
}

enum status admin_unfinished(enum status st, const char *done, const struct errinfo *why,
                             struct errinfo *e)
{
    return st == ST_OK
               ? ST_OK
               : errinfo_set(e, st,
                             "%s, but %.300s; nothing that is needed was removed: "
                             "run the command again",
                             done, why->msg);
}

static bool overwrite(int fd, off_t size)
{
    static const char zeros[65536];

    for (off_t at = 0; at < size;) {
        const off_t left = size - at;
        const ssize_t n = pwrite(
            fd, zeros, left < (off_t)sizeof zeros ? (size_t)left : sizeof zeros, at);

        if (n <= 0)
            return false;
        at += n;
    }
    return fsync(fd) == 0;
}

enum status admin_discard(const char *path, struct errinfo *e)
{
    const int fd = open(path, O_WRONLY | O_NOFOLLOW | O_CLOEXEC);
    const int folder = newfile_open_directory(path);
    struct stat sb;
    enum status st = ST_OK;

    if (fd < 0 || folder < 0 || fstat(fd, &sb) != 0 || !S_ISREG(sb.st_mode) ||
        !overwrite(fd, sb.st_size) || unlink(path) != 0)
        st = errinfo_set(e, ST_EIO, "cannot overwrite and remove %.160s: %s", path,
                         strerror(errno));
    else if (!newfile_sync_directory(folder))
        st = errinfo_set(e, ST_EUNSYNCED,
                         "%.160s is overwritten and removed, but its folder cannot be "
                         "flushed to the disk: %s",
                         path, strerror(errno));
    if (fd >= 0)
        (void)close(fd);
    if (folder >= 0)
        (void)close(folder);
    return st;
}
