/* rows_device.h -- the devices' rows, inside a transaction. */
#ifndef DB_ROWS_DEVICE_H
#define DB_ROWS_DEVICE_H
#include "rows_table.h"
#include "rows_types.h"

struct rows_device { /* an authentic row */
    struct store_device one;
    int64_t revision;
    unsigned char mac[CRYPT_HASH];
};

extern const struct rows_table rows_devices;

/* rows_device_find(t, name, out, e): Reads the device with this name.  ST_ENOTFOUND, ST_ECORRUPT. */
enum status rows_device_find(struct log_txn *t, const char *name, struct rows_device *out,
                             struct errinfo *e);

/* rows_device_get(t, id, out, e): Reads the device with this id.  ST_ENOTFOUND, ST_ECORRUPT. */
enum status rows_device_get(struct log_txn *t, const char *id, struct rows_device *out,
                            struct errinfo *e);

/* rows_device_add(t, one, e): Adds a device.  ST_EEXISTS: another device has this name. */
enum status rows_device_add(struct log_txn *t, const struct store_device *one,
                            struct errinfo *e);

#endif
