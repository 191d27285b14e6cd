#include "store_rules.h"

#include <sodium.h>

#include "errinfo.h"
#include "rows_types.h"
#include "utc.h"

#define RANDOM_MAX 32
#define RECENT_MS  60000

void store_rules_random(char *out, size_t bytes)
{
    unsigned char raw[RANDOM_MAX];

    randombytes_buf(raw, bytes);
    (void)sodium_bin2hex(out, 2 * bytes + 1, raw, bytes);
    sodium_memzero(raw, sizeof raw);
}

enum status store_rules_now(int64_t *ms, struct errinfo *e)
{
    if (!utc_now(ms))
        return errinfo_set(e, ST_EINTERNAL, "the system's clock cannot be read");
    return ST_OK;
}

bool store_rules_past(const char *at, int64_t ms)
{
    int64_t then;

    return at[0] != '\0' && (!utc_read(at, &then) || then <= ms);
}

bool store_rules_recent(const char *at, int64_t ms)
{
    int64_t then;

    return utc_read(at, &then) && then <= ms && ms - then < RECENT_MS;
}

enum status store_rules_room(const char *subject, size_t templates, struct errinfo *e)
{
    if (templates < STORE_TEMPLATES_MAX)
        return ST_OK;
    return errinfo_set(
        e, ST_EFULL,
        "subject %s would have more than %d templates: delete some of them "
        "first, or add fewer",
        subject, STORE_TEMPLATES_MAX);
}
