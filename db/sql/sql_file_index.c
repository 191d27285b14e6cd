#include "sql_file_index.h"

#include <sodium.h>
#include <string.h>

#include "errinfo.h"
#include "schema_sql.h"
#include "sql_file.h"
#include "sql_sqlite.h"

/* PRAGMA integrity_check looks for each row in each index, so at a random place: of more rows than its
 * cache holds it reads a page for each.  Here each index and each table is read once, in its order:
 * an index that is in its order, and has the keys of its table's rows and no others, leads every
 * search to where it should. */

#define KEY_MAX   1024 /* bytes of an index's key as it is compared: twice what ours have */
#define ROW_BYTES 8    /* of them, the last ones: the row's own key */
#define INDEXES   8    /* of a table, at most */

struct sql_file_index_walk {
    struct sql_sqlite_conn *c;
    sql_report *report;
    void *arg;
    uint64_t problems;
    unsigned char hash_key[crypto_shorthash_KEYBYTES]; /* of this walk alone */
};

struct index {
    char name[64], columns[128];
    char where[64]; /* " WHERE ..." of one that does not have all rows, or "" */
    int n;          /* columns */
    bool unique;
    uint64_t sum; /* of its entries' hashes, less those of its table's rows */
};

struct key {
    size_t n;
    unsigned char bytes[KEY_MAX];
};

static void problem(struct sql_file_index_walk *w, const char *name, const char *what)
{
    char line[160];

    (void)sqlite3_snprintf((int)sizeof line, line, "%s: %s", name, what);
    w->report(w->arg, line);
    w->problems++;
}

static enum status sql_file_index_prepare(sqlite3 *db, const char *text,
                                          sqlite3_stmt **out)
{
    return sqlite3_prepare_v2(db, text, -1, out, NULL) == SQLITE_OK ? ST_OK : ST_EDB;
}

/* ---- the schema */

/* Everything that belongs to one table. */
static const char of_table[] =
    "SELECT group_concat(type || ' ' || name || ' ' || ifnull(sql, ''), char(10)) FROM "
    "(SELECT * FROM sqlite_schema WHERE tbl_name = $1 COLLATE NOCASE ORDER BY type, name)";

/* Other tables may be there: a tool that replicates the file may have made them. */
static enum status compare_schemas(struct sql_file_index_walk *w, sqlite3 *own)
{
    sqlite3_stmt *names = NULL, *a = NULL, *b = NULL;
    enum status st = ST_OK;
    int rc = SQLITE_ERROR;

    if (sql_file_index_prepare(own, "SELECT DISTINCT tbl_name FROM sqlite_schema",
                               &names) != ST_OK ||
        sql_file_index_prepare(own, of_table, &a) != ST_OK ||
        sql_file_index_prepare(w->c->db, of_table, &b) != ST_OK)
        st = ST_EDB;
    while (st == ST_OK && (rc = sqlite3_step(names)) == SQLITE_ROW) {
        const char *name = (const char *)sqlite3_column_text(names, 0);

        if (sqlite3_bind_value(a, 1, sqlite3_column_value(names, 0)) != SQLITE_OK ||
            sqlite3_bind_text(b, 1, name, -1, SQLITE_TRANSIENT) != SQLITE_OK ||
            sqlite3_step(a) != SQLITE_ROW || sqlite3_step(b) != SQLITE_ROW)
            st = ST_EDB;
        else if (sqlite3_column_bytes(a, 0) != sqlite3_column_bytes(b, 0) ||
                 sqlite3_column_type(b, 0) != SQLITE_TEXT ||
                 memcmp(sqlite3_column_text(a, 0), sqlite3_column_text(b, 0),
                        (size_t)sqlite3_column_bytes(a, 0)) != 0)
            problem(w, name,
                    "the table or its indexes are not declared as this program does");
        (void)sqlite3_reset(a);
        (void)sqlite3_reset(b);
    }
    (void)sqlite3_finalize(names);
    (void)sqlite3_finalize(a);
    (void)sqlite3_finalize(b);
    return rc == SQLITE_DONE ? st : ST_EDB;
}

static enum status check_schema(struct sql_file_index_walk *w, struct errinfo *e)
{
    sqlite3 *own = NULL;
    enum status st = ST_EDB;

    if (sqlite3_open(":memory:", &own) == SQLITE_OK &&
        sqlite3_exec(own, schema_sql, NULL, NULL, NULL) == SQLITE_OK)
        st = compare_schemas(w, own);
    if (st != ST_OK && sqlite3_errcode(own) == SQLITE_NOMEM)
        st = errinfo_set(e, ST_ENOMEM, "no memory for the schema");
    else if (st != ST_OK)
        st = sql_sqlite_conn_fail(w->c, "cannot check the schema", e);
    (void)sqlite3_close(own);
    return st;
}

/* ---- keys */

static void put_bytes(struct key *k, uint64_t big, int n)
{
    while (n-- > 0)
        k->bytes[k->n++] = (unsigned char)(big >> 8 * n);
}

/* memcmp() compares them as SQLite does the values: NULL, numbers, texts, blobs; a zero is two bytes,
 * so that it is more than the end, which is two zeros.  False: longer than any of ours. */
static bool put_column(struct key *k, sqlite3_stmt *stmt, int col)
{
    const int type = sqlite3_column_type(stmt, col);
    const unsigned char *p;
    size_t n;

    if (type == SQLITE_FLOAT || k->n + 16 > sizeof k->bytes)
        return false;
    k->bytes[k->n++] = type == SQLITE_NULL ? 0 : (unsigned char)type;
    if (type == SQLITE_INTEGER)
        put_bytes(k, (uint64_t)sqlite3_column_int64(stmt, col) ^ (uint64_t)1 << 63, 8);
    if (type == SQLITE_INTEGER || type == SQLITE_NULL)
        return true;
    p = sqlite3_column_blob(stmt, col);
    n = (size_t)sqlite3_column_bytes(stmt, col);
    if (k->n + 2 * n + 16 > sizeof k->bytes)
        return false;
    for (size_t i = 0; i < n; i++) {
        k->bytes[k->n++] = p[i];
        if (p[i] == 0)
            k->bytes[k->n++] = 0xff;
    }
    put_bytes(k, 0, 2);
    return true;
}

/* The key in n columns, then the row's; false: it cannot be one of ours. */
static bool read_key(struct key *k, sqlite3_stmt *stmt, int col, int n, int64_t row)
{
    k->n = 0;
    for (int i = 0; i < n; i++)
        if (!put_column(k, stmt, col + i))
            return false;
    put_bytes(k, (uint64_t)row ^ (uint64_t)1 << 63, ROW_BYTES);
    return true;
}

static uint64_t hash(const struct sql_file_index_walk *w, const struct key *k)
{
    unsigned char bytes[crypto_shorthash_BYTES];
    uint64_t h = 0;

    (void)crypto_shorthash(bytes, k->bytes, k->n, w->hash_key);
    for (size_t i = 0; i < sizeof bytes; i++)
        h = h << 8 | bytes[i];
    return h;
}

/* Of a unique index without the row's key, which is last; but NULL is not unique. */
static bool is_before(const struct key *a, const struct key *b, bool unique)
{
    const size_t less = unique && a->bytes[0] != 0 ? ROW_BYTES : 0;
    const size_t an = a->n - less, bn = b->n - less;
    const int order = memcmp(a->bytes, b->bytes, an < bn ? an : bn);

    return order < 0 || (order == 0 && an < bn);
}

/* ---- walks */

static enum status prepared(struct sql_file_index_walk *w, sqlite3_str *text,
                            sqlite3_stmt **out)
{
    char *const sql = sqlite3_str_finish(text);
    const enum status st =
        sql != NULL ? sql_file_index_prepare(w->c->db, sql, out) : ST_ENOMEM;

    sqlite3_free(sql);
    return st;
}

static enum status walk_index(struct sql_file_index_walk *w, const char *table,
                              struct index *x)
{
    sqlite3_str *text = sqlite3_str_new(NULL);
    struct key key[2] = {{.n = 0}, {.n = 0}}; /* this one, and the one before */
    sqlite3_stmt *stmt = NULL;
    bool ordered = true;
    int rc = SQLITE_ERROR, now = 0;
    enum status st;

    sqlite3_str_appendf(text,
                        "SELECT %s, rowid FROM %s INDEXED BY %s%s ORDER BY %s, rowid",
                        x->columns, table, x->name, x->where, x->columns);
    st = prepared(w, text, &stmt);
    while (st == ST_OK && ordered && (rc = sqlite3_step(stmt)) == SQLITE_ROW) {
        struct key *k = &key[now], *last = &key[now = !now];

        ordered = read_key(k, stmt, 0, x->n, sqlite3_column_int64(stmt, x->n));
        if (ordered && last->n != 0)
            ordered = is_before(last, k, x->unique);
        x->sum += hash(w, k);
    }
    (void)sqlite3_finalize(stmt);
    if (st == ST_OK && !ordered)
        problem(w, x->name, "the index is not in its order, or has a key twice");
    return st != ST_OK || !ordered || rc == SQLITE_DONE ? st : ST_EDB;
}

/* Each row is looked for by its key, the last first: SQLite goes down the tree for each then, where
 * going up it would only take the next one. */
static enum status walk_table(struct sql_file_index_walk *w, const char *table,
                              struct index *x, size_t n)
{
    sqlite3_str *text = sqlite3_str_new(NULL);
    sqlite3_stmt *stmt = NULL;
    int rc = SQLITE_ERROR;
    bool good = true;
    enum status st;

    sqlite3_str_appendf(text, "SELECT b.rowid");
    for (size_t i = 0; i < n; i++) {
        sqlite3_str_appendf(text, ", %s", x[i].columns);
        if (x[i].where[0] != '\0')
            sqlite3_str_appendf(text, ", %s", x[i].where + strlen(" WHERE "));
    }
    sqlite3_str_appendf(text,
                        " FROM (SELECT rowid AS r FROM %s) AS a LEFT JOIN %s AS b ON "
                        "b.rowid = a.r ORDER BY a.r DESC",
                        table, table);
    st = prepared(w, text, &stmt);
    while (st == ST_OK && good && (rc = sqlite3_step(stmt)) == SQLITE_ROW) {
        const int64_t row = sqlite3_column_int64(stmt, 0);
        int col = 1;

        good = sqlite3_column_type(stmt, 0) == SQLITE_INTEGER;
        for (size_t i = 0; i < n && good; i++) {
            const int first = col;
            struct key k;

            col += x[i].n;
            if (x[i].where[0] != '\0' && sqlite3_column_int(stmt, col++) == 0)
                continue;
            good = read_key(&k, stmt, first, x[i].n, row);
            x[i].sum -= good ? hash(w, &k) : 0;
        }
    }
    (void)sqlite3_finalize(stmt);
    if (st == ST_OK && !good)
        problem(w, table, "a row is not found by its key");
    return st != ST_OK || !good || rc == SQLITE_DONE ? st : ST_EDB;
}

/* The table's indexes, as they are declared. */
static enum status read_indexes(struct sql_file_index_walk *w, const char *table,
                                struct index *x, size_t *n)
{
    static const char text[] =
        "SELECT l.name, (SELECT group_concat(name, ', ') FROM pragma_index_info(l.name)), "
        "(SELECT count(*) FROM pragma_index_info(l.name)), l.\"unique\", "
        "CASE l.partial WHEN 0 THEN '' ELSE substr(s.sql, instr(s.sql, ' WHERE ')) END "
        "FROM pragma_index_list($1) l JOIN sqlite_schema s ON s.name = l.name";
    sqlite3_stmt *stmt = NULL;
    enum status st = sql_file_index_prepare(w->c->db, text, &stmt);
    int rc = SQLITE_ERROR;

    *n = 0;
    if (st == ST_OK)
        (void)sqlite3_bind_text(stmt, 1, table, -1, SQLITE_STATIC);
    while (st == ST_OK && *n < INDEXES && (rc = sqlite3_step(stmt)) == SQLITE_ROW) {
        struct index *to = &x[(*n)++];

        *to = (struct index){.n = sqlite3_column_int(stmt, 2),
                             .unique = sqlite3_column_int(stmt, 3) != 0};
        (void)sqlite3_snprintf((int)sizeof to->name, to->name, "%s",
                               sqlite3_column_text(stmt, 0));
        (void)sqlite3_snprintf((int)sizeof to->columns, to->columns, "%s",
                               sqlite3_column_text(stmt, 1));
        (void)sqlite3_snprintf((int)sizeof to->where, to->where, "%s",
                               sqlite3_column_text(stmt, 4));
    }
    (void)sqlite3_finalize(stmt);
    return st == ST_OK && rc != SQLITE_DONE ? ST_EDB : st;
}

static enum status check_table(struct sql_file_index_walk *w, const char *table,
                               struct errinfo *e)
{
    struct index x[INDEXES];
    size_t n = 0;
    enum status st = read_indexes(w, table, x, &n);

    for (size_t i = 0; i < n && st == ST_OK && w->problems == 0; i++)
        st = walk_index(w, table, &x[i]);
    if (st == ST_OK && w->problems == 0)
        st = walk_table(w, table, x, n);
    for (size_t i = 0; i < n && st == ST_OK && w->problems == 0; i++)
        if (x[i].sum != 0)
            problem(w, x[i].name, "the index has not the rows of its table");
    if (st == ST_ENOMEM)
        return errinfo_set(e, st, "no memory for a statement");
    return st == ST_OK ? ST_OK : sql_sqlite_conn_fail(w->c, "cannot check", e);
}

enum status sql_file_index_check(struct sql_txn *t, sql_report *report, void *arg,
                                 uint64_t *problems, struct errinfo *e)
{
    static const char *const tables[] = {"subjects", "templates", "tokens", "devices",
                                         "calibrations"};
    struct sql_file_index_walk w = {
        .c = (struct sql_sqlite_conn *)t, .report = report, .arg = arg};
    enum status st;

    *problems = 0;
    if (!sql_file_is(t))
        return ST_OK;
    st = check_schema(&w, e);
    crypto_shorthash_keygen(w.hash_key);
    for (size_t i = 0;
         i < sizeof tables / sizeof *tables && st == ST_OK && w.problems == 0; i++)
        st = check_table(&w, tables[i], e);
    *problems = w.problems;
    return st;
}
