/* routes.h -- the table of routes.  A new route is a handler in a module of its own, a row of this table and
 * a path of openapi.json. */
#ifndef SERVER_ROUTES_H
#define SERVER_ROUTES_H
#include <stddef.h>

struct route; /* route.h */

/* routes_table(n): Returns the static table, and sets *n to the number of its rows. */
const struct route *routes_table(size_t *n);

#endif
