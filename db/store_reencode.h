/* store_reencode.h -- outdated templates (store_template_outdated()), stored as this engine
 * makes them. */
#ifndef DB_STORE_REENCODE_H
#define DB_STORE_REENCODE_H
#include "store_open.h"

/* store_reencode(s, actor, id, w, f, t, done, e): an outdated template is stored as this engine
 * makes it, under the same id, label, time and digest; a change with it.  *f: memory to use;
 * *t: as it is now.  *done is false where it was not outdated, or not any more.  Others can
 * use it all the time.
 * ST_EVERSION, as store_template_load(): it stays as it is. */
enum status store_reencode(struct store *s, const char *actor, const char *id,
                           struct face_work *w, struct face *f, struct store_template *t,
                           bool *done, struct errinfo *e);

/* store_reencode_due(s, out, n, e): the ids of all outdated templates, oldest first; a new
 * array released by free().
 * store_reencode_count(s, n, e): how many there are.  Both read an index alone. */
enum status store_reencode_due(struct store *s, char (**out)[STORE_ID_LEN + 1], size_t *n,
                               struct errinfo *e);
enum status store_reencode_count(struct store *s, uint64_t *n, struct errinfo *e);

#endif
