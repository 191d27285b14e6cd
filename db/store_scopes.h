/* store_scopes.h -- what a token may do, as text. */
#ifndef DB_STORE_SCOPES_H
#define DB_STORE_SCOPES_H
#include "store_types.h"

/* store_scopes_read(text, out): one or more names with commas between; false: another.
 * store_scopes_write(scopes, out): the names of those that are set, in the order of their bits. */
bool store_scopes_read(const char *text, unsigned *out);
void store_scopes_write(unsigned scopes, char out[STORE_SCOPES_MAX]);

#endif
