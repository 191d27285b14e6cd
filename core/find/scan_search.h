/* scan_search.h -- what the search for the face found, and what the points are as they are, so that
 * a second call of scan_build() for the same points, by the other gate, need not compute it again.
 * Between the two calls nobody changes the face that they have as out. */
#ifndef FIND_SCAN_SEARCH_H
#define FIND_SCAN_SEARCH_H
#include <stdbool.h>
#include "face.h"
#include "find.h"
#include "shape.h"
#include "status.h"

struct scan_search {
    bool done;
    enum status st;       /* of the search */
    struct find find;     /* where st is ST_OK, as is the fit */
    struct shape_fit fit; /* to the points in find's unit */

    bool as_is;                 /* a model was made of the points as they are */
    enum status st_as_is;       /* of that */
    size_t bad;                 /* as of face_build() */
    struct face model;          /* its memory is out's */
    bool fitted;                /* they were fitted, too */
    enum status st_fitted;      /* of that */
    struct shape_fit fit_as_is; /* where st_fitted is ST_OK */
};

#endif
