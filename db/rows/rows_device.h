/* rows_device.h -- the devices' rows, inside a transaction. */
#ifndef DB_ROWS_DEVICE_H
#define DB_ROWS_DEVICE_H
#include "rows_table.h"
#include "rows_types.h"

struct rows_device { /* a row as it was read and found authentic */
    struct store_device one;
    int64_t revision;
    unsigned char mac[CRYPT_HASH];
};

extern const struct rows_table rows_devices;

/* rows_device_find(t, name, out, e): ST_ENOTFOUND, ST_ECORRUPT.
 * rows_device_list(t, out, n, e): oldest first; released by free().
 * rows_device_add(t, one, e): ST_EEXISTS: another has the name.
 * rows_device_delete(t, row, e). */
enum status rows_device_find(struct log_txn *t, const char *name, struct rows_device *out,
                             struct errinfo *e);
enum status rows_device_list(struct log_txn *t, struct rows_device **out, size_t *n,
                             struct errinfo *e);
enum status rows_device_add(struct log_txn *t, const struct store_device *one,
                            struct errinfo *e);
enum status rows_device_delete(struct log_txn *t, const struct rows_device *row,
                               struct errinfo *e);

#endif
