#include "admit.h"

#include "errinfo.h"
#include "store.h"

enum admit admit_subject(const struct store_subject *one, struct errinfo *e)
{
    if (one->disabled) {
        (void)errinfo_set(e, ST_EDENIED, "subject %s is disabled: enable it first",
                          one->id);
        return ADMIT_DISABLED;
    }
    if (one->expired) {
        (void)errinfo_set(e, ST_EDENIED,
                          "subject %s expired at %s: set a later expiry first", one->id,
                          one->expires);
        return ADMIT_EXPIRED;
    }
    return ADMIT_YES;
}
