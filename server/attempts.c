#include "attempts.h"

#include <stdlib.h>

#include "errmap.h"
#include "options.h"
#include "request.h"
#include "store.h"

struct attempts {
    unsigned limit, wait_s;
};

struct attempts *attempts_new(unsigned limit, unsigned wait_s)
{
    struct attempts *a = malloc(sizeof *a);

    if (a != NULL)
        *a = (struct attempts){limit, wait_s};
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

bool attempts_admit(const struct attempts *a, struct request *r,
                    const struct store_attempts *now)
{
    const int64_t wait_ms = attempts_wait_ms(a, now->failures, now->age_ms);

    if (wait_ms == 0)
        return true;
    request_problem(
        r, ERRMAP_ATTEMPTS,
        "the subject's last %u verifications failed: it is locked out for now",
        now->failures);
    r->response.retry_after = (unsigned)((wait_ms + 999) / 1000);
    return false;
}
