/* The audit log, as store.h tells. */
#include <string.h>

#include "errinfo.h"
#include "store_chain.h"
#include "store_engine.h"
#include "store_rules.h"

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

enum status store_audit_list(struct store *s, const struct store_audit_filter *filter,
                             struct store_audit_entry **out, size_t *n, struct errinfo *e)
{
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
    return s->engine->audit_list(s, filter, out, n, e);
}

enum status store_audit_sign(struct store *s, const char *actor, const char *kind,
                             struct store_audit_mark *out, struct errinfo *e)
{
    struct store_act by;
    enum status st;

    memset(out, 0, sizeof *out);
    if (strcmp(kind, STORE_CHAIN_SIGN) != 0 && strcmp(kind, STORE_CHAIN_EXPORT) != 0)
        return errinfo_set(e, ST_EINVAL, "no event of this kind is signed");
    if ((st = store_rules_act(&by, actor, e)) != ST_OK)
        return st;
    return s->engine->audit_sign(s, &by, kind, out, e);
}

enum status store_audit_marks(struct store *s, struct store_audit_mark **out, size_t *n,
                              struct errinfo *e)
{
    *out = NULL;
    *n = 0;
    return s->engine->audit_marks(s, out, n, e);
}

enum status store_audit_public(struct store *s, char public_key[65], struct errinfo *e)
{
    public_key[0] = '\0';
    return s->engine->audit_public(s, public_key, e);
}

enum status store_audit_verify(struct store *s,
                               void (*report)(void *arg, uint64_t seq, const char *line),
                               void *arg, struct store_audit *out, struct errinfo *e)
{
    memset(out, 0, sizeof *out);
    return s->engine->audit_verify(s, report, arg, out, e);
}

enum status store_audit_erased(struct store *s, const char *subject,
                               struct store_erased **out, size_t *n, struct errinfo *e)
{
    enum status st;

    *out = NULL;
    *n = 0;
    if (subject != NULL && (st = store_rules_subject(subject, e)) != ST_OK)
        return st;
    return s->engine->audit_erased(s, subject, out, n, e);
}
