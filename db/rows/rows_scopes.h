/* rows_scopes.h -- what a token may do, as text. */
#ifndef DB_ROWS_SCOPES_H
#define DB_ROWS_SCOPES_H
#include "rows_types.h"

/* rows_scopes_read(text, out): one or more names with commas between; false: another.
 * rows_scopes_write(scopes, out): the names of those that are set, in the order of their bits. */
bool rows_scopes_read(const char *text, unsigned *out);
void rows_scopes_write(unsigned scopes, char out[STORE_SCOPES_MAX]);

#endif
