/* scan_search.h -- what the search for the face found, so that a second call of scan_build() for
 * the same points, by the other gate, need not search again. */
#ifndef SCAN_SCAN_SEARCH_H
#define SCAN_SCAN_SEARCH_H
#include <stdbool.h>
#include "find.h"
#include "shape.h"
#include "status.h"

struct scan_search {
    bool done;
    enum status st;       /* of the search */
    struct find find;     /* where st is ST_OK, as is the fit */
    struct shape_fit fit; /* to the points in find's unit */
};

#endif
