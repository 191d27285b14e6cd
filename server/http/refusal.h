/* refusal.h -- a database that is not the one that was opened is served to nobody. */
#ifndef SERVER_REFUSAL_H
#define SERVER_REFUSAL_H
#include <stdbool.h>

struct app;     /* app.h */
struct request; /* request.h */

/* refusal_stands(r): on a route of /v1 whose database is refused the response is 503 now.
 * refusal_found(r): the same after a look at the database, for those of which nobody asked for a
 * token, since other requests need not read it. */
bool refusal_stands(struct request *r);
bool refusal_found(struct request *r);

/* refusal_tell(app): Writes a line to the log when the refusal is first seen, whenever the anchor has
 * fallen behind, and whenever it is up to date again.  Any thread; after each request, and every
 * second. */
void refusal_tell(struct app *app);

#endif
