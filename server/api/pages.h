/* pages.h -- the files that the daemon has for a browser: the API's description, /docs and the
 * console.  They are in the program and load nothing from elsewhere: their
 * Content-Security-Policy says so. */
#ifndef SERVER_PAGES_H
#define SERVER_PAGES_H

struct request;
struct worker;

/* pages_handle(r, w): as in route.h, quick: the page of r's path, compressed where the client
 * takes it, 304 where it has it; 404. */
void pages_handle(struct request *r, struct worker *w);

/* pages_console(r, w): the same of /console and its files; 404 too with --no-console. */
void pages_console(struct request *r, struct worker *w);

#endif
