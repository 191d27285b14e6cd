#include "row_cloud.h"

#include "errinfo.h"
#include "row_subject.h"
#include "store_column.h"
#include "store_txn.h"

/* NULL where it names no request, or is not to be kept. */
static struct sql_value retry_of(const struct store_txn *t,
                                 const struct store_subject *who,
                                 const struct store_probe *probe,
                                 unsigned char hash[VAULT_HASH])
{
    if (probe->retry[0] == '\0' || probe->keep_ms == 0)
        return sql_null();
    row_crypt_retry(t->vault, who->uid, probe->retry, hash);
    return sql_blob(hash, VAULT_HASH);
}

enum status row_cloud_known(struct store_txn *t, const struct store_subject *who,
                            const struct store_probe *probe, int64_t now, bool *known,
                            struct errinfo *e)
{
    unsigned char lookup[VAULT_HASH], read[VAULT_HASH], used[VAULT_HASH] = {0};
    unsigned char retry[VAULT_HASH];
    struct sql_rows *r;
    enum status st;

    if (probe->used[0] != '\0')
        row_crypt_same(t->vault, who->uid, probe->used, used);
    row_crypt_cloud(t->vault, who->uid, probe->read, read);
    st = SQL_QUERY(
        t->sql, &r, e,
        "SELECT 1 FROM subjects s WHERE s.lookup = $1 AND (EXISTS (SELECT 1 FROM "
        "templates t WHERE t.subject_key = s.subject_key AND t.same = $2) OR EXISTS "
        "(SELECT 1 FROM clouds c WHERE c.subject_key = s.subject_key AND c.digest = $3 "
        "AND (c.until_ms IS NULL OR (c.until_ms > $4 AND coalesce(c.retry <> $5, TRUE)))))",
        row_subject_lookup(t, who->id, lookup), sql_blob(used, sizeof used),
        sql_blob(read, sizeof read), sql_int(now), retry_of(t, who, probe, retry));
    *known = st == ST_OK && sql_next(r);
    return sql_done(r, st, e);
}

#define OF "(SELECT subject_key FROM subjects WHERE lookup = $1)"

enum status row_cloud_keep(struct store_txn *t, const struct store_subject *who,
                           const struct store_probe *probe, int64_t now, bool *known,
                           struct errinfo *e)
{
    unsigned char lookup[VAULT_HASH], read[VAULT_HASH], retry[VAULT_HASH];
    enum status st;

    row_crypt_cloud(t->vault, who->uid, probe->read, read);
    st = SQL_RUN(t->sql, e,
                 "INSERT INTO clouds (subject_key, digest, until_ms, retry) VALUES (" OF
                 ", $2, $3, $5) ON CONFLICT (subject_key, digest) DO UPDATE SET "
                 "until_ms = excluded.until_ms, retry = CASE WHEN clouds.until_ms <= $4 "
                 "THEN excluded.retry END WHERE clouds.until_ms <= $4 OR clouds.retry = "
                 "excluded.retry",
                 row_subject_lookup(t, who->id, lookup), sql_blob(read, sizeof read),
                 sql_int(now + probe->keep_ms), sql_int(now),
                 retry_of(t, who, probe, retry));
    if (st != ST_OK)
        return st;
    *known = sql_changed(t->sql) == 0;
    if ((st = SQL_RUN(t->sql, e, "DELETE FROM clouds WHERE until_ms <= $1",
                      sql_int(now))) != ST_OK)
        return st;
    return SQL_RUN(t->sql, e,
                   "DELETE FROM clouds WHERE subject_key = " OF " AND until_ms < "
                   "(SELECT until_ms FROM clouds WHERE subject_key = " OF
                   " AND until_ms IS NOT NULL ORDER BY until_ms DESC LIMIT 1 OFFSET $2)",
                   row_subject_lookup(t, who->id, lookup), sql_int(STORE_PROBES - 1));
}

enum status row_cloud_template(struct store_txn *t, const struct row_subject *p,
                               const char *digest, char id[STORE_ID_LEN + 1],
                               struct errinfo *e)
{
    unsigned char read[VAULT_HASH];
    struct sql_rows *r;
    enum status st;

    id[0] = '\0';
    row_crypt_cloud(t->vault, p->key.uid, digest, read);
    st = SQL_QUERY(t->sql, &r, e,
                   "SELECT t.id FROM clouds c JOIN templates t USING (template_key) "
                   "WHERE c.subject_key = $1 AND c.digest = $2 AND t.subject_key = $1",
                   sql_int(p->row), sql_blob(read, sizeof read));
    if (st == ST_OK && sql_next(r) && !store_column_text(r, 0, id, STORE_ID_LEN + 1))
        st = errinfo_set(e, ST_ECORRUPT, "a template's id is damaged");
    return sql_done(r, st, e);
}

enum status row_cloud_enroll(struct store_txn *t, const struct row_subject *p,
                             const char *id, const char *digest, struct errinfo *e)
{
    unsigned char read[VAULT_HASH];

    row_crypt_cloud(t->vault, p->key.uid, digest, read);
    return SQL_RUN(
        t->sql, e,
        "INSERT INTO clouds (subject_key, digest, template_key) VALUES ($1, $2, "
        "(SELECT template_key FROM templates WHERE id = $3)) "
        "ON CONFLICT (subject_key, digest) DO UPDATE SET "
        "template_key = excluded.template_key, until_ms = NULL",
        sql_int(p->row), sql_blob(read, sizeof read), sql_text(id));
}
