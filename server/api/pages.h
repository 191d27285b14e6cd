/* pages.h -- handlers of the files for a browser: the description of the API, /docs and the console.
 * The files are part of the program.  Their Content-Security-Policy allows them to load nothing from
 * other sites. */
#ifndef SERVER_PAGES_H
#define SERVER_PAGES_H

struct request; /* request.h */
struct worker;  /* worker.h */

/* pages_handle(r, w): Sends the file of the path of r, compressed if the client accepts it, or 304 or 404.  A
 * quick route (route.h). */
void pages_handle(struct request *r, struct worker *w);

/* pages_root(r, w): For "/": 303 to the console; to /docs with --no-console. */
void pages_root(struct request *r, struct worker *w);

/* pages_console(r, w): Like pages_handle(), for /console and its files; 404 with --no-console. */
void pages_console(struct request *r, struct worker *w);

#endif
