/* Failed verifications of a subject, as store.h tells. */
#include <string.h>

#include "errinfo.h"
#include "store_engine.h"
#include "store_rules.h"

enum status store_attempts_get(struct store *s, const char *subject,
                               struct store_attempts *out, struct errinfo *e)
{
    int64_t now, at;
    enum status st;

    memset(out, 0, sizeof *out);
    if ((st = store_rules_subject(subject, e)) != ST_OK ||
        (st = store_rules_now(&now, e)) != ST_OK ||
        (st = s->engine->attempts_get(s, subject, &out->failures, &at, e)) != ST_OK)
        return st;
    memcpy(out->subject, subject, strlen(subject) + 1);
    if (out->failures == 0)
        return ST_OK;
    if (at > now) {
        if ((st = s->engine->attempts_since(s, subject, now, e)) != ST_OK)
            return st;
        at = now;
    }
    store_rules_time(at, out->at);
    out->age_ms = now - at;
    return ST_OK;
}

enum status store_attempts_fail(struct store *s, const char *subject, struct errinfo *e)
{
    int64_t now;
    enum status st;

    if ((st = store_rules_subject(subject, e)) != ST_OK ||
        (st = store_rules_now(&now, e)) != ST_OK)
        return st;
    return s->engine->attempts_fail(s, subject, now, e);
}

/* Most matches come when there is nothing to clear: that is seen without writing. */
enum status store_attempts_clear(struct store *s, const char *subject, struct errinfo *e)
{
    uint32_t failures;
    int64_t at;
    enum status st;

    if ((st = store_rules_subject(subject, e)) != ST_OK ||
        (st = s->engine->attempts_get(s, subject, &failures, &at, e)) != ST_OK ||
        failures == 0)
        return st;
    return s->engine->attempts_clear(s, NULL, subject, e);
}

enum status store_attempts_reset(struct store *s, const char *actor, const char *subject,
                                 struct errinfo *e)
{
    struct store_act by;
    uint32_t failures;
    int64_t at;
    enum status st;

    if ((st = store_rules_subject(subject, e)) != ST_OK ||
        (st = store_rules_act(&by, actor, e)) != ST_OK ||
        (st = s->engine->attempts_get(s, subject, &failures, &at, e)) != ST_OK)
        return st;
    return s->engine->attempts_clear(s, &by, subject, e);
}

enum status store_attempts_list(struct store *s, struct store_attempts **out, size_t *n,
                                struct errinfo *e)
{
    return s->engine->attempts_list(s, out, n, e);
}
