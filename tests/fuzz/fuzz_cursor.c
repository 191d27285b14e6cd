/* Cursors of the audit log and of the events.  There is one text of a place: whatever is read prints as it was, and
 * reads as the same place again. */
#include "fuzz.h"

#include <string.h>

#include "place.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct store_audit_place p, q;
    char text[2 * PLACE_MAX], again[PLACE_MAX];

    if (size >= sizeof text)
        return 0;
    memcpy(text, data, size);
    text[size] = '\0';
    for (uint64_t least = 0; least < 2; least++) {
        if (!place_read(text, least, &p))
            continue;
        require(p.daemons > 0 && p.daemons <= LOG_DAEMONS && p.changes >= least);
        for (uint32_t i = 0; i < p.daemons; i++)
            require(p.accesses[i] >= least);
        place_print(&p, again);
        require(strcmp(again, text) == 0);
        require(place_read(again, least, &q) && memcmp(&p, &q, sizeof p) == 0);
    }
    return 0;
}
