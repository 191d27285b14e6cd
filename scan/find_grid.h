/* find_grid.h -- a cloud as the means of its points over small cubes (voxels), which lie in
 * larger ones (cells) by which neighbours are found.  Internal to find.h. */
#ifndef SCAN_FIND_GRID_H
#define SCAN_FIND_GRID_H
#include <stddef.h>
#include <stdint.h>
#include "status.h"
#include "vec.h"

#define FIND_GRID_VOXEL_MM 5.0
#define FIND_GRID_SIDE     4 /* voxels along a cell's side */
#define FIND_GRID_CELL_MM  (FIND_GRID_VOXEL_MM * FIND_GRID_SIDE)

/* The mean of the points in a cube, mm from the grid's corner. */
struct find_voxel {
    float at[3];
    uint32_t n;
};

struct find_grid {
    struct dvec3 corner; /* mm */
    double unit_mm;
    int32_t nx, ny, nz;       /* cells */
    uint32_t nvoxels, ncells; /* that have points */
    struct find_voxel *voxel; /* by cells */
    uint32_t *cell;           /* its number, (z ny + y) nx + x; ascending */
    uint32_t *first;          /* [ncells + 1] its first voxel */
    uint32_t *row;            /* [nz ny + 1] the first cell of a row along x */
};

/* find_grid_make(pts, n, unit_mm, middle, g): the points within FIND_REACH_CELLS cells of middle
 * (mm) on each axis; the others are left out.
 * Linear in n, whatever the points.  Returns ST_OK, ST_ENOMEM; g is to be freed after ST_OK
 * alone.  None in reach: g has no cells. */
enum status find_grid_make(const struct dvec3 *pts, size_t n, double unit_mm,
                           struct dvec3 middle, struct find_grid *g);
void find_grid_free(struct find_grid *g);

/* For another grid of the same size: find_grid_room(g) allocates what g->nvoxels and
 * g->ncells need; find_grid_rows(g) fills g->row once the cells are there. */
enum status find_grid_room(struct find_grid *g);
void find_grid_rows(struct find_grid *g);

/* find_grid_place(g, c, at): where cell[c] lies, x, y, z, in cells. */
void find_grid_place(const struct find_grid *g, uint32_t c, int32_t at[3]);

/* Cells along x: from cell[first] to cell[end - 1]. */
struct find_run {
    uint32_t first, end;
};

/* find_grid_run(g, x0, x1, y, z): those of row (y, z) with x from x0 to x1; none off the grid. */
struct find_run find_grid_run(const struct find_grid *g, int32_t x0, int32_t x1,
                              int32_t y, int32_t z);

#endif
