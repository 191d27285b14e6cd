/* store_subject.h -- subjects. */
#ifndef DB_STORE_SUBJECT_H
#define DB_STORE_SUBJECT_H
#include "store_open.h"

/* store_subject_add(s, actor, about, e): a subject without templates: who came with which
 * consent is known before the first scan is taken.  Of *about: id, reference, purpose and
 * expires (to come), which are checked; created is set.  ST_EEXISTS. */
enum status store_subject_add(struct store *s, const char *actor,
                              struct store_subject *about, struct errinfo *e);

enum status store_subject_get(struct store *s, const char *subject,
                              struct store_subject *out, struct errinfo *e);

/* store_subject_list(s, after, limit, out, n, e): up to limit subjects in the order of
 * creation, those whose key is greater than after (0 from the start); a new array
 * released by free().
 * store_subject_due(s, out, n, e): those that have expired, also those on hold, the longest
 * ago first; a new array released by free(). */
enum status store_subject_list(struct store *s, int64_t after, size_t limit,
                               struct store_subject **out, size_t *n, struct errinfo *e);
enum status store_subject_due(struct store *s, struct store_subject **out, size_t *n,
                              struct errinfo *e);

/* store_subject_set(s, actor, subject, what, e): all of it or nothing, with an event for the
 * consent, the hold and the being disabled each.  It is the callers' to verify no subject that
 * is disabled or has expired.  ST_OK also where it is so already. */
enum status store_subject_set(struct store *s, const char *actor, const char *subject,
                              const struct store_subject_change *what, struct errinfo *e);

/* store_subject_rename(s, actor, subject, to, e): another id; all that is known of it stays.
 * ST_EEXISTS: there is one of that id, be it this one. */
enum status store_subject_rename(struct store *s, const char *actor, const char *subject,
                                 const char *to, struct errinfo *e);

#endif
