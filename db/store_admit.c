#include "store_admit.h"

#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include "errinfo.h"
#include "row_attempts.h"
#include "row_calibration.h"
#include "row_subject.h"
#include "row_template.h"
#include "store_rules.h"
#include "store_txn.h"

static enum status one_template(struct store_txn *x, const char *id,
                                struct store_admission *out, struct errinfo *e)
{
    if ((out->t = malloc(sizeof *out->t)) == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    out->n = 1;
    return row_template_get(x, id, out->t, e);
}

static enum status read_calibration(struct store_txn *x, int64_t known,
                                    struct store_admission *out, struct errinfo *e)
{
    struct store_calibration k;
    struct errinfo why;
    const enum status st = row_calibration_get(x, &k, &why);

    if (st == ST_ENOTFOUND)
        return ST_OK;
    if (st != ST_OK)
        return errinfo_set(e, st, "%s", why.msg);
    out->calibration = k.version;
    if (k.version != known)
        out->k = k;
    return ST_OK;
}

static const char *token_of(const struct store_admit *what)
{
    return what->token != NULL ? what->token : "";
}

static enum status read_all(struct store_txn *x, const struct store_admit *what,
                            int64_t now_ms, struct store_admission *out, bool *future,
                            struct errinfo *e)
{
    const char *subject = what->subject;
    enum status st = ST_OK;

    if (subject == NULL) {
        if ((st = one_template(x, what->template_id, out, e)) != ST_OK)
            return st;
        subject = out->t->subject;
    }
    if ((st = row_subject_read(x, subject, &out->subject, e)) != ST_OK ||
        (st = row_attempts_get(x, subject, token_of(what), now_ms, &out->attempts, future,
                               e)) != ST_OK ||
        (st = read_calibration(x, what->calibration, out, e)) != ST_OK)
        return st;
    out->subject.expired = store_rules_past(out->subject.expires, now_ms);
    if (what->subject != NULL)
        st = row_template_list(x, out->subject.key, out->subject.templates, &out->t,
                               &out->n, e);
    if (st == ST_OK && what->listed != NULL)
        st = what->listed(what->arg, out, e);
    return st;
}

static enum status read_models(struct store_txn *x, const struct store_admit *what,
                               const struct store_admission *out, struct errinfo *e)
{
    struct store_template t;
    enum status st = ST_OK;

    for (size_t i = 0; i < out->n && st == ST_OK; i++)
        if (what->wanted != NULL && what->use != NULL &&
            what->wanted(what->arg, &out->t[i]))
            st = row_template_load(x, out->t[i].id, &t, what->use, what->arg, e);
    return st;
}

enum status store_admit(struct store *s, const struct store_admit *what,
                        struct store_admission *out, struct errinfo *e)
{
    struct errinfo why = {0};
    struct store_txn x;
    bool future = false;
    int64_t now;
    enum status st, moved;

    memset(out, 0, sizeof *out);
    if ((st = what->subject != NULL
                  ? store_rules_subject(what->subject, e)
                  : store_rules_id(what->template_id, "template", e)) != ST_OK ||
        (st = store_rules_now(&now, e)) != ST_OK ||
        (st = store_txn_begin(s, SQL_READ, &x, e)) != ST_OK)
        return st;
    if ((st = read_all(&x, what, now, out, &future, e)) == ST_OK)
        st = read_models(&x, what, out, e);
    st = store_txn_end(&x, st, e);
    if (future) { /* also where the reading was ended: a lock-out must end some day */
        if ((moved = store_txn_begin(s, SQL_LAZY, &x, &why)) == ST_OK)
            moved = store_txn_end(
                &x,
                row_attempts_not_after(&x, out->subject.id, token_of(what), now, &why),
                &why);
        if (st == ST_OK && moved != ST_OK)
            st = errinfo_set(e, moved, "%s", why.msg);
    }
    if (st != ST_OK) {
        free(out->t);
        out->t = NULL;
        out->n = 0;
    }
    return st;
}
