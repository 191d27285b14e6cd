#include "row_cloud.h"

#include "errinfo.h"
#include "row_subject.h"
#include "store_column.h"
#include "store_txn.h"

enum status row_cloud_known(struct store_txn *t, const struct store_subject *who,
                            const struct store_probe *probe, bool *known,
                            struct errinfo *e)
{
    unsigned char lookup[VAULT_HASH], read[VAULT_HASH], used[VAULT_HASH] = {0};
    struct sql_rows *r;
    enum status st;

    if (probe->used[0] != '\0')
        row_crypt_same(t->vault, who->uid, probe->used, used);
    row_crypt_cloud(t->vault, who->uid, probe->read, read);
    st = SQL_QUERY(
        t->sql, &r, e,
        "SELECT 1 FROM subjects s WHERE s.lookup = $1 AND (EXISTS (SELECT 1 FROM "
        "templates t WHERE t.subject_key = s.subject_key AND t.same = $2) OR EXISTS "
        "(SELECT 1 FROM clouds c WHERE c.subject_key = s.subject_key AND c.digest = $3))",
        row_subject_lookup(t, who->id, lookup), sql_blob(used, sizeof used),
        sql_blob(read, sizeof read));
    *known = st == ST_OK && sql_next(r);
    return sql_done(r, st, e);
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
        "template_key = excluded.template_key",
        sql_int(p->row), sql_blob(read, sizeof read), sql_text(id));
}
