/* cloudpoints.h -- what a scanner's file says. */
#ifndef CORE_CLOUDPOINTS_H
#define CORE_CLOUDPOINTS_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "mem.h"
#include "vec.h"

/* The points that have a value, in the order of the file.  Dropped are those with a
 * coordinate that is NaN or infinite, and those at exactly (0, 0, 0) where that stands for
 * "no value": in an organised cloud, and wherever two or more points are there.  Of an organised
 * cloud also those whose number stands for it (9999), and those beyond the range of cameras.
 * normal  NULL: none are known.  The file's own or, of a mesh, the sum over a point's faces of
 *         their normal by the corners' order, times twice the area.  Of any length; (0, 0, 0)
 *         where nothing is known.  Whether they point outward is as the file has it
 * index   each one's place among those read, ascending; NULL: none was dropped.  The places of
 *         an organised cloud go row by row: place % width is the column
 * read    with those dropped: read - n are.  Equal vertices of an STL file count once */
struct cloudpoints {
    unsigned format;  /* as its reader numbers the formats (cloudformat.h) */
    struct dvec3 *at; /* in the file's unit and axes */
    struct dvec3 *normal;
    uint32_t *index;
    size_t n; /* of at, normal and index */
    size_t read;
    double
        usual_mm; /* the unit of such files, which not every program keeps to; 0: none */
    double unit_mm; /* millimetres per unit; 0: neither the caller nor the file says */
    /* either says: x to the image's right, y up, z towards the scanner */
    bool axes_given;
    uint32_t width, height; /* of an organised cloud, as of a depth camera; else 0 */
    bool
        pinhole; /* x and y were computed from depths by a focal length that was stated */
    double
        value_mm; /* with pinhole: millimetres per value of the depth image; 0: unknown */
};

/* It is empty again. */
static inline void cloudpoints_free(struct cloudpoints *c)
{
    mem_free(c->at);
    mem_free(c->normal);
    mem_free(c->index);
    *c = (struct cloudpoints){0};
}

#endif
