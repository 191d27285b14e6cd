/* refusal.h -- refuses all of /v1 if the database is not the one that was opened. */
#ifndef SERVER_REFUSAL_H
#define SERVER_REFUSAL_H
#include <stdbool.h>

struct app;     /* app.h */
struct request; /* request.h */

/* refusal_stands(r): Returns true if r->route is one of /v1 and the database is refused; then sets r->response
 * to 503. */
bool refusal_stands(struct request *r);

/* refusal_found(r): Like refusal_stands(), but looks at the database first.  Only with --no-auth: otherwise
 * the check of the token has looked at it. */
bool refusal_found(struct request *r);

/* refusal_tell(app): Writes a line to the log when the refusal is first seen, whenever the anchor has
 * fallen behind, and whenever it is up to date again.  Any thread; after each request, and every
 * second. */
void refusal_tell(struct app *app);

#endif
