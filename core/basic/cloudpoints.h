/* cloudpoints.h -- the content of a scanner's file. */
#ifndef CORE_CLOUDPOINTS_H
#define CORE_CLOUDPOINTS_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "mem.h"
#include "vec.h"

/* The points that have a value, in the order of the file.  The readers drop points with a
 * coordinate that is NaN or infinite; points at exactly (0, 0, 0) if that stands for
 * "no value": in an organised cloud, or if two or more points are there; and in an organised
 * cloud points with a number that stands for it (9999), or beyond the range of cameras.
 * normal  NULL: unknown.  The file's own or, in a mesh, the sum over a point's faces of
 *         their normal by the corners' order, times twice the area.  Of any length; (0, 0, 0):
 *         unknown.  The file decides whether they point outward
 * index   each point's number among those read, ascending; NULL: none was dropped.  An
 *         organised cloud goes row by row: index % width is the column
 * read    number of points read; read - n were dropped.  Equal vertices of an STL file count once */
struct cloudpoints {
    unsigned format;  /* enum cloudformat (cloudformat.h) */
    struct dvec3 *at; /* points, in the file's unit and axes */
    struct dvec3 *normal;
    uint32_t *index;
    size_t n; /* length of at, normal and index */
    size_t read;
    double usual_mm; /* usual unit of such files, which not every program uses; 0: none */
    double unit_mm;  /* millimetres per unit; 0: neither the caller nor the file says */
    bool
        axes_given; /* caller or file state: x to the image's right, y up, z towards the scanner */
    uint32_t width, height; /* size of an organised cloud, as of a depth camera; else 0 */
    bool pinhole; /* true: x and y were computed from depths by a given focal length */
    double
        value_mm; /* millimetres per value of the depth image, if pinhole; 0: unknown */
};

/* Frees the points, and resets c to the empty state. */
static inline void cloudpoints_free(struct cloudpoints *c)
{
    mem_free(c->at);
    mem_free(c->normal);
    mem_free(c->index);
    *c = (struct cloudpoints){0};
}

#endif
