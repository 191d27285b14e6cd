#include "store.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "rows_device.h"
#include "store_txn.h"

bool store_device_valid(const char *name)
{
    return strnlen(name, STORE_DEVICE_MAX + 1) <= STORE_DEVICE_MAX &&
           ident_subject_valid(name);
}

static enum status need_name(const char *name, struct errinfo *e)
{
    if (store_device_valid(name))
        return ST_OK;
    return errinfo_set(e, ST_EINVAL,
                       "a device's name is 1 to %d characters of A-Z a-z 0-9 . _ - @ :",
                       STORE_DEVICE_MAX);
}

enum status store_device_add(struct store *s, const char *actor, const char *name,
                             const unsigned char public[CRYPT_KEY],
                             struct store_device *out, struct errinfo *e)
{
    struct log_txn t;
    enum status st;

    memset(out, 0, sizeof *out);
    if ((st = need_name(name, e)) != ST_OK)
        return st;
    if (crypto_core_ed25519_is_valid_point(public) != 1)
        return errinfo_set(e, ST_EINVAL, "not a public key of Ed25519");
    if ((st = store_act_begin(s, actor, SQL_WRITE, &t, e)) != ST_OK)
        return st;
    store_rules_random(out->id, STORE_ID_LEN / 2);
    (void)snprintf(out->name, sizeof out->name, "%s", name);
    memcpy(out->public, public, sizeof out->public);
    memcpy(out->created, t.by.at, sizeof t.by.at);
    if ((st = rows_device_add(&t, out, e)) == ST_OK)
        st = log_change(&t, "add_device", NULL, out->id, name, e);
    return store_end(s, &t, st, e);
}

enum status store_device_list(struct store *s, struct store_device **out, size_t *n,
                              struct errinfo *e)
{
    void *list;
    const enum status st = store_list(s, &rows_devices, sizeof **out, &list, n, e);

    *out = list;
    return st;
}

enum status store_device_remove(struct store *s, const char *actor, const char *name,
                                struct errinfo *e)
{
    struct rows_device row;
    struct log_txn t;
    enum status st;

    if ((st = need_name(name, e)) != ST_OK ||
        (st = store_act_begin(s, actor, SQL_WRITE, &t, e)) != ST_OK)
        return st;
    if ((st = rows_device_find(&t, name, &row, e)) == ST_OK &&
        (st = rows_table_delete(&t, &rows_devices, &row, e)) == ST_OK)
        st = log_change(&t, "remove_device", NULL, row.one.id, name, e);
    return store_end(s, &t, st, e);
}
