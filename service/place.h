/* place.h -- positions in the audit log as text, for clients: the cursors of the audit log's pages and of the
 * events.  "12.9f86d081-105.884c7d65": the number of the last change and, after each hyphen, that of a daemon's last
 * access; after the point the mark of that entry (store_audit_mark()), if it is known. */
#ifndef SERVICE_PLACE_H
#define SERVICE_PLACE_H
#include "store.h"

#define PLACE_MAX ((1 + LOG_DAEMONS) * 30) /* bytes of a text */

/* place_print(p, out): Writes p. */
void place_print(const struct store_audit_place *p, char out[PLACE_MAX]);

/* place_read(text, least, out): Reads what place_print() wrote.  Returns false for any other text.
 *   least  least value of each number */
bool place_read(const char *text, uint64_t least, struct store_audit_place *out);

#endif
