/* cloudplyhead.h -- the header of a PLY file.  For cloudply.c. */
#ifndef SCAN_CLOUDPLYHEAD_H
#define SCAN_CLOUDPLYHEAD_H
#include <stdbool.h>
#include <stdint.h>
#include "cloudvalue.h"
#include "status.h"

struct cloudtext; /* cloudtext.h */

#define CLOUDPLYHEAD_ELEMENTS   16
#define CLOUDPLYHEAD_PROPERTIES 256

enum cloudplyhead_encoding {
    CLOUDPLYHEAD_NONE,
    CLOUDPLYHEAD_ASCII,
    CLOUDPLYHEAD_LITTLE,
    CLOUDPLYHEAD_BIG
};

enum cloudplyhead_role { /* 0 to 5: a vertex's x, y, z, nx, ny, nz */
                         CLOUDPLYHEAD_CORNERS = 6, /* a face's list of vertices */
                         CLOUDPLYHEAD_IGNORED
};

struct cloudplyhead_property {
    unsigned char type;  /* enum cloudvalue, of the value, or of the list's items */
    unsigned char count; /* of a list's length; CLOUDVALUE_NONE: not a list */
    unsigned char role;
};

struct cloudplyhead_element {
    uint64_t rows;
    uint32_t first, n; /* its properties */
    uint32_t stride;   /* bytes a row without its lists' items */
    bool lists, faces;
};

struct cloudplyhead {
    enum cloudplyhead_encoding encoding;
    uint32_t elements, properties;
    uint32_t vertex; /* which element has the vertices */
    bool normals;    /* the vertices have nx, ny and nz */
    bool swap;       /* the data's byte order is not this machine's */
    struct cloudplyhead_element element[CLOUDPLYHEAD_ELEMENTS];
    struct cloudplyhead_property property[CLOUDPLYHEAD_PROPERTIES];
};

/* cloudplyhead_read(t, h): t stands at the first byte of the file, then at that of the data.
 * Each coordinate is there, once, and no list.
 * Returns ST_OK; ST_EINVAL; ST_EVERSION also for more than CLOUDPLYHEAD_ELEMENTS elements or
 * CLOUDPLYHEAD_PROPERTIES properties. */
enum status cloudplyhead_read(struct cloudtext *t, struct cloudplyhead *h);

#endif
