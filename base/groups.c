#include "groups.h"

#include <stdio.h>
#include <string.h>

#include "errinfo.h"
#include "ident.h"

bool groups_label(const char *text)
{
    return ident_consists(text, "abcdefghijklmnopqrstuvwxyz0123456789._-", 1,
                          GROUPS_LABEL);
}

const char *groups_next(const char *list, char label[GROUPS_LABEL + 1])
{
    const size_t n = strcspn(list, ",");

    if (n == 0)
        return NULL;
    (void)snprintf(label, GROUPS_LABEL + 1, "%.*s", (int)n, list);
    return list + n + (list[n] == ',');
}

static bool has(const char *list, const char *label)
{
    char one[GROUPS_LABEL + 1];

    for (const char *p = list; (p = groups_next(p, one)) != NULL;)
        if (strcmp(one, label) == 0)
            return true;
    return false;
}

enum status groups_add(char list[GROUPS_SIZE], const char *label, struct errinfo *e)
{
    char one[GROUPS_LABEL + 1], out[GROUPS_SIZE + GROUPS_LABEL + 1];
    bool placed = false;
    size_t n = 0, labels = 1;

    if (!groups_label(label))
        return errinfo_set(e, ST_EINVAL,
                           "a group is 1 to %d characters of a-z 0-9 . _ -, not '%.80s'",
                           GROUPS_LABEL, label);
    if (has(list, label))
        return ST_OK;
    for (const char *p = list; (p = groups_next(p, one)) != NULL; labels++) {
        if (!placed && strcmp(label, one) < 0) {
            n += (size_t)snprintf(out + n, sizeof out - n, "%s,", label);
            placed = true;
        }
        n += (size_t)snprintf(out + n, sizeof out - n, "%s,", one);
    }
    if (labels > GROUPS_MAX)
        return errinfo_set(e, ST_EINVAL, "more than %d groups", GROUPS_MAX);
    if (!placed)
        n += (size_t)snprintf(out + n, sizeof out - n, "%s,", label);
    out[n - 1] = '\0';
    memcpy(list, out, n);
    return ST_OK;
}

enum status groups_read(const char *text, char out[GROUPS_SIZE], struct errinfo *e)
{
    enum status st = ST_OK;

    out[0] = '\0';
    while (st == ST_OK && text[0] != '\0') {
        char label[GROUPS_LABEL + 2]; /* one byte too many makes it no label */
        const size_t n = strcspn(text, ",");

        (void)snprintf(label, sizeof label, "%.*s", (int)n, text);
        st = groups_add(out, label, e);
        text += n;
        if (st == ST_OK && text[0] == ',' && *++text == '\0')
            st = errinfo_set(e, ST_EINVAL, "a list of groups ends with a comma");
    }
    return st;
}

bool groups_valid(const char *text)
{
    char list[GROUPS_SIZE];

    return groups_read(text, list, NULL) == ST_OK && strcmp(text, list) == 0;
}

bool groups_meet(const char *bound, const char *list)
{
    char common[GROUPS_SIZE];

    groups_common(bound, list, common);
    return bound[0] == '\0' || common[0] != '\0';
}

bool groups_within(const char *bound, const char *list)
{
    char common[GROUPS_SIZE];

    groups_common(bound, list, common);
    return bound[0] == '\0' || (list[0] != '\0' && strcmp(common, list) == 0);
}

void groups_common(const char *bound, const char *list, char out[GROUPS_SIZE])
{
    char one[GROUPS_LABEL + 1];

    out[0] = '\0';
    for (const char *p = list; (p = groups_next(p, one)) != NULL;)
        if (bound[0] == '\0' || has(bound, one))
            (void)groups_add(out, one, NULL);
}

enum status groups_replace(const char *bound, const char *list, const char *with,
                           char out[GROUPS_SIZE], struct errinfo *e)
{
    enum status st = ST_OK;
    char one[GROUPS_LABEL + 1];

    (void)snprintf(out, GROUPS_SIZE, "%s", with);
    for (const char *p = list; st == ST_OK && (p = groups_next(p, one)) != NULL;)
        if (bound[0] != '\0' && !has(bound, one))
            st = groups_add(out, one, e);
    return st;
}
