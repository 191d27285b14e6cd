/* store_mac.h -- a keyed hash of a row's columns, for the entry of the audit log that leaves the
 * row so (row_event.h).  Layout: db/FORMAT.md. */
#ifndef DB_STORE_MAC_H
#define DB_STORE_MAC_H
#include <stdbool.h>
#include <stddef.h>
#include "vault.h"

struct sql_rows;  /* sql.h */
struct sql_value; /* sql.h */

/* store_mac(v, what, value, n, out): of n columns; what: 16 bytes that keep one table from
 * another.  A MAC that no row can have where they are more than 4 KB.
 * store_mac_row(v, what, r, col, n, out): of n columns of the current row, up to 16, from the
 * column col on. */
void store_mac(const struct vault *v, const char what[16], const struct sql_value *value,
               size_t n, unsigned char out[VAULT_HASH]);
void store_mac_row(const struct vault *v, const char what[16], const struct sql_rows *r,
                   int col, int n, unsigned char out[VAULT_HASH]);

#endif
