#include "store_audit.h"

#include <inttypes.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include "errinfo.h"
#include "row_entry.h"
#include "row_event.h"
#include "row_subject.h"
#include "store_column.h"
#include "store_rules.h"
#include "store_txn.h"

/* ---- rows */

static enum status read_entry(void *t, const struct sql_rows *from, void *out,
                              struct errinfo *e)
{
    struct store_audit_entry *a = out;
    struct row_entry r;

    (void)t; /* nothing of it is encrypted */
    if (!row_entry_read(from, &r))
        return errinfo_set(e, ST_ECORRUPT,
                           "entry %" PRIu64 " of the audit log (%s) is damaged", r.seq,
                           store_chain_word(r.chain));
    memset(a, 0, sizeof *a);
    a->chain = r.chain;
    a->seq = r.seq;
    memcpy(a->at, r.at, sizeof a->at);
    memcpy(a->kind, r.kind, sizeof a->kind);
    memcpy(a->actor, r.actor, sizeof a->actor);
    memcpy(a->template_id, r.template_id, sizeof a->template_id);
    memcpy(a->outcome, r.outcome, sizeof a->outcome);
    a->uses = r.uses;
    (void)sodium_bin2hex(a->ref, sizeof a->ref, r.ref, r.nref);
    (void)sodium_bin2hex(a->object, sizeof a->object, r.object, r.nobject);
    (void)sodium_bin2hex(a->row, sizeof a->row, r.row, r.nrow);
    (void)sodium_bin2hex(a->uses_hash, sizeof a->uses_hash, r.uses_hash, r.nuses_hash);
    (void)sodium_bin2hex(a->hash, sizeof a->hash, r.hash, sizeof r.hash);
    return ST_OK;
}

static enum status list_mark(void *t, const struct sql_rows *r, void *out,
                             struct errinfo *e)
{
    struct store_audit_mark *a = out;
    struct store_chain_mark m;

    (void)t;
    memset(a, 0, sizeof *a);
    if (!row_entry_mark(r, 0, &m))
        return errinfo_set(e, ST_ECORRUPT, "a checkpoint of the audit log is damaged");
    a->chain = m.chain;
    a->seq = m.seq;
    memcpy(a->at, m.at, sizeof a->at);
    (void)sodium_bin2hex(a->hash, sizeof a->hash, m.hash, sizeof m.hash);
    (void)sodium_bin2hex(a->signature, sizeof a->signature, m.signature,
                         sizeof m.signature);
    return ST_OK;
}

/* ---- names */

struct name {
    char ref[33], subject[STORE_SUBJECT_MAX + 1];
};

static int by_ref(const void *a, const void *b)
{
    return strcmp(((const struct name *)a)->ref, ((const struct name *)b)->ref);
}

/* A subject whose row is damaged has no name here. */
static enum status read_name(void *arg, const struct sql_rows *r, void *out,
                             struct errinfo *e)
{
    struct store_txn *t = arg;
    unsigned char ref[ROW_CRYPT_REF];
    struct name *name = out;
    struct row_crypt_key k;
    struct store_subject who;

    (void)e;
    memset(name, 0, sizeof *name);
    if (row_subject_who(t, r, 0, &who, &k, NULL) == ST_OK) {
        row_crypt_ref(t->vault, who.id, ref);
        (void)sodium_bin2hex(name->ref, sizeof name->ref, ref, sizeof ref);
        memcpy(name->subject, who.id, sizeof name->subject);
    }
    sodium_memzero(&k, sizeof k);
    return ST_OK;
}

static enum status find_names(struct store_txn *t, struct store_audit_entry *a, size_t n,
                              struct errinfo *e)
{
    struct sql_rows *r;
    void *list = NULL;
    size_t count = 0;
    enum status st =
        sql_query(t->sql, "SELECT " ROW_SUBJECT_WHO " FROM subjects s", NULL, 0, &r, e);

    st = store_column_list(r, st, read_name, t, sizeof(struct name), &list, &count, e);
    if (st != ST_OK || count == 0)
        return st;
    qsort(list, count, sizeof(struct name), by_ref);
    for (size_t i = 0; i < n; i++) {
        struct name wanted, *found;

        if (a[i].ref[0] == '\0')
            continue;
        memcpy(wanted.ref, a[i].ref, sizeof wanted.ref);
        found = bsearch(&wanted, list, count, sizeof wanted, by_ref);
        if (found != NULL)
            memcpy(a[i].subject, found->subject, sizeof a[i].subject);
    }
    free(list);
    return ST_OK;
}

/* ---- lists */

/* The beginning of a time: "2026-11-21", "2026-11-21T14:30". */
static bool since_valid(const char *since)
{
    static const char form[] = "dddd-dd-ddTdd:dd:dd.dddZ";
    const size_t n = strlen(since);

    if (n < 4 || n > sizeof form - 1)
        return false;
    for (size_t i = 0; i < n; i++)
        if (form[i] == 'd' ? since[i] < '0' || since[i] > '9' : since[i] != form[i])
            return false;
    return true;
}

/* What the subject was called before: the ref of each former id, and the entries between
 * which it was this subject's.  A rename is two entries, of the former id and of the new. */
#define FORMER                                                                           \
    "WITH RECURSIVE former(ref, since, until) AS ("                                      \
    "SELECT DISTINCT subject, CAST(0 AS bigint), 9223372036854775807 "                   \
    "FROM events WHERE chain = 0 AND subject = $2 "                                      \
    "UNION SELECT o.subject, "                                                           \
    "coalesce((SELECT max(d.event_key) FROM events d WHERE d.chain = 0 "                 \
    "AND d.subject = o.subject AND d.seq < o.seq "                                       \
    "AND (d.kind = 'delete_subject' OR d.outcome = 'renamed')), 0), "                    \
    "n.event_key FROM former JOIN events n ON n.chain = 0 AND n.subject = former.ref "   \
    "AND n.event_key > former.since AND n.event_key < former.until "                     \
    "AND n.kind = 'rename_subject' AND n.outcome = 'named' "                             \
    "JOIN events o ON o.chain = 0 AND o.seq = n.seq - 1 AND o.outcome = 'renamed') "

#define WANTED                                                                           \
    " FROM events e WHERE e.chain = coalesce($6, e.chain) AND e.seq > $1 "               \
    "AND (e.subject = coalesce($2, e.subject) "                                          \
    "OR EXISTS (SELECT 1 FROM former WHERE former.ref = e.subject "                      \
    "AND e.event_key > former.since AND e.event_key < former.until)) "                   \
    "AND e.kind = coalesce($3, e.kind) AND e.at >= coalesce($4, e.at) "

static enum status list(struct store_txn *t, const struct store_audit_filter *f,
                        void **out, size_t *n, struct errinfo *e)
{
    const int64_t after = f->after <= INT64_MAX ? (int64_t)f->after : INT64_MAX;
    const int64_t limit =
        f->limit != 0 && f->limit < INT64_MAX ? (int64_t)f->limit : INT64_MAX;
    unsigned char ref[ROW_CRYPT_REF];
    struct sql_value v[] = {sql_int(after),
                            sql_null(),
                            sql_text_or_null(f->kind != NULL ? f->kind : ""),
                            sql_text_or_null(f->since != NULL ? f->since : ""),
                            sql_int(limit),
                            f->chain != NULL ? sql_int(*f->chain) : sql_null()};
    struct sql_rows *r;
    enum status st;

    if (f->subject != NULL) {
        row_crypt_ref(t->vault, f->subject, ref);
        v[1] = sql_blob(ref, sizeof ref);
    }
    if (f->newest)
        st = sql_query(t->sql,
                       FORMER "SELECT * FROM (SELECT " ROW_ENTRY_COLUMNS
                              ", e.event_key" WANTED
                              "ORDER BY e.event_key DESC LIMIT $5) AS newest "
                              "ORDER BY event_key",
                       v, sizeof v / sizeof *v, &r, e);
    else
        st = sql_query(t->sql,
                       FORMER "SELECT " ROW_ENTRY_COLUMNS WANTED
                              "ORDER BY e.event_key LIMIT $5",
                       v, sizeof v / sizeof *v, &r, e);
    return store_column_list(r, st, read_entry, t, sizeof(struct store_audit_entry), out,
                             n, e);
}

enum status store_audit_list(struct store *s, const struct store_audit_filter *filter,
                             struct store_audit_entry **out, size_t *n, struct errinfo *e)
{
    struct store_txn t;
    void *entries = NULL;
    enum status st;

    *out = NULL;
    *n = 0;
    if (filter->subject != NULL &&
        (st = store_rules_subject(filter->subject, e)) != ST_OK)
        return st;
    if (filter->kind != NULL && !store_rules_printable(filter->kind, 1, STORE_NAME_MAX))
        return errinfo_set(e, ST_EINVAL, "the kind of an event is malformed");
    if (filter->since != NULL && !since_valid(filter->since))
        return errinfo_set(e, ST_EINVAL,
                           "a time is like 2026-11-21 or 2026-11-21T14:30, not %.40s",
                           filter->since);
    if ((st = store_txn_begin(s, SQL_READ, &t, e)) != ST_OK)
        return st;
    if ((st = list(&t, filter, &entries, n, e)) == ST_OK && filter->names)
        st = find_names(&t, entries, *n, e);
    if ((st = store_txn_end(&t, st, e)) != ST_OK) {
        free(entries);
        *n = 0;
        return st;
    }
    *out = entries;
    return ST_OK;
}

enum status store_audit_marks(struct store *s, struct store_audit_mark **out, size_t *n,
                              struct errinfo *e)
{
    struct sql_rows *r;
    struct store_txn t;
    void *marks = NULL;
    enum status st;

    *out = NULL;
    *n = 0;
    if ((st = store_txn_begin(s, SQL_READ, &t, e)) != ST_OK)
        return st;
    st = sql_query(t.sql,
                   "SELECT chain, seq, at, hash, signature FROM checkpoints "
                   "ORDER BY chain, seq",
                   NULL, 0, &r, e);
    st = store_column_list(r, st, list_mark, &t, sizeof **out, &marks, n, e);
    *out = marks;
    return store_txn_end(&t, st, e);
}

enum status store_audit_public(struct store *s, char public_key[65], struct errinfo *e)
{
    unsigned char public[VAULT_KEY];
    struct store_txn t;
    enum status st;

    public_key[0] = '\0';
    if ((st = store_txn_begin(s, SQL_READ, &t, e)) != ST_OK)
        return st;
    vault_public(t.vault, public);
    (void)sodium_bin2hex(public_key, 65, public, sizeof public);
    return store_txn_end(&t, ST_OK, e);
}

enum status store_audit_signer(struct store *s, const char *public_key, bool *was,
                               struct errinfo *e)
{
    struct row_event_row key = {.gone = false};
    struct store_txn t;
    enum status st;

    *was = false;
    if (sodium_hex2bin(key.mac, sizeof key.mac, public_key, strlen(public_key), NULL,
                       NULL, NULL) != 0)
        return ST_OK;
    memcpy(key.object, store_chain_key, sizeof key.object);
    st = store_txn_begin(s, SQL_READ, &t, e);
    return st == ST_OK ? store_txn_end(&t, row_event_was(&t, &key, was, e), e) : st;
}

static enum status read_erased(void *t, const struct sql_rows *r, void *out,
                               struct errinfo *e)
{
    unsigned char ref[ROW_CRYPT_REF];
    struct store_erased *one = out;
    const bool known = store_column_bytes(r, 0, ref, sizeof ref);

    (void)t;
    if (!store_column_text(r, 1, one->at, sizeof one->at))
        return errinfo_set(e, ST_ECORRUPT, "an entry of the audit log is damaged");
    (void)sodium_bin2hex(one->ref, sizeof one->ref, ref, known ? sizeof ref : 0);
    return ST_OK;
}

enum status store_audit_erased(struct store *s, const char *subject,
                               struct store_erased **out, size_t *n, struct errinfo *e)
{
    unsigned char ref[ROW_CRYPT_REF];
    struct sql_value who = sql_null();
    struct sql_rows *r;
    struct store_txn t;
    void *erased = NULL;
    enum status st;

    *out = NULL;
    *n = 0;
    if ((subject != NULL && (st = store_rules_subject(subject, e)) != ST_OK) ||
        (st = store_txn_begin(s, SQL_READ, &t, e)) != ST_OK)
        return st;
    if (subject != NULL) {
        row_crypt_ref(t.vault, subject, ref);
        who = sql_blob(ref, sizeof ref);
    }
    st = SQL_QUERY(t.sql, &r, e,
                   "SELECT subject, at FROM events WHERE chain = 0 "
                   "AND kind = 'delete_subject' AND subject = coalesce($1, subject) "
                   "ORDER BY seq",
                   who);
    st = store_column_list(r, st, read_erased, &t, sizeof **out, &erased, n, e);
    *out = erased;
    return store_txn_end(&t, st, e);
}

/* ---- writing */

enum status store_event(struct store *s, const char *kind, const char *actor,
                        const char *subject, const char *template_id, const char *outcome,
                        struct errinfo *e)
{
    struct store_act by;
    struct store_txn t;
    enum status st;

    if ((st = store_rules_event(kind, subject, template_id, outcome, e)) != ST_OK ||
        (st = store_rules_act(&by, actor, e)) != ST_OK ||
        (st = store_txn_begin(s, SQL_LAZY, &t, e)) != ST_OK)
        return st;
    return store_txn_end(
        &t, row_event_use(&t, &by, kind, subject, template_id, outcome, e), e);
}

static enum status get_mark(struct store_txn *t, uint64_t seq,
                            struct store_audit_mark *out, struct errinfo *e)
{
    struct sql_rows *r;
    bool found;
    enum status st = SQL_QUERY(t->sql, &r, e,
                               "SELECT chain, seq, at, hash, signature FROM checkpoints "
                               "WHERE chain = 0 AND seq = $1",
                               sql_int((int64_t)seq));

    if ((found = st == ST_OK && sql_next(r)))
        st = list_mark(t, r, out, e);
    st = sql_done(r, st, e);
    return st != ST_OK || found
               ? st
               : errinfo_set(e, ST_EDB, "the checkpoint was not written");
}

enum status store_audit_sign(struct store *s, const char *actor, const char *kind,
                             struct store_audit_mark *out, struct errinfo *e)
{
    unsigned char hash[STORE_CHAIN_HASH];
    struct store_act by;
    struct store_txn t;
    uint64_t seq;
    enum status st;

    memset(out, 0, sizeof *out);
    if (strcmp(kind, STORE_CHAIN_SIGN) != 0 && strcmp(kind, STORE_CHAIN_EXPORT) != 0)
        return errinfo_set(e, ST_EINVAL, "no event of this kind is signed");
    if ((st = store_rules_act(&by, actor, e)) != ST_OK ||
        (st = store_txn_begin(s, SQL_WRITE, &t, e)) != ST_OK)
        return st;
    if ((st = row_event_add(&t, &by, kind, "", "", "", e)) == ST_OK &&
        (st = row_event_end(&t, STORE_CHAIN_CHANGES, &seq, hash, e)) == ST_OK)
        st = get_mark(&t, seq, out, e);
    return store_txn_end(&t, st, e);
}
