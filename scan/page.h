/* page.h -- what show.h makes, as one web page: opened from a file in a browser it shows the
 * surfaces with the console's view, and loads nothing. */
#ifndef SCAN_PAGE_H
#define SCAN_PAGE_H
#include "newfile.h"

struct json; /* json.h */

/* page_side(j, key, name, about, at, quality): in the member "extras" that is open in j, who or what
 * is looked at: "a", in a comparison also "b".  about: where it is from.  at: a time, as utc_print()
 * makes it.  NULL, NAN: not known.
 * page_file(j, key, path, quality): the same of a scan's file, of its own time.
 * page_made(j): when the page was made. */
void page_side(struct json *j, const char *key, const char *name, const char *about,
               const char *at, double quality);
void page_file(struct json *j, const char *key, const char *path, double quality);
void page_made(struct json *j);

/* page_write(to, show, e): the page; show: a struct show, with the extras of a comparison or a check
 * as POST /v1/compare and /v1/check give them.  ST_ENOMEM. */
newfile_writer page_write;

#endif
