#include "store_admit.h"

#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include "rows_attempts.h"
#include "rows_calibration.h"
#include "rows_template.h"
#include "store_rules.h"
#include "store_txn.h"

struct admitting {
    struct log_txn t;
    const struct store_admit *what;
    struct store_admission *out;
    struct rows_subject of;
    struct rows_template *row; /* [out->n] */
};

/* The subject and those of its templates that are asked for. */
static enum status read_templates(struct admitting *a, struct errinfo *e)
{
    enum status st;

    if (a->what->subject != NULL) {
        if ((st = rows_subject_find(&a->t, a->what->subject, &a->of, e)) != ST_OK ||
            (st = rows_template_list(&a->t, &a->of, &a->row, &a->out->n, e)) != ST_OK)
            return st;
    } else {
        if ((a->row = malloc(sizeof *a->row)) == NULL)
            return errinfo_set(e, ST_ENOMEM, "out of memory");
        if ((st = rows_template_get(&a->t, a->what->template_id, a->row, &a->of, e)) !=
            ST_OK)
            return st;
        a->out->n = 1;
    }
    if ((a->out->t = malloc((a->out->n + 1) * sizeof *a->out->t)) == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    for (size_t i = 0; i < a->out->n; i++)
        a->out->t[i] = a->row[i].one;
    return ST_OK;
}

static enum status read_calibration(struct admitting *a, struct errinfo *e)
{
    struct store_calibration k;
    const enum status st = rows_calibration_get(&a->t, &k, e);

    if (st != ST_OK)
        return st == ST_ENOTFOUND ? ST_OK : st;
    a->out->calibration = k.version;
    if (k.version != a->what->calibration)
        a->out->k = k;
    return ST_OK;
}

static const char *token_of(const struct store_admit *what)
{
    return what->token != NULL ? what->token : "";
}

static enum status read_all(struct admitting *a, int64_t now_ms, bool *future,
                            struct errinfo *e)
{
    struct store_admission *out = a->out;
    enum status st;

    if ((st = read_templates(a, e)) != ST_OK)
        return st;
    out->subject = a->of.one;
    out->subject.expired = store_rules_past(out->subject.expires, now_ms);
    if ((st = rows_attempts_get(&a->t, &out->subject, token_of(a->what), now_ms,
                                &out->attempts, future, e)) != ST_OK ||
        (st = read_calibration(a, e)) != ST_OK)
        return st;
    return a->what->listed != NULL ? a->what->listed(a->what->arg, out, e) : ST_OK;
}

static enum status read_faces(struct admitting *a, struct errinfo *e)
{
    const struct store_admit *what = a->what;
    enum status st = ST_OK;

    for (size_t i = 0; i < a->out->n && st == ST_OK; i++) {
        unsigned char *face = NULL;
        size_t len = 0;

        if (what->wanted == NULL || what->use == NULL ||
            !what->wanted(what->arg, &a->out->t[i]))
            continue;
        st = rows_template_face(&a->t, &a->row[i], &a->of, &face, &len, e);
        if (st == ST_OK)
            st = what->use(what->arg, &a->out->t[i], face, len, e);
        rows_template_wipe(face, len);
    }
    return st;
}

/* Also where the reading was ended: a lock-out must end some day. */
static enum status move_future(struct store *s, const struct admitting *a, int64_t now,
                               struct errinfo *e)
{
    struct log_txn t;
    const enum status st = store_begin(s, SQL_LAZY, &t, e);

    if (st != ST_OK)
        return st;
    return store_end(
        s, &t, rows_attempts_not_after(&t, &a->out->subject, token_of(a->what), now, e),
        e);
}

enum status store_admit(struct store *s, const struct store_admit *what,
                        struct store_admission *out, struct errinfo *e)
{
    struct admitting a = {.what = what, .out = out};
    struct errinfo why = {0};
    bool future = false;
    int64_t now;
    enum status st, moved;

    memset(out, 0, sizeof *out);
    if ((st = what->subject != NULL
                  ? ident_subject(what->subject, e)
                  : ident_id(what->template_id, "template", e)) != ST_OK ||
        (st = store_rules_now(&now, e)) != ST_OK ||
        (st = store_begin(s, SQL_READ, &a.t, e)) != ST_OK)
        return st;
    if ((st = read_all(&a, now, &future, e)) == ST_OK)
        st = read_faces(&a, e);
    st = store_end(s, &a.t, st, e);
    if (future && (moved = move_future(s, &a, now, &why)) != ST_OK && st == ST_OK)
        st = errinfo_set(e, moved, "%s", why.msg);
    free(a.row);
    sodium_memzero(&a.of, sizeof a.of);
    if (st != ST_OK) {
        free(out->t);
        out->t = NULL;
        out->n = 0;
    }
    return st;
}
