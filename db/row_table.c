#include "row_table.h"

#include <stdio.h>
#include <string.h>

#include "errinfo.h"
#include "store_column.h"
#include "store_mac.h"
#include "store_rules.h"
#include "store_txn.h"

static void left_of(const struct store_txn *t, const struct row_table *table,
                    const struct sql_rows *r, int col, struct row_event_row *left)
{
    char id[STORE_ID_LEN + 1];

    memset(left, 0, sizeof *left);
    left->gone = !store_column_text(r, col, id, sizeof id) || !store_id_valid(id);
    if (!left->gone)
        store_rules_raw(id, left->object);
    store_mac_row(t->vault, table->label, r, col, table->columns, left->mac);
}

enum status row_table_is(struct store_txn *t, const struct row_table *table,
                         const struct sql_rows *r, int col, const char *name,
                         struct errinfo *e)
{
    struct row_event_row now;
    enum status st;

    left_of(t, table, r, col, &now);
    st = row_event_is(t, &now, e);
    return st != ST_ECORRUPT
               ? st
               : errinfo_set(e, st, "%s %s: its row is not the one that was written last",
                             table->word, name);
}

enum status row_table_see(struct store_txn *t, const struct row_table *table,
                          row_event_see *see, void *arg, struct errinfo *e)
{
    struct row_event_row now;
    struct sql_rows *r;
    enum status st = sql_query(t->sql, table->all, NULL, 0, &r, e);

    while (st == ST_OK && sql_next(r)) {
        char of[STORE_DEVICE_MAX + 1], name[80];

        left_of(t, table, r, 0, &now);
        if (!store_column_text(r, table->name, of, sizeof of) ||
            (table->name == 0 && now.gone)) /* it is no id */
            (void)snprintf(of, sizeof of, "?");
        (void)snprintf(name, sizeof name, "%s %s", table->word, of);
        st = see(arg, &now, name, e);
    }
    return sql_done(r, st, e);
}

enum status row_table_tell(struct store_txn *t, const struct row_table *table,
                           const char *id, const struct store_act *by, const char *kind,
                           const char *subject, const char *template_id,
                           const char *outcome, struct errinfo *e)
{
    struct row_event_row left = {.gone = true};
    struct sql_rows *r;
    enum status st = SQL_QUERY(t->sql, &r, e, table->of, sql_text(id));

    store_rules_raw(id, left.object);
    if (st == ST_OK && sql_next(r))
        left_of(t, table, r, 0, &left);
    if ((st = sql_done(r, st, e)) != ST_OK)
        return st;
    return row_event_leave(t, by, kind, subject, template_id, outcome, &left, e);
}
