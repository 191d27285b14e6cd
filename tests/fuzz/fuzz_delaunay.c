/* Any points of the lattice: the triangulation, its spanning tree, and the general
 * triangulation of two halves, which must be the triangulation of all.  The first byte selects
 * how the others become coordinates, from a tiny grid with many cocircular and repeated points
 * to the whole lattice. */
#define FUZZ_ROUNDS 500 /* slower than most */
#include "fuzz.h"

#include <stdlib.h>

#include "brute.h"
#include "delaunay.h"
#include "lattice.h"
#include "locate.h"
#include "mem.h"
#include "merge.h"
#include "mesh.h"
#include "mst.h"

#define MAX_POINTS 120

static int32_t coordinate(unsigned mode, const uint8_t *p)
{
    switch (mode) {
    case 0:
        return *p % 8;
    case 1:
        return (int8_t)*p;
    case 2:
        return (int8_t)*p * (LATTICE_MAX / 128);
    default:
        return (int32_t)((uint32_t)*p * 2654435761U >> 7) - LATTICE_MAX;
    }
}

static void merge_halves(const struct ivec3 *pts, size_t n, const struct mesh *whole,
                         struct scratch *s)
{
    struct mesh a = {0}, b = {0}, both = {0};
    struct location loc[MAX_POINTS];
    uint32_t vertex[MAX_POINTS];

    if (delaunay_build(pts, n / 2, s, &a) == ST_OK &&
        delaunay_build(pts + n / 2, n - n / 2, s, &b) == ST_OK) {
        require(mst_build(&a, s) == ST_OK && mst_build(&b, s) == ST_OK);
        locate_mesh(&a, &b, loc);
        require(merge_build(&a, &b, loc, s, &both, vertex) == ST_OK);
        require(mesh_check(&both, false) == ST_OK);
        require(brute_same(whole, &both));
    }
    mesh_free(&a);
    mesh_free(&b);
    mesh_free(&both);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct ivec3 pts[MAX_POINTS];
    struct mesh m = {0};
    struct scratch s = {0};
    size_t n = 0;
    enum status st;

    for (const uint8_t *p = data + 1; size > 2 && n < MAX_POINTS && p + 1 < data + size;
         p += 2, n++)
        pts[n] = (struct ivec3){coordinate(data[0] % 4, p),
                                coordinate(data[0] % 4, p + 1), *p};
    st = delaunay_build(pts, n, &s, &m);
    if (st == ST_OK) {
        require(mesh_check(&m, false) == ST_OK);
        require(mst_build(&m, &s) == ST_OK);
        require(mesh_check(&m, true) == ST_OK);
        require(mst_check(&m) == ST_OK);
        merge_halves(pts, n, &m, &s);
    } else {
        require(st == ST_EDEGENERATE && m.nv == 0);
    }
    mesh_free(&m);
    scratch_free(&s);
    return 0;
}
