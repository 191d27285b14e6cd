/* refusal.h -- a database that is not the one that was opened is served to nobody. */
#ifndef SERVER_REFUSAL_H
#define SERVER_REFUSAL_H
#include <stdbool.h>

struct app;     /* app.h */
struct request; /* request.h */

/* refusal_stands(r): on a route of /v1 whose database is refused the response is 503 now.
 * refusal_found(r): the same after a look at the database, for those of which nobody asked for a
 * token, since other requests need not read it.
 * refusal_tell(app): the first time that the refusal stands, a line in the log; and the first time
 * that the anchor cannot be written. */
bool refusal_stands(struct request *r);
bool refusal_found(struct request *r);
void refusal_tell(struct app *app);

#endif
