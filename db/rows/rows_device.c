#include "rows_device.h"

#include "errinfo.h"
#include "ident.h"

#define COLUMNS         "id, revision, name, public, created, mac, device_key"
#define F(kind, member) SQL_FIELD(kind, struct rows_device, member)

enum { COL_ID, COL_NAME = 2, COL_MAC = 5 };

static const struct sql_field columns[COL_MAC] = {
    F(TEXT, one.id),      F(NUMBER, revision),  F(TEXT, one.name),
    F(BYTES, one.public), F(TEXT, one.created),
};

static bool rows_device_complete(const struct log_txn *t, const struct sql_rows *r,
                                 int col, void *row)
{
    (void)t, (void)r, (void)col;
    return ident_id_valid(((struct rows_device *)row)->one.id);
}

const struct rows_table rows_devices = {
    .name = "devices",
    .noun = "device ",
    .all = "SELECT " COLUMNS " FROM devices ORDER BY device_key",
    .insert = "INSERT INTO devices (id, revision, name, public, created, mac) "
              "VALUES ($1, $2, $3, $4, $5, $6)",
    .remove = "DELETE FROM devices WHERE id = $1 AND mac = $2",
    .drop = {"DELETE FROM devices WHERE device_key = $1"},
    .columns = COL_MAC,
    .field = columns,
    .mac = offsetof(struct rows_device, mac),
    .size = sizeof(struct rows_device),
    .id = COL_NAME,
    .complete = rows_device_complete,
};

enum status rows_device_find(struct log_txn *t, const char *name, struct rows_device *out,
                             struct errinfo *e)
{
    return rows_table_find(t, &rows_devices,
                           "SELECT " COLUMNS " FROM devices WHERE name = $1", COL_NAME,
                           sql_text(name), name, out, e);
}

enum status rows_device_get(struct log_txn *t, const char *id, struct rows_device *out,
                            struct errinfo *e)
{
    return rows_table_find(t, &rows_devices,
                           "SELECT " COLUMNS " FROM devices WHERE id = $1", COL_ID,
                           sql_text(id), id, out, e);
}

enum status rows_device_add(struct log_txn *t, const struct store_device *one,
                            struct errinfo *e)
{
    struct rows_device row;
    const enum status st = rows_device_find(t, one->name, &row, e);

    if (st != ST_ENOTFOUND)
        return st != ST_OK ? st
                           : errinfo_set(e, ST_EEXISTS, "there is a device %s already",
                                         one->name);
    row = (struct rows_device){.one = *one};
    return rows_table_insert(t, &rows_devices, &row, e);
}
