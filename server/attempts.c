#include "attempts.h"

#include <stdlib.h>

#include "app.h"
#include "errmap.h"
#include "lockout.h"
#include "logger.h"
#include "metrics.h"
#include "options.h"
#include "request.h"
#include "store.h"

#define WARN_SUBJECTS 3 /* at this part of those that a token may try */

struct attempts {
    unsigned limit, wait_s, subjects;
};

struct attempts *attempts_new(unsigned limit, unsigned wait_s, unsigned subjects)
{
    struct attempts *a = malloc(sizeof *a);

    if (a != NULL)
        *a = (struct attempts){limit, wait_s, subjects};
    return a;
}

void attempts_free(struct attempts *a)
{
    free(a);
}

bool attempts_limited(const struct attempts *a)
{
    return a->limit != 0;
}

/* What is left of a lock-out of at most most_s after so many failures. */
static int64_t left_ms(const struct attempts *a, uint32_t failures, int64_t age_ms,
                       unsigned most_s)
{
    const int64_t wait_ms = lockout_ms(a->limit, a->wait_s, most_s, failures);

    return age_ms < wait_ms ? wait_ms - age_ms : 0;
}

int64_t attempts_wait_ms(const struct attempts *a, const struct store_attempts *now,
                         enum attempts_reason *why)
{
    int64_t wait[] = {[ATTEMPTS_MAY] = 0,
                      [ATTEMPTS_OWN] = 0,
                      [ATTEMPTS_OTHERS] = 0,
                      [ATTEMPTS_SUBJECTS] = 0};

    *why = ATTEMPTS_MAY;
    if (a->limit == 0)
        return 0;
    wait[ATTEMPTS_OWN] = left_ms(a, now->failures, now->age_ms, OPTIONS_WAIT_MAX);
    wait[ATTEMPTS_OTHERS] =
        left_ms(a, now->others, now->others_age_ms, ATTEMPTS_OTHERS_S);
    if (a->subjects > 0 && now->token[0] != '\0' && now->tried >= a->subjects &&
        now->tried_age_ms < STORE_TRIED_MS)
        wait[ATTEMPTS_SUBJECTS] = STORE_TRIED_MS - now->tried_age_ms;
    for (enum attempts_reason i = ATTEMPTS_OWN; i <= ATTEMPTS_SUBJECTS; i++)
        if (wait[i] > wait[*why])
            *why = i;
    return wait[*why];
}

static void refuse(struct request *r, enum attempts_reason why,
                   const struct store_attempts *now)
{
    if (why == ATTEMPTS_OWN)
        request_problem(
            r, ERRMAP_ATTEMPTS,
            "the subject's last %u verifications failed: it is locked out for now",
            now->failures);
    else if (why == ATTEMPTS_OTHERS)
        request_problem(r, ERRMAP_ATTEMPTS,
                        "the subject's last %u verifications by others failed: it is "
                        "locked out for a minute at most",
                        now->others);
    else
        request_problem(r, ERRMAP_SUBJECTS,
                        "this token has tried %u other subjects without a match within "
                        "an hour",
                        now->tried);
}

bool attempts_admit(const struct attempts *a, struct request *r,
                    const struct store_attempts *now)
{
    enum attempts_reason why;
    const int64_t wait_ms = attempts_wait_ms(a, now, &why);

    if (wait_ms == 0)
        return true;
    refuse(r, why, now);
    r->response.retry_after = (unsigned)((wait_ms + 999) / 1000);
    metrics_attempts(r->app->metrics, (enum metrics_failed)(why - ATTEMPTS_OWN));
    return false;
}

void attempts_watch(const struct attempts *a, struct store_settle *what)
{
    what->warn_failures = a->limit;
    if (what->actor[0] != '\0' && a->limit > 0)
        what->warn_tried = (a->subjects + WARN_SUBJECTS - 1) / WARN_SUBJECTS;
}

static void warn(const struct request *r, const char *what)
{
    struct logger_line l;

    logger_begin(&l, "warn", what);
    logger_text(&l, "request_id", r->id);
    logger_text(&l, "token", r->actor);
    logger_end(&l);
}

void attempts_warn(const struct request *r, const struct store_settled *out)
{
    if (out->locked_out) {
        metrics_warning(r->app->metrics, METRICS_LOCKED_OUT);
        warn(r, "a subject is locked out: verifications failed");
    }
    if (out->many_subjects) {
        metrics_warning(r->app->metrics, METRICS_MANY_SUBJECTS);
        warn(r, "a token has tried many subjects without a match");
    }
}
