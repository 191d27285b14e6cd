/* event.h -- which entries of the audit log are events for doors, monitoring and directories, and how they are told:
 * without scores and without the text behind the outcome's first word. */
#ifndef SERVICE_EVENT_H
#define SERVICE_EVENT_H
#include "store.h"

/* event_type(entry): Returns the type of the event; NULL: the entry is none. */
const char *event_type(const struct log_entry *entry);

/* event_text(a): Returns the event of a as a JSON object without its cursor, to be released by free(); NULL: a is no
 * event, or out of memory. */
char *event_text(const struct store_audit_entry *a);

/* event_gap(at): Returns, like event_text(), the event that entries before this place in the log were cut off.
 *   at  time of the entry that follows */
char *event_gap(const char *at);

/* event_visible(a, token, groups): Returns true if a token that is bound to groups ("": not bound) may see the event: it
 * is of a subject of the groups or, without a subject that exists, the token's own. */
bool event_visible(const struct store_audit_entry *a, const char *token,
                   const char *groups);

#endif
