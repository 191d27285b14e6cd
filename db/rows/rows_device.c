#include "rows_device.h"

#include <string.h>

#include "errinfo.h"
#include "ident.h"
#include "sql_read.h"

#define COLUMNS "id, revision, name, public, created, mac"

enum { /* of COLUMNS */
       COL_ID,
       COL_REVISION,
       COL_NAME,
       COL_PUBLIC,
       COL_CREATED,
       COL_MAC
};

const struct rows_table rows_devices = {
    .name = "devices",
    .all = "SELECT " COLUMNS ", device_key FROM devices ORDER BY device_key",
    .remove = {"DELETE FROM devices WHERE device_key = $1"},
    .columns = COL_MAC,
    .id = COL_NAME,
};

static enum status read_row(void *t, const struct sql_rows *r, void *out,
                            struct errinfo *e)
{
    struct rows_device *row = out;
    struct store_device *d = &row->one;
    char name[STORE_DEVICE_MAX + 1];

    memset(row, 0, sizeof *row);
    if (rows_table_is(t, &rows_devices, r, 0, row->mac) &&
        sql_read_text(r, COL_ID, d->id, sizeof d->id) && ident_id_valid(d->id) &&
        sql_read_text(r, COL_NAME, d->name, sizeof d->name) &&
        sql_read_bytes(r, COL_PUBLIC, d->public, sizeof d->public) &&
        sql_read_text(r, COL_CREATED, d->created, sizeof d->created))
        return ST_OK;
    return errinfo_set(e, ST_ECORRUPT, "device %s: its row is not authentic",
                       sql_read_text(r, COL_NAME, name, sizeof name) ? name : "?");
}

static enum status find(struct log_txn *t, const char *name, struct rows_device *out,
                        bool *found, struct errinfo *e)
{
    struct sql_rows *r;
    enum status st = SQL_QUERY(
        t->sql, &r, e, "SELECT " COLUMNS " FROM devices WHERE name = $1", sql_text(name));

    memset(out, 0, sizeof *out);
    if ((*found = st == ST_OK && sql_next(r)) && (st = read_row(t, r, out, e)) == ST_OK &&
        strcmp(out->one.name, name) != 0)
        st = errinfo_set(e, ST_ECORRUPT, "an index of the devices leads to another one");
    return sql_done(r, st, e);
}

enum status rows_device_find(struct log_txn *t, const char *name, struct rows_device *out,
                             struct errinfo *e)
{
    bool found;
    const enum status st = find(t, name, out, &found, e);

    return st != ST_OK || found
               ? st
               : errinfo_set(e, ST_ENOTFOUND, "there is no device %.64s", name);
}

enum status rows_device_list(struct log_txn *t, struct rows_device **out, size_t *n,
                             struct errinfo *e)
{
    void *list = NULL;
    struct sql_rows *r;
    enum status st = sql_query(t->sql, rows_devices.all, NULL, 0, &r, e);

    st = sql_read_list(r, st, read_row, t, sizeof **out, &list, n, e);
    *out = list;
    return st;
}

enum status rows_device_add(struct log_txn *t, const struct store_device *one,
                            struct errinfo *e)
{
    struct sql_value v[COL_MAC + 1] = {
        [COL_ID] = sql_text(one->id),
        [COL_REVISION] = sql_int(1),
        [COL_NAME] = sql_text(one->name),
        [COL_PUBLIC] = sql_blob(one->public, sizeof one->public),
        [COL_CREATED] = sql_text(one->created),
    };
    struct rows_device other;
    unsigned char mac[CRYPT_HASH];
    bool found;
    enum status st = find(t, one->name, &other, &found, e);

    if (st != ST_OK)
        return st;
    if (found)
        return errinfo_set(e, ST_EEXISTS, "there is a device %s already", one->name);
    return rows_table_insert(
        t, &rows_devices,
        "INSERT INTO devices (" COLUMNS ") VALUES ($1, $2, $3, $4, $5, $6)", v, mac, e);
}

enum status rows_device_delete(struct log_txn *t, const struct rows_device *row,
                               struct errinfo *e)
{
    return rows_table_delete(t, "DELETE FROM devices WHERE id = $1 AND mac = $2",
                             sql_text(row->one.id), row->mac, e);
}
