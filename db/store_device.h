/* store_device.h -- devices: scanners that sign what they capture (store_capture.h), each by its
 * name and public key. */
#ifndef DB_STORE_DEVICE_H
#define DB_STORE_DEVICE_H
#include "store_open.h"

/* store_device_add(s, actor, name, public, out, e): name: 1 to STORE_DEVICE_MAX characters as in
 * a subject's id; public: Ed25519.  ST_EEXISTS: the name is another's; ST_EINVAL.
 * store_device_list(s, out, n, e): oldest first; released by free().
 * store_device_remove(s, actor, name, e): its captures are not taken any more, by any process,
 * and the name may be another's.  ST_ENOTFOUND. */
enum status store_device_add(struct store *s, const char *actor, const char *name,
                             const unsigned char public[CRYPT_KEY],
                             struct store_device *out, struct errinfo *e);
enum status store_device_list(struct store *s, struct store_device **out, size_t *n,
                              struct errinfo *e);
enum status store_device_remove(struct store *s, const char *actor, const char *name,
                                struct errinfo *e);

/* Can it be the name of a device? */
bool store_device_valid(const char *name);

#endif
