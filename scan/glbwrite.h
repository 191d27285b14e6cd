/* glbwrite.h -- surfaces and points as a binary glTF 2.0 file, for viewers and for keeping. */
#ifndef SCAN_GLBWRITE_H
#define SCAN_GLBWRITE_H
#include <stddef.h>
#include <stdint.h>
#include "status.h"

struct json; /* json.h */

#define GLBWRITE_SCALARS 3

/* A surface, or, without triangles, points.  All borrowed. */
struct glbwrite_node {
    const char *name;
    const float *at;          /* [3 n], mm, finite */
    uint32_t n;               /* at least 1 */
    const uint32_t *triangle; /* [3 triangles] */
    uint32_t triangles;
    const unsigned char *color; /* [4 n]: red, green, blue, opacity; NULL: none */
    struct glbwrite_scalar {
        const char *name;   /* "_GAP_MM"; NULL: none, nor are the next */
        const float *value; /* finite */
    } scalar[GLBWRITE_SCALARS];
};

/* glbwrite(node, n, j, out, len): nodes in mm, scaled to glTF's metres.  j: a document whose
 * outermost object is open and may have the member "extras"; taken, also on failure.
 * *out  heap, for free(); on failure NULL
 * Returns ST_OK, ST_ENOMEM.  O(bytes): 12 a point, 4 a scalar or colour of it, 6 (of up to 65,535
 * points) or 12 a triangle. */
enum status glbwrite(const struct glbwrite_node *node, size_t n, struct json *j,
                     unsigned char **out, size_t *len);

#endif
