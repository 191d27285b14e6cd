/* routes.h -- the table of what can be requested, and who handles it.  A new route is a
 * handler in a module of its own, a row of this table, and a path of openapi.json. */
#ifndef SERVER_ROUTES_H
#define SERVER_ROUTES_H
#include <stddef.h>

struct route; /* route.h */

/* routes_table(n): the *n routes; static. */
const struct route *routes_table(size_t *n);

#endif
