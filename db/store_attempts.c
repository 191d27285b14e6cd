#include "store_attempts.h"

#include "errinfo.h"
#include "row_attempts.h"
#include "row_event.h"
#include "store_rules.h"
#include "store_txn.h"

enum status store_attempts_reset(struct store *s, const char *actor, const char *subject,
                                 struct errinfo *e)
{
    struct store_attempts was;
    struct store_act by;
    struct store_txn t;
    bool future;
    enum status st;

    if ((st = store_rules_subject(subject, e)) != ST_OK ||
        (st = store_rules_act(&by, actor, e)) != ST_OK ||
        (st = store_txn_begin(s, SQL_WRITE, &t, e)) != ST_OK)
        return st;
    if ((st = row_attempts_get(&t, subject, "", by.ms, &was, &future, e)) == ST_OK &&
        (st = row_attempts_clear(&t, subject, e)) == ST_OK)
        st = row_event_add(&t, &by, "reset_attempts", subject, "", "", e);
    return store_txn_end(&t, st, e);
}

enum status store_attempts_list(struct store *s, struct store_attempts **out, size_t *n,
                                struct errinfo *e)
{
    struct store_txn t;
    int64_t now;
    enum status st;

    *out = NULL;
    *n = 0;
    if ((st = store_rules_now(&now, e)) != ST_OK ||
        (st = store_txn_begin(s, SQL_READ, &t, e)) != ST_OK)
        return st;
    return store_txn_end(&t, row_attempts_list(&t, now, out, n, e), e);
}
