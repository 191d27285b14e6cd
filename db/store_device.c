#include "store_device.h"

#include <sodium.h>
#include <stdio.h>
#include <string.h>

#include "errinfo.h"
#include "row_device.h"
#include "store_rules.h"
#include "store_txn.h"

bool store_device_valid(const char *name)
{
    return strnlen(name, STORE_DEVICE_MAX + 1) <= STORE_DEVICE_MAX &&
           store_subject_valid(name);
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
                             const unsigned char public[VAULT_KEY],
                             struct store_device *out, struct errinfo *e)
{
    struct store_act by;
    struct store_txn t;
    enum status st;

    memset(out, 0, sizeof *out);
    if ((st = need_name(name, e)) != ST_OK ||
        (st = store_rules_act(&by, actor, e)) != ST_OK)
        return st;
    if (crypto_core_ed25519_is_valid_point(public) != 1)
        return errinfo_set(e, ST_EINVAL, "it is no public key of Ed25519");
    store_rules_random(out->id, STORE_ID_LEN / 2);
    (void)snprintf(out->name, sizeof out->name, "%s", name);
    memcpy(out->public, public, sizeof out->public);
    memcpy(out->created, by.at, sizeof by.at);
    if ((st = store_txn_begin(s, SQL_WRITE, &t, e)) != ST_OK)
        return st;
    return store_txn_end(&t, row_device_add(&t, &by, out, e), e);
}

enum status store_device_list(struct store *s, struct store_device **out, size_t *n,
                              struct errinfo *e)
{
    struct store_txn t;
    enum status st;

    *out = NULL;
    *n = 0;
    if ((st = store_txn_begin(s, SQL_READ, &t, e)) != ST_OK)
        return st;
    return store_txn_end(&t, row_device_list(&t, out, n, e), e);
}

enum status store_device_remove(struct store *s, const char *actor, const char *name,
                                struct errinfo *e)
{
    struct store_act by;
    struct store_txn t;
    enum status st;

    if ((st = need_name(name, e)) != ST_OK ||
        (st = store_rules_act(&by, actor, e)) != ST_OK ||
        (st = store_txn_begin(s, SQL_WRITE, &t, e)) != ST_OK)
        return st;
    return store_txn_end(&t, row_device_remove(&t, &by, name, e), e);
}
