#include "place.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static size_t place_print_part(char *out, size_t room, const char *before, uint64_t seq,
                               uint32_t mark)
{
    const int n = mark != 0
                      ? snprintf(out, room, "%s%" PRIu64 ".%08" PRIx32, before, seq, mark)
                      : snprintf(out, room, "%s%" PRIu64, before, seq);

    return (size_t)n;
}

void place_print(const struct store_audit_place *p, char out[PLACE_MAX])
{
    size_t n = place_print_part(out, PLACE_MAX, "", p->changes, p->change_mark);

    for (uint32_t i = 0; i < p->daemons; i++)
        n += place_print_part(out + n, PLACE_MAX - n, "-", p->accesses[i],
                              p->access_mark[i]);
}

/* Returns the length of the part; 0: it is none.  18 digits are always below 2^63. */
static int read_part(const char *text, uint64_t least, uint64_t *seq, uint32_t *mark)
{
    int n = 0, more = 0;

    if (sscanf(text, "%18" SCNu64 "%n", seq, &n) != 1 || *seq < least)
        return 0;
    if (text[n] == '.' && sscanf(text + n, ".%8" SCNx32 "%n", mark, &more) == 1)
        n += more;
    return n;
}

bool place_read(const char *text, uint64_t least, struct store_audit_place *out)
{
    char again[PLACE_MAX];
    int n, at;

    *out = (struct store_audit_place){.daemons = 0};
    at = n = read_part(text, least, &out->changes, &out->change_mark);
    for (; n > 0 && text[at] == '-' && out->daemons < LOG_DAEMONS;
         at += n, out->daemons++)
        if ((n = read_part(text + ++at, least, &out->accesses[out->daemons],
                           &out->access_mark[out->daemons])) == 0)
            return false;
    place_print(out, again);
    return out->daemons > 0 && strcmp(again, text) == 0;
}
