/* docs.h -- the API's description as a page for a browser.  The page is in the program and
 * loads nothing from elsewhere: its Content-Security-Policy says so. */
#ifndef SERVER_DOCS_H
#define SERVER_DOCS_H

struct request;
struct worker;

/* Handlers, as in route.h: quick, all 200 or out of memory. */
void docs_page(struct request *r, struct worker *w);
void docs_style(struct request *r, struct worker *w);
void docs_script(struct request *r, struct worker *w);
void docs_openapi(struct request *r, struct worker *w); /* the description itself */

#endif
