/* objmesh.h -- the vertices and triangles of a Wavefront OBJ file, all of them and in its order:
 * the files of a morphable model differ in the places of their vertices alone.  (The reader of
 * scans, cloudobj.h, drops what has no value and knows no materials.) */
#ifndef LAB_OBJMESH_H
#define LAB_OBJMESH_H
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include "errinfo.h"

#define OBJMESH_MAX_BYTES 268435456 /* of a file: 256 MB */
#define OBJMESH_MAX       1000000   /* vertices, or triangles */

struct objmesh {
    float *at;             /* [3 nv] x, y, z of each vertex, in the file's unit; finite */
    uint32_t (*corner)[3]; /* [nt] polygons as fans of triangles */
    uint32_t nv, nt;
};

/* objmesh_read(path, takes, out, e): a file.
 * takes  takes(name): are the polygons of the material of that name taken ("": of none)?
 *        NULL: the vertices alone are read
 * out    released by objmesh_free(); empty on failure
 * Lines other than v, f and usemtl are skipped.  Any bytes are safe.
 * Returns ST_OK; ST_ENOTFOUND, ST_EIO; ST_EINVAL not a regular file, or malformed;
 * ST_ENOTFINITE a coordinate; ST_ELIMIT; ST_ENOMEM.  e names the file, and the line if it is
 * one that is wrong. */
enum status objmesh_read(const char *path, bool (*takes)(const char *material),
                         struct objmesh *out, struct errinfo *e);

/* objmesh_parse(in, takes, out, e): the same of an open file; e does not name it. */
enum status objmesh_parse(FILE *in, bool (*takes)(const char *material),
                          struct objmesh *out, struct errinfo *e);
void objmesh_free(struct objmesh *m); /* it is empty again */

#endif
