#include "store_rules.h"

#include <sodium.h>
#include <string.h>

#include "errinfo.h"
#include "store_types.h"
#include "utc.h"

#define RANDOM_MAX 32
#define RECENT_MS  60000

bool store_rules_consist(const char *text, const char *set, size_t min, size_t max)
{
    const size_t n = strnlen(text, max + 1);

    return n >= min && n <= max && strspn(text, set) == n;
}

/* "." and ".." are none: in a path they name other resources (RFC 3986, section 5.2.4). */
bool store_subject_valid(const char *subject)
{
    return strcmp(subject, ".") != 0 && strcmp(subject, "..") != 0 &&
           store_rules_consist(
               subject,
               "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-@:", 1,
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

enum status store_rules_event(const char *kind, const char *subject,
                              const char *template_id, const char *outcome,
                              struct errinfo *e)
{
    if (store_rules_printable(kind, 1, STORE_NAME_MAX) &&
        store_rules_printable(outcome, 0, STORE_NAME_MAX) &&
        (subject[0] == '\0' || store_subject_valid(subject)) &&
        (template_id[0] == '\0' || store_id_valid(template_id)))
        return ST_OK;
    return errinfo_set(e, ST_EINVAL,
                       "the event's kind, subject, template or outcome is malformed");
}

void store_rules_raw(const char *id, unsigned char out[16])
{
    memset(out, 0, 16);
    (void)sodium_hex2bin(out, 16, id, strlen(id), NULL, NULL, NULL);
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

enum status store_rules_act(struct store_act *by, const char *actor, struct errinfo *e)
{
    enum status st;

    if (!store_rules_printable(actor, 0, STORE_NAME_MAX))
        return errinfo_set(e, ST_EINVAL, "an actor is up to %d printable characters",
                           STORE_NAME_MAX);
    by->actor = actor;
    if ((st = store_rules_now(&by->ms, e)) == ST_OK)
        utc_print(by->ms, by->at);
    return st;
}

enum status store_rules_room(const char *subject, uint32_t templates, struct errinfo *e)
{
    if (templates < STORE_TEMPLATES_MAX)
        return ST_OK;
    return errinfo_set(
        e, ST_EFULL,
        "subject %s would have more than %d templates: delete some of them "
        "first, or add fewer",
        subject, STORE_TEMPLATES_MAX);
}
