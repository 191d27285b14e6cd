/* row_device.h -- the rows of devices, inside a transaction. */
#ifndef DB_ROW_DEVICE_H
#define DB_ROW_DEVICE_H
#include "row_event.h"
#include "store_types.h"

struct store_act; /* store_rules.h */
struct store_txn; /* store_txn.h */

/* row_device_find(t, name, out, e): ST_ENOTFOUND, ST_ECORRUPT.
 * row_device_each(t, see, arg, e): every row as it is, not verified.
 * row_device_list(t, out, n, e): oldest first; released by free().
 * row_device_add(t, by, one, e): and the change that tells of it.  ST_EEXISTS: another has the
 * name.
 * row_device_remove(t, by, name, e): the same; a damaged one too.  ST_ENOTFOUND.
 * row_device_tell(t, by, kind, id, name, e): append to the changes what an act leaves of the row,
 * as it is now. */
enum status row_device_find(struct store_txn *t, const char *name,
                            struct store_device *out, struct errinfo *e);
enum status row_device_each(struct store_txn *t, row_event_see *see, void *arg,
                            struct errinfo *e);
enum status row_device_list(struct store_txn *t, struct store_device **out, size_t *n,
                            struct errinfo *e);
enum status row_device_add(struct store_txn *t, const struct store_act *by,
                           const struct store_device *one, struct errinfo *e);
enum status row_device_remove(struct store_txn *t, const struct store_act *by,
                              const char *name, struct errinfo *e);
enum status row_device_tell(struct store_txn *t, const struct store_act *by,
                            const char *kind, const char *id, const char *name,
                            struct errinfo *e);

#endif
