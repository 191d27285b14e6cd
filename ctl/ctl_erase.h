/* ctl_erase.h -- what --dry-run tells of a deletion. */
#ifndef CTL_ERASE_H
#define CTL_ERASE_H
#include <stdint.h>
#include "status.h"

struct ctl;           /* ctl.h */
struct store_subject; /* store.h */

/* ctl_erase_would(c, one, templates, what): so many templates of the subject would go, or
 * may not, which is a failure.  what: "deletes ...". */
enum status ctl_erase_would(struct ctl *c, const struct store_subject *one,
                            uint32_t templates, const char *what);

#endif
