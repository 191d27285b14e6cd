/* page.h -- the surfaces of show.h as one web page: opened from a file in a browser it shows them with the
 * console's view, and loads nothing. */
#ifndef SCAN_PAGE_H
#define SCAN_PAGE_H
#include "newfile.h"

struct json; /* json.h */

/* page_side(j, key, name, about, at, quality): Writes a side of the comparison into the member "extras" that is
 * open in j.
 *   key      "a", in a comparison also "b"
 *   about    origin of the face
 *   at       time as utc_print() prints it; NULL: unknown
 *   quality  NAN: unknown */
void page_side(struct json *j, const char *key, const char *name, const char *about,
               const char *at, double quality);

/* page_file(j, key, path, quality): Writes a scan's file as a side, with the file's time. */
void page_file(struct json *j, const char *key, const char *path, double quality);

/* page_made(j): Writes the time at which the page is made. */
void page_made(struct json *j);

/* page_write(to, show, e): Writes the page of a struct show, whose extras are those of a comparison or a check
 * as POST /v1/compare and /v1/check respond.  Returns ST_OK; ST_ENOMEM. */
newfile_writer page_write;

#endif
