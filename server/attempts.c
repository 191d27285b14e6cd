#include "attempts.h"

#include <pthread.h>
#include <stdlib.h>

#include "app.h"
#include "errinfo.h"
#include "errmap.h"
#include "log.h"
#include "metrics.h"
#include "request.h"
#include "options.h"
#include "store.h"

struct attempts {
    struct store *store;
    pthread_mutex_t lock; /* from reading the count to writing it */
    unsigned limit, wait_s;
};

struct attempts *attempts_new(struct store *s, unsigned limit, unsigned wait_s)
{
    struct attempts *a = calloc(1, sizeof *a);

    if (a == NULL || pthread_mutex_init(&a->lock, NULL) != 0) {
        free(a);
        return NULL;
    }
    a->store = s;
    a->limit = limit;
    a->wait_s = wait_s;
    return a;
}

void attempts_free(struct attempts *a)
{
    if (a == NULL)
        return;
    (void)pthread_mutex_destroy(&a->lock);
    free(a);
}

int64_t attempts_wait_ms(const struct attempts *a, uint32_t failures, int64_t age_ms)
{
    int64_t wait_s = a->wait_s;

    if (a->limit == 0 || failures < a->limit)
        return 0;
    for (uint32_t i = a->limit; i < failures && wait_s < OPTIONS_WAIT_MAX; i++)
        wait_s *= 2;
    if (wait_s > OPTIONS_WAIT_MAX)
        wait_s = OPTIONS_WAIT_MAX;
    return age_ms < wait_s * 1000 ? wait_s * 1000 - age_ms : 0;
}

/* *failures: the failed verifications in a row.  False: r->response is set: the subject is
 * locked out, or the count cannot be read. */
static bool look(struct attempts *a, struct request *r, const char *subject,
                 uint32_t *failures)
{
    struct store_attempts s;
    struct errinfo e = {0};
    int64_t wait_ms;

    if (store_attempts_get(a->store, subject, &s, &e) != ST_OK) {
        request_fail(r, &e);
        return false;
    }
    *failures = s.failures;
    wait_ms = attempts_wait_ms(a, s.failures, s.age_ms);
    if (wait_ms == 0)
        return true;
    request_problem(
        r, ERRMAP_ATTEMPTS,
        "the subject's last %u verifications failed: it is locked out for now",
        s.failures);
    r->response.retry_after = (unsigned)((wait_ms + 999) / 1000);
    return false;
}

bool attempts_admit(struct attempts *a, struct request *r, const char *subject)
{
    uint32_t failures;

    return a->limit == 0 || look(a, r, subject, &failures);
}

bool attempts_settle(struct attempts *a, struct request *r, const char *subject,
                     bool passed)
{
    struct errinfo e = {0};
    uint32_t failures;
    struct log_entry l;
    bool told;

    if (a->limit == 0)
        return true;
    (void)pthread_mutex_lock(&a->lock);
    told = look(a, r, subject, &failures);
    if (told && !passed && store_attempts_fail(a->store, subject, &e) != ST_OK) {
        request_fail(
            r,
            &e); /* an uncounted failure must not be reported: there would be no limit */
        told = false;
    } else if (told && passed && failures > 0 &&
               store_attempts_clear(a->store, subject, &e) != ST_OK) {
        metrics_database_error(r->app->metrics, e.code);
        log_begin(&l, "error", "attempts not cleared");
        log_text(&l, "request_id", r->id);
        log_text(&l, "fault", e.msg);
        log_end(&l);
    }
    (void)pthread_mutex_unlock(&a->lock);
    return told;
}
