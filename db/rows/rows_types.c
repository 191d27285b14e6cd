#include "rows_types.h"

#include <stdio.h>
#include <string.h>

static const char *const scope_name[] = {/* bit 0 first */
                                         "verify", "enroll", "identify", "read",
                                         "delete", "manage", "tokens",   "audit",
                                         "events", "score",  "detail"};

#define SCOPES (sizeof scope_name / sizeof *scope_name)

bool rows_scopes_read(const char *text, unsigned *out)
{
    *out = 0;
    for (;;) {
        const size_t n = strcspn(text, ",");
        size_t i = 0;

        while (i < SCOPES &&
               (strlen(scope_name[i]) != n || memcmp(scope_name[i], text, n) != 0))
            i++;
        if (i == SCOPES)
            return false;
        *out |= 1U << i;
        if (text[n] == '\0')
            return true;
        text += n + 1;
    }
}

void rows_scopes_write(unsigned scopes, char out[STORE_SCOPES_MAX])
{
    size_t n = 0;

    out[0] = '\0';
    for (size_t i = 0; i < SCOPES; i++)
        if (scopes & (1U << i))
            n += (size_t)snprintf(out + n, STORE_SCOPES_MAX - n, "%s%s", n > 0 ? "," : "",
                                  scope_name[i]);
}
