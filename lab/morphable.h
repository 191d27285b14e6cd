/* morphable.h -- a morphable model of faces from a folder of OBJ files: meshes of the same
 * vertices and triangles, which differ in where the vertices are.  By their names (capital and
 * small letters alike):
 *     *neutral*.obj                    the neutral face of the mean person; one file
 *     identity*.obj                    that face changed as people differ: one deviation along
 *                                      one mode of identity
 *     brow*, cheek*, eye*, jaw*, mouth*, nose*   that face with one expression, in full; _L or
 *                                      _R before .obj: of one side, with a mirror image
 * Other files are not read.  ICT-FaceKit's folder FaceXModel is such a folder; the expressions'
 * names are those of Apple's ARKit.
 * x is to the face's left, y up, z to the front, x = 0 the plane of symmetry; millimetres,
 * centimetres or metres, as the height of the mesh shows.  Triangles of materials whose names
 * contain blend, fluid, lash or occlusion are left out: a scanner does not see those surfaces. */
#ifndef LAB_MORPHABLE_H
#define LAB_MORPHABLE_H
#include <stdint.h>
#include "errinfo.h"
#include "render.h"

#define MORPHABLE_MODES  1024      /* files of one kind, at most */
#define MORPHABLE_VALUES 100000000 /* vertices times files, at most: 1.2 GB */

struct morphable_expression {
    char name[64];   /* without .obj */
    uint32_t mirror; /* its mirror image's number, or its own */
    float share;     /* of its full extent that people show */
};

struct morphable {
    float *neutral;        /* [3 nv] x, y, z of each vertex: mm, in the canonical frame */
    float *identity;       /* [nidentity][3 nv] how each mode moves them */
    float *expression;     /* [nexpression][3 nv] */
    uint32_t (*corner)[3]; /* [nt] */
    struct morphable_expression *kind; /* [nexpression] */
    uint32_t nv, nt;
    uint32_t nidentity, nexpression; /* at least 1 */
};

/* morphable_read(dir, out, e): the folder's model, moved to the canonical frame: the neutral face
 * has its nose tip at the origin and is upright, as far back 60 mm above the nose tip as 60 mm
 * below.
 * out  new object, released by morphable_free(); NULL on error
 * Returns ST_OK; ST_ENOTFOUND, ST_EIO; ST_EINVAL a malformed or missing file, or one of other
 * vertices than the neutral face's; ST_ENOTFINITE; ST_ENOTFACE the neutral face is none: not
 * symmetric, not of a face's size, or without a nose; ST_ELIMIT; ST_ENOMEM. */
enum status morphable_read(const char *dir, struct morphable **out, struct errinfo *e);
void morphable_free(struct morphable *m); /* NULL is allowed */

/* morphable_person(m, deviation, random, at): a random neutral face; the modes of identity have
 * independent coefficients of that deviation.
 * random  state of rates_random()
 * at      [3 nv] */
void morphable_person(const struct morphable *m, float deviation, uint64_t *random,
                      float *at);

/* morphable_express(m, random, at): the face at with a random expression: two to eight of the
 * model's, mostly on both sides of the face, each of half its extent or so, and a little of all
 * others. */
void morphable_express(const struct morphable *m, uint64_t *random, float *at);

/* morphable_heights(m, at, out): render_heights() of the face. */
void morphable_heights(const struct morphable *m, const float *at, float out[GRID_N]);

#endif
