/* store_mac.h -- rows that are not encrypted but authenticated: a keyed hash of their columns
 * is in the column after them.  Layout: db/FORMAT.md. */
#ifndef DB_STORE_MAC_H
#define DB_STORE_MAC_H
#include <stdbool.h>
#include <stddef.h>
#include "vault.h"

struct sql_rows;  /* sql.h */
struct sql_value; /* sql.h */

/* store_mac(v, what, value, n, out): of n columns; what: 16 bytes that keep one table from
 * another.  A MAC that no row can have where they are more than 4 KB.
 * store_mac_right(v, what, r, n): has the current row that of its first n columns in the next? */
void store_mac(const struct vault *v, const char what[16], const struct sql_value *value,
               size_t n, unsigned char out[VAULT_HASH]);
bool store_mac_right(const struct vault *v, const char what[16], const struct sql_rows *r,
                     int n);

#endif
