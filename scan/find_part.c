#include "find_part.h"

#include <stdbool.h>
#include <string.h>

#include "mem.h"
#include "tuning.h"

struct part {
    uint32_t root, points, ncells, nvoxels;
    int32_t lo[3], hi[3];
};

/* ---- union and find, by cells */

static uint32_t root_of(uint32_t *parent, uint32_t c)
{
    while (parent[c] != c) {
        parent[c] = parent[parent[c]];
        c = parent[c];
    }
    return c;
}

/* The lower number becomes the root. */
static void join(uint32_t *parent, uint32_t a, uint32_t b)
{
    a = root_of(parent, a);
    b = root_of(parent, b);
    if (a < b)
        parent[b] = a;
    else
        parent[a] = b;
}

static void join_all(const struct find_grid *g, uint32_t *parent)
{
    for (uint32_t c = 0; c < g->ncells; c++)
        parent[c] = c;
    for (uint32_t c = 0; c < g->ncells; c++) {
        int32_t at[3];

        find_grid_place(g, c, at);
        for (int32_t z = at[2] - 1; z <= at[2]; z++)
            for (int32_t y = at[1] - 1; y <= at[1] + 1; y++) {
                const struct find_run run = find_grid_run(g, at[0] - 1, at[0] + 1, y, z);

                for (uint32_t o = run.first; o < run.end && o < c; o++)
                    join(parent, o, c);
            }
    }
}

/* ---- the parts, by root */

static uint32_t points_in(const struct find_grid *g, uint32_t c)
{
    uint32_t n = 0;

    for (uint32_t v = g->first[c]; v < g->first[c + 1]; v++)
        n += g->voxel[v].n;
    return n;
}

/* Sum up the cells of each root in part[root]. */
static void measure(const struct find_grid *g, uint32_t *parent, struct part *part)
{
    for (uint32_t c = 0; c < g->ncells; c++) {
        const uint32_t root = root_of(parent, c);
        struct part *p = &part[root];
        int32_t at[3];

        find_grid_place(g, c, at);
        if (root == c) {
            *p = (struct part){.root = c};
            memcpy(p->lo, at, sizeof at);
            memcpy(p->hi, at, sizeof at);
        }
        p->points += points_in(g, c);
        p->ncells++;
        p->nvoxels += g->first[c + 1] - g->first[c];
        for (int i = 0; i < 3; i++) {
            p->lo[i] = at[i] < p->lo[i] ? at[i] : p->lo[i];
            p->hi[i] = at[i] > p->hi[i] ? at[i] : p->hi[i];
        }
    }
}

static bool head_sized(const struct part *p)
{
    double size = 0;

    for (int i = 0; i < 3; i++) {
        const double side = (p->hi[i] - p->lo[i] + 1) * FIND_GRID_CELL_MM;

        size = side > size ? side : size;
    }
    return p->points >= FIND_PART_POINTS && size >= FIND_HEAD_MIN_MM &&
           size <= FIND_ROOM_MIN_MM;
}

static uint32_t choose(const struct find_grid *g, const uint32_t *parent,
                       const struct part *part, struct part best[FIND_PARTS])
{
    uint32_t n = 0;

    for (uint32_t c = 0; c < g->ncells; c++) {
        uint32_t i;

        if (parent[c] != c || !head_sized(&part[c]) ||
            (n == FIND_PARTS && part[c].points <= best[n - 1].points))
            continue;
        i = n < FIND_PARTS ? n++ : n - 1;
        for (; i > 0 && part[c].points > best[i - 1].points; i--)
            best[i] = best[i - 1];
        best[i] = part[c];
    }
    return n;
}

static enum status copy(const struct find_grid *g, uint32_t *parent, const struct part *p,
                        struct find_grid *out)
{
    uint32_t cell = 0, voxel = 0;
    enum status st;

    *out = *g;
    out->ncells = p->ncells;
    out->nvoxels = p->nvoxels;
    if ((st = find_grid_room(out)) != ST_OK)
        return st;
    for (uint32_t c = 0; c < g->ncells; c++) {
        const uint32_t n = g->first[c + 1] - g->first[c];

        if (root_of(parent, c) != p->root)
            continue;
        out->cell[cell] = g->cell[c];
        out->first[cell++] = voxel;
        memcpy(&out->voxel[voxel], &g->voxel[g->first[c]], n * sizeof *g->voxel);
        voxel += n;
    }
    out->first[cell] = voxel;
    find_grid_rows(out);
    return ST_OK;
}

enum status find_part_all(const struct find_grid *g, struct find_grid parts[FIND_PARTS],
                          uint32_t *n)
{
    struct part best[FIND_PARTS];
    uint32_t *parent = mem_array(g->ncells, sizeof *parent), found;
    struct part *part = mem_array(g->ncells, sizeof *part);
    enum status st = parent != NULL && part != NULL ? ST_OK : ST_ENOMEM;

    *n = 0;
    if (st == ST_OK) {
        join_all(g, parent);
        measure(g, parent, part);
        found = choose(g, parent, part, best);
        while (*n < found && (st = copy(g, parent, &best[*n], &parts[*n])) == ST_OK)
            (*n)++;
    }
    mem_free(parent);
    mem_free(part);
    while (st != ST_OK && *n > 0)
        find_grid_free(&parts[--*n]);
    return st;
}
