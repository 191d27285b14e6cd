#include "row_device.h"

#include <string.h>

#include "errinfo.h"
#include "row_table.h"
#include "store_column.h"
#include "store_rules.h"
#include "store_txn.h"

#define COLUMNS "id, name, public, created"

enum {
    COL_ID,
    COL_NAME,
    COL_PUBLIC,
    COL_CREATED,
    COLUMNS_N
}; /* of COLUMNS; the MAC's too */

static const struct row_table devices = {
    .label = "surface device",
    .word = "device",
    .columns = COLUMNS_N,
    .name = COL_NAME,
    .all = "SELECT " COLUMNS " FROM devices ORDER BY device_key",
    .of = "SELECT " COLUMNS " FROM devices WHERE id = $1",
};

/* ---- reading */

static enum status read_row(void *x, const struct sql_rows *r, void *out,
                            struct errinfo *e)
{
    struct store_txn *t = x;
    struct store_device *d = out;

    memset(d, 0, sizeof *d);
    if (!store_column_text(r, COL_ID, d->id, sizeof d->id) || !store_id_valid(d->id) ||
        !store_column_text(r, COL_NAME, d->name, sizeof d->name) ||
        !store_column_bytes(r, COL_PUBLIC, d->public, sizeof d->public) ||
        !store_column_text(r, COL_CREATED, d->created, sizeof d->created))
        return errinfo_set(e, ST_ECORRUPT, "device %s: its row is damaged",
                           d->name[0] != '\0' ? d->name : "?");
    return row_table_is(t, &devices, r, 0, d->name, e);
}

enum status row_device_find(struct store_txn *t, const char *name,
                            struct store_device *out, struct errinfo *e)
{
    struct sql_rows *r;
    bool found;
    enum status st = SQL_QUERY(
        t->sql, &r, e, "SELECT " COLUMNS " FROM devices WHERE name = $1", sql_text(name));

    memset(out, 0, sizeof *out);
    if ((found = st == ST_OK && sql_next(r)))
        st = read_row(t, r, out, e);
    st = sql_done(r, st, e);
    return st != ST_OK || found
               ? st
               : errinfo_set(e, ST_ENOTFOUND, "there is no device %.64s", name);
}

enum status row_device_list(struct store_txn *t, struct store_device **out, size_t *n,
                            struct errinfo *e)
{
    void *list;
    struct sql_rows *r;
    enum status st = sql_query(t->sql, devices.all, NULL, 0, &r, e);

    st = store_column_list(r, st, read_row, t, sizeof **out, &list, n, e);
    *out = list;
    return st;
}

enum status row_device_each(struct store_txn *t, row_event_see *see, void *arg,
                            struct errinfo *e)
{
    return row_table_see(t, &devices, see, arg, e);
}

/* ---- writing */

enum status row_device_tell(struct store_txn *t, const struct store_act *by,
                            const char *kind, const char *id, const char *name,
                            struct errinfo *e)
{
    return row_table_tell(t, &devices, id, by, kind, "", "", name, e);
}

/* The id of the device that has the name, whatever else its row says; "": damaged. */
static enum status find_id(struct store_txn *t, const char *name,
                           char id[STORE_ID_LEN + 1], bool *found, struct errinfo *e)
{
    struct sql_rows *r;
    enum status st = SQL_QUERY(t->sql, &r, e, "SELECT id FROM devices WHERE name = $1",
                               sql_text(name));

    id[0] = '\0';
    if ((*found = st == ST_OK && sql_next(r)) &&
        (!store_column_text(r, 0, id, STORE_ID_LEN + 1) || !store_id_valid(id)))
        id[0] = '\0';
    return sql_done(r, st, e);
}

enum status row_device_add(struct store_txn *t, const struct store_act *by,
                           const struct store_device *one, struct errinfo *e)
{
    char id[STORE_ID_LEN + 1];
    bool found;
    enum status st = find_id(t, one->name, id, &found, e);

    if (st == ST_OK && found)
        st = errinfo_set(e, ST_EEXISTS, "there is a device %s already", one->name);
    if (st == ST_OK)
        st = SQL_RUN(t->sql, e,
                     "INSERT INTO devices (id, name, public, created) "
                     "VALUES ($1, $2, $3, $4)",
                     sql_text(one->id), sql_text(one->name),
                     sql_blob(one->public, sizeof one->public), sql_text(one->created));
    return st == ST_OK ? row_device_tell(t, by, "add_device", one->id, one->name, e) : st;
}

enum status row_device_remove(struct store_txn *t, const struct store_act *by,
                              const char *name, struct errinfo *e)
{
    char id[STORE_ID_LEN + 1];
    bool found;
    enum status st = find_id(t, name, id, &found, e);

    if (st == ST_OK && !found)
        st = errinfo_set(e, ST_ENOTFOUND, "there is no device %.64s", name);
    if (st == ST_OK)
        st = SQL_RUN(t->sql, e, "DELETE FROM devices WHERE name = $1", sql_text(name));
    return st == ST_OK ? row_device_tell(t, by, "remove_device", id, name, e) : st;
}
