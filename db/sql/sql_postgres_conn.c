#include "sql_postgres.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "bytes.h"
#include "sql_postgres_state.h"

#define VALUES     20      /* of a statement, at most */
#define COMMIT_MS  10000   /* limit of the wait for each result, from COMMIT on */
#define LARGE      8192    /* bytes of a statement that are sent before the next one */
#define BATCH_MIN  16      /* rows of a stream that are fetched at a time: as many as */
#define BATCH_SIZE 1000000 /* have about so many bytes, but not more than */
#define BATCH_MAX  5000

enum {
    OID_BOOL = 16,
    OID_BYTEA = 17,
    OID_INT8 = 20,
    OID_INT4 = 23,
    OID_TEXT = 25,
    OID_FLOAT8 = 701
};

struct values { /* of a statement, as they are sent: binary */
    int n;
    size_t size; /* bytes of texts and blobs */
    Oid type[VALUES];
    const char *data[VALUES];
    int len[VALUES], format[VALUES];
    unsigned char number[VALUES][8];
};

/* ---- errors */

/* The first line alone. */
enum status sql_postgres_conn_say(struct errinfo *e, enum status st, const char *what,
                                  const char *text)
{
    return errinfo_set(e, st, "the database server: %s%s%.*s", what,
                       text[0] != '\0' ? ": " : "", (int)strcspn(text, "\n"), text);
}

bool sql_postgres_conn_lost(const struct sql_postgres_conn *c)
{
    return c->lost || PQstatus(c->pg) != CONNECTION_OK;
}

/* Keeps the first error: the others follow from it. */
void sql_postgres_conn_error(struct sql_postgres_conn *c, const PGresult *r)
{
    const char *code = r != NULL ? PQresultErrorField(r, PG_DIAG_SQLSTATE) : NULL;
    const char *text = r != NULL ? PQresultErrorField(r, PG_DIAG_MESSAGE_PRIMARY) : NULL;
    const struct sql_postgres_state *is =
        code != NULL && text != NULL ? sql_postgres_state_of(code) : NULL;

    if (is != NULL && !is->keep)
        c->closing = true;
    if (c->error.code != ST_OK)
        return;
    if (is == NULL)
        (void)sql_postgres_conn_say(&c->error, ST_EBUSY, "the connection was lost",
                                    PQerrorMessage(c->pg));
    else
        (void)sql_postgres_conn_say(&c->error, is->st, "it refused a statement", text);
}

enum status sql_postgres_conn_failed(const struct sql_postgres_conn *c, struct errinfo *e)
{
    return errinfo_set(e, c->error.code, "%s", c->error.msg);
}

/* ---- what is on its way */

static void drop_rows(struct sql_postgres_rows *r)
{
    PQclear(r->result);
    free(r->key);
    free(r);
}

/* Nothing more comes of this connection. */
static void lose(struct sql_postgres_conn *c)
{
    sql_postgres_conn_error(c, NULL);
    c->lost = true;
    for (; c->n > 0; c->n--, c->first = (c->first + 1) % SQL_POSTGRES_SENT)
        if (c->sent[c->first].rows != NULL)
            c->sent[c->first].rows->here = true;
    c->unsynced = c->unproved = false;
}

static int64_t limit(const struct sql_postgres_conn *c, int64_t from)
{
    return from + c->wait_ms < c->until ? from + c->wait_ms : c->until;
}

/* The end of a wait in vain, until the time `until` or until the connection failed. */
static void give_up(struct sql_postgres_conn *c, int64_t until)
{
    if (sql_postgres_wait_clock() >= until && c->error.code == ST_OK)
        (void)errinfo_set(&c->error, ST_EBUSY,
                          "the database server: %s did not answer within %d s",
                          PQhost(c->pg), c->wait_ms / 1000);
    lose(c);
}

/* Waits until PQgetResult() returns without waiting.  The time limit begins at `from`.  Returns false if
 * the connection was lost. */
static bool await(struct sql_postgres_conn *c, int64_t from)
{
    const bool here = sql_postgres_wait(c->pg, limit(c, from));

    if (!here)
        give_up(c, limit(c, from));
    return here;
}

/* libpq keeps what the socket does not take: memory, which it also moves with each statement. */
static void send_all(struct sql_postgres_conn *c)
{
    const int64_t until = limit(c, sql_postgres_wait_clock());

    if (!sql_postgres_wait_sent(c->pg, until))
        give_up(c, until);
}

static bool is_good(const PGresult *r)
{
    const ExecStatusType is = PQresultStatus(r);

    return is == PGRES_COMMAND_OK || is == PGRES_TUPLES_OK || is == PGRES_PIPELINE_SYNC;
}

static uint64_t count_changed(PGresult *r)
{
    return strtoull(PQcmdTuples(r), NULL, 10);
}

static void take_result(struct sql_postgres_conn *c, const struct sql_postgres_sent *s,
                        PGresult *r)
{
    if (!is_good(r))
        sql_postgres_conn_error(c, r);
    if (!is_good(r) && s->kind == SQL_POSTGRES_PREPARE)
        s->slot->prepared = false;
    if (s->kind == SQL_POSTGRES_COMMIT)
        c->committed = strcmp(PQcmdStatus(r), "COMMIT") == 0;
    if (is_good(r) && (s->kind == SQL_POSTGRES_RUN || s->kind == SQL_POSTGRES_RUN_ONE))
        c->changed = count_changed(r);
    if (is_good(r) && s->kind == SQL_POSTGRES_RUN_ONE && c->changed != 1 &&
        c->error.code == ST_OK)
        (void)sql_one_row(c->changed, &c->error);
    if (s->rows != NULL) {
        s->rows->here = true;
        s->rows->result = is_good(r) ? r : NULL;
    }
    if (s->rows == NULL || !is_good(r))
        PQclear(r);
}

/* Receives the result of the oldest statement on its way, and the NULL that libpq has behind it. */
static void receive(struct sql_postgres_conn *c)
{
    const struct sql_postgres_sent s = c->sent[c->first];
    const int64_t from = sql_postgres_wait_clock();
    PGresult *r = await(c, from) ? PQgetResult(c->pg) : NULL;

    if (r == NULL || sql_postgres_conn_lost(c)) {
        sql_postgres_conn_error(c, r);
        PQclear(r);
        lose(c);
        return;
    }
    c->first = (c->first + 1) % SQL_POSTGRES_SENT;
    c->n--;
    take_result(c, &s, r);
    if (s.kind == SQL_POSTGRES_SYNC)
        return;
    if (await(c, from) && (r = PQgetResult(c->pg)) != NULL) {
        PQclear(r);
        lose(c);
    }
}

/* The server keeps small replies until it is asked for them. */
static void push(struct sql_postgres_conn *c, struct sql_postgres_sent s)
{
    if (c->n == SQL_POSTGRES_SENT) {
        if (PQsendFlushRequest(c->pg) != 1 || PQflush(c->pg) < 0)
            lose(c);
        while (c->n > SQL_POSTGRES_SENT / 2)
            receive(c);
    }
    if (!c->lost)
        c->sent[(c->first + c->n++) % SQL_POSTGRES_SENT] = s;
    else if (s.rows != NULL)
        s.rows->here = true;
}

/* Has the server answer, without waiting for it: a round trip begins. */
static void flush(struct sql_postgres_conn *c)
{
    if (!c->unsynced)
        return;
    c->unsynced = false;
    if (PQpipelineSync(c->pg) == 1)
        push(c, (struct sql_postgres_sent){.kind = SQL_POSTGRES_SYNC});
    else
        lose(c);
}

void sql_postgres_conn_settle(struct sql_postgres_conn *c,
                              const struct sql_postgres_rows *r)
{
    flush(c);
    while (c->n > 0 && (r == NULL || !r->here))
        receive(c);
    if (r == NULL)
        c->unproved = false;
}

PGresult *sql_postgres_conn_exec(struct sql_postgres_conn *c, const char *text)
{
    const int64_t from = sql_postgres_wait_clock();
    PGresult *r = NULL, *next;

    if (PQsendQuery(c->pg, text) != 1)
        lose(c);
    while (!c->lost && await(c, from) && (next = PQgetResult(c->pg)) != NULL) {
        if (!is_good(next))
            sql_postgres_conn_error(c, next);
        PQclear(r);
        r = next;
    }
    return r;
}

/* A server that ends a connection says so, and then closes it: the second call finds that.  The end
 * of the last transaction may still be on its way. */
bool sql_postgres_conn_good(struct sql_postgres_conn *c)
{
    if (PQconsumeInput(c->pg) == 0 || PQconsumeInput(c->pg) == 0)
        return false;
    while (c->n > 0 && !PQisBusy(c->pg))
        receive(c);
    return c->error.code == ST_OK && !sql_postgres_conn_lost(c);
}

/* ---- statements */

static bool set_values(struct values *p, const struct sql_value *value, size_t n)
{
    p->n = (int)n;
    p->size = 0;
    for (size_t i = 0; i < n && n <= VALUES; i++) {
        const struct sql_value *v = &value[i];
        uint64_t bits = (uint64_t)v->i;

        if (v->type == SQL_REAL)
            memcpy(&bits, &v->r, sizeof bits);
        for (int k = 0; k < 8; k++)
            p->number[i][k] = (unsigned char)(bits >> (56 - 8 * k));
        p->format[i] = 1;
        p->data[i] = (const char *)p->number[i];
        p->len[i] = 8;
        p->type[i] = v->type == SQL_INT ? OID_INT8 : OID_FLOAT8;
        if (v->type == SQL_TEXT || v->type == SQL_BLOB) {
            if (v->n > INT32_MAX)
                return false;
            p->type[i] = v->type == SQL_TEXT ? OID_TEXT : OID_BYTEA;
            p->data[i] = v->n > 0 ? v->data : "";
            p->len[i] = (int)v->n;
            p->size += v->n;
        } else if (v->type == SQL_NULL) {
            p->type[i] = 0;
            p->data[i] = NULL;
        }
    }
    return n <= VALUES;
}

/* FNV-1a, 64 bits: one text has one name, whichever literal it is. */
static uint64_t hash(const char *text)
{
    uint64_t h = 0xcbf29ce484222325U;

    for (; *text != '\0'; text++)
        h = (h ^ (unsigned char)*text) * 0x100000001b3U;
    return h;
}

static struct sql_postgres_slot *find_slot(struct sql_postgres_conn *c, const char *text,
                                           uint64_t h)
{
    for (size_t i = 0; i < SQL_POSTGRES_SLOTS; i++) {
        struct sql_postgres_slot *s = &c->slot[(h + i) % SQL_POSTGRES_SLOTS];

        if (s->text == NULL || s->text == text || strcmp(s->text, text) == 0)
            return s;
    }
    return NULL;
}

/* Sends a statement, and prepares it before if it is new. */
static enum status post(struct sql_postgres_conn *c, const char *text,
                        const struct sql_value *value, size_t n,
                        enum sql_postgres_kind kind, struct sql_postgres_rows *rows,
                        struct errinfo *e)
{
    const uint64_t h = hash(text);
    struct sql_postgres_slot *slot = find_slot(c, text, h);
    struct values p;
    char name[24];

    if (c->error.code != ST_OK)
        return sql_postgres_conn_failed(c, e);
    if (slot == NULL || !set_values(&p, value, n))
        return errinfo_set(e, ST_EINTERNAL, "too many statements or values: %.80s", text);
    (void)snprintf(name, sizeof name, "s%016" PRIx64, h);
    slot->text = text;
    if (!slot->prepared) {
        if (PQsendPrepare(c->pg, name, text, p.n, p.type) != 1)
            lose(c);
        else
            push(c,
                 (struct sql_postgres_sent){.kind = SQL_POSTGRES_PREPARE, .slot = slot});
        slot->prepared = true;
    }
    c->unsynced = true;
    if (c->error.code == ST_OK &&
        PQsendQueryPrepared(c->pg, name, p.n, p.data, p.len, p.format, 1) != 1)
        lose(c);
    if (c->error.code != ST_OK)
        return sql_postgres_conn_failed(c, e);
    c->unproved = c->unproved || kind == SQL_POSTGRES_RUN_ONE;
    push(c, (struct sql_postgres_sent){.kind = kind, .rows = rows});
    if (p.size > LARGE)
        send_all(c);
    return ST_OK;
}

/* ---- rows */

static unsigned char *key_of(const struct sql_value *value, size_t n, size_t *len)
{
    unsigned char *key, *to;

    *len = 0;
    for (size_t i = 0; i < n; i++)
        *len += 24 + value[i].n;
    if ((key = to = calloc(*len + 1, 1)) == NULL)
        return NULL;
    for (size_t i = 0; i < n; i++) {
        bytes_put_number(&to, (uint64_t)value[i].type, 8);
        bytes_put_number(&to, value[i].n, 8);
        if (value[i].type == SQL_REAL)
            bytes_put_real(&to, value[i].r);
        else
            bytes_put_number(&to, (uint64_t)value[i].i, 8);
        if (value[i].n > 0)
            bytes_put(&to, value[i].data, value[i].n);
    }
    return key;
}

static struct sql_postgres_rows *new_rows(struct sql_postgres_conn *c, const char *text)
{
    struct sql_postgres_rows *r = calloc(1, sizeof *r);

    if (r != NULL)
        *r = (struct sql_postgres_rows){
            .base.driver = &sql_postgres_driver, .conn = c, .text = text, .at = -1};
    return r;
}

/* The rows that were sent ahead by this query. */
static struct sql_postgres_rows *unpark(struct sql_postgres_conn *c, const char *text,
                                        const struct sql_value *value, size_t n)
{
    struct sql_postgres_rows **at = &c->parked, *r = NULL;
    unsigned char *key;
    size_t len;

    if (c->parked == NULL || (key = key_of(value, n, &len)) == NULL)
        return NULL;
    while ((r = *at) != NULL && (strcmp(r->text, text) != 0 || r->key_len != len ||
                                 memcmp(r->key, key, len) != 0))
        at = &r->next;
    if (r != NULL)
        *at = r->next;
    free(key);
    return r;
}

/* The next rows of a cursor. */
static enum status fetch(struct sql_postgres_rows *r, struct errinfo *e)
{
    char text[64];

    (void)snprintf(text, sizeof text, "FETCH FORWARD %d FROM c%u", r->batch, r->cursor);
    r->here = true; /* without a result: an error, until they are asked for */
    r->at = -1;
    PQclear(r->result);
    r->result = NULL;
    if (r->conn->error.code != ST_OK)
        return sql_postgres_conn_failed(r->conn, e);
    r->conn->unsynced = true;
    if (PQsendQueryParams(r->conn->pg, text, 0, NULL, NULL, NULL, NULL, 1) != 1) {
        lose(r->conn);
        return sql_postgres_conn_failed(r->conn, e);
    }
    r->here = false;
    push(r->conn, (struct sql_postgres_sent){.kind = SQL_POSTGRES_QUERY, .rows = r});
    return ST_OK;
}

static enum status declare(struct sql_postgres_rows *r, const struct sql_value *value,
                           size_t n, struct errinfo *e)
{
    const size_t size = strlen(r->text) + 64;
    struct sql_postgres_conn *c = r->conn;
    struct values p;
    bool sent;
    char *text;

    if (c->error.code != ST_OK)
        return sql_postgres_conn_failed(c, e);
    if ((text = malloc(size)) == NULL || !set_values(&p, value, n)) {
        free(text);
        return errinfo_memory(e);
    }
    r->cursor = ++c->cursors;
    r->batch = BATCH_MIN;
    (void)snprintf(text, size, "DECLARE c%u NO SCROLL CURSOR FOR %s", r->cursor, r->text);
    sent = PQsendQueryParams(c->pg, text, p.n, p.type, p.data, p.len, p.format, 1) == 1;
    free(text);
    if (!sent) {
        lose(c);
        return sql_postgres_conn_failed(c, e);
    }
    push(c, (struct sql_postgres_sent){.kind = SQL_POSTGRES_RUN});
    return fetch(r, e);
}

enum status sql_postgres_conn_query(struct sql_txn *t, const char *text,
                                    const struct sql_value *value, size_t n, bool stream,
                                    struct sql_rows **out, struct errinfo *e)
{
    struct sql_postgres_conn *c = (struct sql_postgres_conn *)t;
    struct sql_postgres_rows *r = c->base.ahead ? NULL : unpark(c, text, value, n);
    enum status st;

    *out = r != NULL ? &r->base : NULL;
    if (r != NULL)
        return ST_OK;
    if ((r = new_rows(c, text)) == NULL ||
        (c->base.ahead && (r->key = key_of(value, n, &r->key_len)) == NULL)) {
        free(r);
        return errinfo_memory(e);
    }
    st = stream ? declare(r, value, n, e)
                : post(c, text, value, n, SQL_POSTGRES_QUERY, r, e);
    if (st != ST_OK) {
        drop_rows(r);
    } else if (c->base.ahead) {
        r->next = c->parked;
        c->parked = r;
    } else {
        *out = &r->base;
    }
    return st;
}

/* As many bytes again, about. */
static int next_batch(const struct sql_postgres_rows *r)
{
    size_t bytes = 1;
    int n;

    for (int i = 0; i < PQnfields(r->result); i++)
        bytes += (size_t)PQgetlength(r->result, r->at - 1, i);
    n = bytes > BATCH_SIZE / BATCH_MIN ? BATCH_MIN : (int)(BATCH_SIZE / bytes);
    return n < BATCH_MAX ? n : BATCH_MAX;
}

bool sql_postgres_conn_next(struct sql_rows *rows)
{
    struct sql_postgres_rows *r = (struct sql_postgres_rows *)rows;

    sql_postgres_conn_settle(r->conn, r);
    if (r->result == NULL)
        return false;
    if (++r->at < PQntuples(r->result))
        return true;
    if (r->cursor == 0 || PQntuples(r->result) < r->batch)
        return false;
    r->batch = next_batch(r);
    if (fetch(r, NULL) != ST_OK)
        return false;
    sql_postgres_conn_settle(r->conn, r);
    return r->result != NULL && ++r->at < PQntuples(r->result);
}

static int64_t number_of(const char *data, int n)
{
    uint64_t v = n > 0 && (data[0] & 0x80) != 0 ? UINT64_MAX : 0;

    for (int i = 0; i < n; i++)
        v = v << 8 | (unsigned char)data[i];
    return (int64_t)v;
}

/* A type that no statement gives is NULL, which no column is that is never NULL. */
struct sql_value sql_postgres_conn_column(const struct sql_rows *rows, int i)
{
    const struct sql_postgres_rows *r = (const struct sql_postgres_rows *)rows;
    const char *data = PQgetvalue(r->result, r->at, i);
    const int n = PQgetlength(r->result, r->at, i);
    const Oid type = PQftype(r->result, i);
    struct sql_value v = sql_null();
    uint64_t bits;

    if (PQgetisnull(r->result, r->at, i) || PQfformat(r->result, i) != 1)
        return v;
    if ((type == OID_INT8 && n == 8) || (type == OID_INT4 && n == 4))
        return sql_int(number_of(data, n));
    if (type == OID_BOOL && n == 1)
        return sql_int(data[0] != 0);
    if (type == OID_FLOAT8 && n == 8) {
        bits = (uint64_t)number_of(data, n);
        v.type = SQL_REAL;
        memcpy(&v.r, &bits, sizeof v.r);
    } else if (type == OID_TEXT || type == OID_BYTEA) {
        v = sql_blob(data, (size_t)n);
        v.type = type == OID_TEXT ? SQL_TEXT : SQL_BLOB;
    }
    return v;
}

enum status sql_postgres_conn_done(struct sql_rows *rows, enum status st,
                                   struct errinfo *e)
{
    struct sql_postgres_rows *r = (struct sql_postgres_rows *)rows;
    struct sql_postgres_conn *c = r->conn;

    for (unsigned i = 0; i < c->n && !r->here; i++)
        if (c->sent[(c->first + i) % SQL_POSTGRES_SENT].rows == r)
            c->sent[(c->first + i) % SQL_POSTGRES_SENT].rows = NULL;
    if (st == ST_OK && r->here && r->result == NULL)
        st = sql_postgres_conn_failed(c, e);
    drop_rows(r);
    return st;
}

static void unpark_all(struct sql_postgres_conn *c)
{
    struct sql_postgres_rows *r;

    while ((r = c->parked) != NULL) {
        c->parked = r->next;
        (void)sql_postgres_conn_done(&r->base, ST_ENOTFOUND, NULL);
    }
}

/* ---- changes */

enum status sql_postgres_conn_run(struct sql_txn *t, const char *text,
                                  const struct sql_value *value, size_t n, bool one,
                                  struct errinfo *e)
{
    struct sql_postgres_conn *c = (struct sql_postgres_conn *)t;

    if (c->base.ahead)
        return errinfo_set(e, ST_EINTERNAL, "a change while queries are sent ahead");
    unpark_all(c); /* they do not see it */
    return post(c, text, value, n, one ? SQL_POSTGRES_RUN_ONE : SQL_POSTGRES_RUN, NULL,
                e);
}

enum status sql_postgres_conn_changed(struct sql_txn *t, uint64_t *n, struct errinfo *e)
{
    struct sql_postgres_conn *c = (struct sql_postgres_conn *)t;

    sql_postgres_conn_settle(c, NULL);
    *n = c->changed;
    return c->error.code == ST_OK ? ST_OK : sql_postgres_conn_failed(c, e);
}

/* Before the commit it must be known that each change was of one row. */
enum status sql_postgres_conn_commit(struct sql_postgres_conn *c, struct errinfo *e)
{
    unpark_all(c);
    if (c->unproved)
        sql_postgres_conn_settle(c, NULL);
    c->committing = c->error.code == ST_OK;
    c->wait_ms = COMMIT_MS;
    if (post(c, "COMMIT", NULL, 0, SQL_POSTGRES_COMMIT, NULL, NULL) == ST_OK)
        sql_postgres_conn_settle(c, NULL);
    if (c->committed)
        return ST_OK;
    return c->error.code != ST_OK
               ? sql_postgres_conn_failed(c, e)
               : errinfo_set(e, ST_EDB, "the database server rolled back");
}

/* ROLLBACK is the one statement that a failed transaction takes.  If it is not sent, the server keeps
 * the transaction and its locks until the connection is closed. */
void sql_postgres_conn_rollback(struct sql_postgres_conn *c)
{
    enum status st;

    unpark_all(c);
    if (c->error.code != ST_OK)
        sql_postgres_conn_settle(c, NULL);
    if (sql_postgres_conn_lost(c) || c->closing)
        return;
    c->error.code = ST_OK;
    st = post(c, "ROLLBACK", NULL, 0, SQL_POSTGRES_RUN, NULL, NULL);
    flush(c);
    if (st != ST_OK || PQflush(c->pg) != 0)
        lose(c);
}
