#include "store_attempts.h"

#include <sodium.h>

#include "rows_attempts.h"
#include "rows_subject.h"
#include "store_rules.h"
#include "store_txn.h"

static enum status reset(struct log_txn *t, const struct log_act *by, const char *subject,
                         struct errinfo *e)
{
    struct rows_subject of;
    enum status st = rows_subject_find(t, subject, &of, e);

    sodium_memzero(of.key, sizeof of.key);
    if (st != ST_OK || (st = rows_attempts_clear(t, &of.one, e)) != ST_OK)
        return st;
    return log_change(t, by, "reset_attempts", of.one.uid, "", "", e);
}

enum status store_attempts_reset(struct store *s, const char *actor, const char *subject,
                                 struct errinfo *e)
{
    struct log_act by;
    struct log_txn t;
    enum status st;

    if ((st = ident_subject(subject, e)) != ST_OK ||
        (st = store_act_begin(s, actor, SQL_WRITE, &by, &t, e)) != ST_OK)
        return st;
    return store_end(s, &t, reset(&t, &by, subject, e), e);
}

enum status store_attempts_list(struct store *s, struct store_attempts **out, size_t *n,
                                struct errinfo *e)
{
    struct log_txn t;
    int64_t now;
    enum status st;

    *out = NULL;
    *n = 0;
    if ((st = store_rules_now(&now, e)) != ST_OK ||
        (st = store_begin(s, SQL_READ, &t, e)) != ST_OK)
        return st;
    return store_end(s, &t, rows_attempts_list(&t, now, out, n, e), e);
}
