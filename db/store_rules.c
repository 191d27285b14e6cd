#include "store_rules.h"

#include <sodium.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "errinfo.h"
#include "store_engine.h"

#define RANDOM_MAX 32
#define LAST_MS    INT64_C(253402300799999) /* of the year 9999 */

bool store_rules_consist(const char *text, const char *set, size_t min, size_t max)
{
    const size_t n = strnlen(text, max + 1);

    return n >= min && n <= max && strspn(text, set) == n;
}

bool store_subject_valid(const char *subject)
{
    return store_rules_consist(
        subject, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-@:", 1,
        STORE_SUBJECT_MAX);
}

bool store_id_valid(const char *id)
{
    return store_rules_consist(id, "0123456789abcdef", STORE_ID_LEN, STORE_ID_LEN);
}

bool store_rules_printable(const char *text, size_t min, size_t max)
{
    const size_t n = strnlen(text, max + 1);

    for (size_t i = 0; i < n; i++)
        if (text[i] < ' ' || text[i] > '~')
            return false;
    return n >= min && n <= max;
}

enum status store_rules_subject(const char *subject, struct errinfo *e)
{
    if (store_subject_valid(subject))
        return ST_OK;
    return errinfo_set(
        e, ST_EINVAL,
        "a subject id is 1 to %d characters of A-Z a-z 0-9 . _ - @ :", STORE_SUBJECT_MAX);
}

enum status store_rules_id(const char *id, const char *what, struct errinfo *e)
{
    if (store_id_valid(id))
        return ST_OK;
    return errinfo_set(e, ST_EINVAL, "a %s id is %d characters of 0-9 a-f", what,
                       STORE_ID_LEN);
}

void store_rules_random(char *out, size_t bytes)
{
    unsigned char raw[RANDOM_MAX];

    randombytes_buf(raw, bytes);
    (void)sodium_bin2hex(out, 2 * bytes + 1, raw, bytes);
    sodium_memzero(raw, sizeof raw);
}

enum status store_rules_now(int64_t *ms, struct errinfo *e)
{
    struct timespec now;

    *ms = 0;
    if (clock_gettime(CLOCK_REALTIME, &now) != 0 || now.tv_sec < 0 ||
        now.tv_sec > LAST_MS / 1000)
        return errinfo_set(e, ST_EINTERNAL, "the system's clock cannot be read");
    *ms = (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
    return ST_OK;
}

void store_rules_time(int64_t ms, char out[STORE_RULES_TIME])
{
    struct tm tm = {0};
    time_t s;

    if (ms > LAST_MS)
        ms = LAST_MS;
    s = (time_t)(ms / 1000);
    (void)gmtime_r(&s, &tm);
    (void)snprintf(out, STORE_RULES_TIME, "%04u-%02u-%02uT%02u:%02u:%02u.%03uZ",
                   (unsigned)(tm.tm_year + 1900) % 10000, (unsigned)(tm.tm_mon + 1) % 100,
                   (unsigned)tm.tm_mday % 100, (unsigned)tm.tm_hour % 100,
                   (unsigned)tm.tm_min % 100, (unsigned)tm.tm_sec % 100,
                   (unsigned)(ms % 1000));
}

enum status store_rules_act(struct store_act *by, const char *actor, struct errinfo *e)
{
    enum status st;

    if (!store_rules_printable(actor, 0, STORE_NAME_MAX))
        return errinfo_set(e, ST_EINVAL, "an actor is up to %d printable characters",
                           STORE_NAME_MAX);
    by->actor = actor;
    if ((st = store_rules_now(&by->ms, e)) == ST_OK)
        store_rules_time(by->ms, by->at);
    return st;
}
