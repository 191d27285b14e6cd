#include "show.h"

#include <math.h>
#include <string.h>

#include "face.h"
#include "glbwrite.h"
#include "grid.h"
#include "heatmap.h"
#include "json.h"
#include "lattice.h"
#include "mem.h"

/* The colour of data, from what speaks for one person to what speaks against it, and the part
 * of the score at either end: docs/console.md. */
static const unsigned char scale[7][3] = {
    {0x9e, 0x34, 0x06}, {0xec, 0x94, 0x4e}, {0xf6, 0xde, 0xc2}, {0xf0, 0xed, 0xe5},
    {0xc4, 0xd8, 0xe6}, {0x46, 0x88, 0xce}, {0x10, 0x36, 0x82}};
#define PART_END 0.6f

/* A node's arrays. */
struct arrays {
    float (*at)[3];
    uint32_t (*triangle)[3];
    unsigned char (*color)[4];
    float *gap, *rest, *part;
    struct dvec3 *point; /* in the frontal view of their own scan */
};

static void arrays_free(struct arrays *a)
{
    mem_free(a->at);
    mem_free(a->triangle);
    mem_free(a->color);
    mem_free(a->gap);
    mem_free(a->rest);
    mem_free(a->part);
    mem_free(a->point);
}

/* The triangles that were measured. */
static uint32_t triangles_of(const struct surface *s, uint32_t (*out)[3])
{
    uint32_t n = 0;

    for (uint32_t t = 0; t < s->mesh.nt; t++)
        if (s->bridge[t] == 0)
            memcpy(out[n++], s->mesh.org + 3 * (size_t)t, sizeof *out);
    return n;
}

static struct dvec3 moved(const double m[16], struct dvec3 p)
{
    return (struct dvec3){m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3],
                          m[4] * p.x + m[5] * p.y + m[6] * p.z + m[7],
                          m[8] * p.x + m[9] * p.y + m[10] * p.z + m[11]};
}

static void put(float to[3], const struct pose *frame, struct dvec3 p)
{
    const struct dvec3 q = pose_apply(frame, p);

    to[0] = (float)q.x;
    to[1] = (float)q.y;
    to[2] = (float)q.z;
}

/* The surface of f in a frame, moved by m before (NULL: not). */
static enum status surface_node(const struct face *f, const double *m,
                                const struct pose *frame, const char *name,
                                struct arrays *a, struct glbwrite_node *out)
{
    const struct mesh *mesh = &f->surface.mesh;
    const double mm = 1.0 / LATTICE_PER_MM;

    a->at = mem_array(mesh->nv, sizeof *a->at);
    a->point = mem_array(mesh->nv, sizeof *a->point);
    a->triangle = mem_array(mesh->nt, sizeof *a->triangle);
    if (a->at == NULL || a->point == NULL || a->triangle == NULL)
        return ST_ENOMEM;
    for (uint32_t v = 0; v < mesh->nv; v++) {
        a->point[v] =
            (struct dvec3){mesh->xy[v].x * mm, mesh->xy[v].y * mm, mesh->z[v] * mm};
        put(a->at[v], frame, m != NULL ? moved(m, a->point[v]) : a->point[v]);
    }
    *out = (struct glbwrite_node){.name = name,
                                  .at = a->at[0],
                                  .n = mesh->nv,
                                  .triangle = a->triangle[0],
                                  .triangles = triangles_of(&f->surface, a->triangle)};
    return ST_OK;
}

/* Between the centres of the four cells round a place, of those that have a value; NAN: none. */
static float between(const float cell[GRID_N], double x, double y)
{
    const double i = (x - GRID_LEFT) / GRID_MM - 0.5,
                 j = (y - GRID_BOTTOM) / GRID_MM - 0.5;
    const int i0 = (int)floor(i), j0 = (int)floor(j);
    double sum = 0, weight = 0;

    if (grid_cell(x, y) == GRID_NONE || isnan(cell[grid_cell(x, y)]))
        return (float)NAN;
    for (int k = 0; k < 4; k++) {
        const int u = i0 + k % 2, v = j0 + k / 2;
        const double w = (1 - fabs(i - u)) * (1 - fabs(j - v));

        if (u < 0 || u >= GRID_NX || v < 0 || v >= GRID_NY ||
            isnan(cell[v * GRID_NX + u]))
            continue;
        sum += w * (double)cell[v * GRID_NX + u];
        weight += w;
    }
    return weight > 0 ? (float)(sum / weight) : (float)NAN;
}

static void paint(float part, unsigned char out[4])
{
    const float end = fminf(fmaxf(part / PART_END, -1.0f), 1.0f),
                at = (end + 1.0f) * 3.0f;
    const int i = at < 5.0f ? (int)at : 5;

    for (int k = 0; k < 3; k++)
        out[k] = (unsigned char)lrintf((float)scale[i][k] +
                                       (at - (float)i) *
                                           (float)(scale[i + 1][k] - scale[i][k]));
    out[3] = 255;
}

/* What each point of the probe differs by. */
static enum status differences(const struct face *tmpl, const double transform[16],
                               const struct face_field *field, struct arrays *a,
                               struct glbwrite_node *node)
{
    const double by = pose_unscaled(&tmpl->frame.pose).r[0] != 0
                          ? tmpl->frame.pose.r[0] / pose_unscaled(&tmpl->frame.pose).r[0]
                          : 1;
    double *gap = mem_array(node->n, sizeof *gap);
    enum status st = ST_ENOMEM;

    a->gap = mem_array(node->n, sizeof *a->gap);
    a->rest = mem_array(node->n, sizeof *a->rest);
    a->part = mem_array(node->n, sizeof *a->part);
    a->color = mem_array(node->n, sizeof *a->color);
    if (gap != NULL && a->gap != NULL && a->rest != NULL && a->part != NULL &&
        a->color != NULL)
        st = heatmap_gaps(&tmpl->surface, a->point, node->n, transform, gap);
    for (uint32_t v = 0; st == ST_OK && v < node->n; v++) {
        const double x = (double)a->at[v][0] * by, y = (double)a->at[v][1] * by;

        a->gap[v] = (float)gap[v];
        a->rest[v] = between(field->rest_mm, x, y);
        a->part[v] = between(field->part, x, y);
        if (isnan(a->gap[v]) || isnan(a->rest[v]) || isnan(a->part[v])) {
            a->gap[v] = a->rest[v] = a->part[v] = 0.0f;
            memset(a->color[v], 0, sizeof a->color[v]);
        } else {
            paint(a->part[v], a->color[v]);
        }
    }
    mem_free(gap);
    node->color = a->color[0];
    node->scalar[0] = (struct glbwrite_scalar){"_GAP_MM", a->gap};
    node->scalar[1] = (struct glbwrite_scalar){"_REST_MM", a->rest};
    node->scalar[2] = (struct glbwrite_scalar){"_PART", a->part};
    return st;
}

enum status show_comparison(const struct face *tmpl, const struct face *probe,
                            const double transform[16], const struct face_field *field,
                            struct json *j, struct show *out)
{
    const struct pose frame = pose_unscaled(&tmpl->frame.pose);
    struct glbwrite_node node[2];
    struct arrays a[2] = {0};
    enum status st = surface_node(tmpl, NULL, &frame, "template", &a[0], &node[0]);

    *out = (struct show){0};
    if (st == ST_OK)
        st = surface_node(probe, transform, &frame, "probe", &a[1], &node[1]);
    if (st == ST_OK)
        st = differences(tmpl, transform, field, &a[1], &node[1]);
    if (st == ST_OK)
        st = glbwrite(node, 2, j, &out->glb, &out->len);
    else
        json_discard(j);
    arrays_free(&a[0]);
    arrays_free(&a[1]);
    return st;
}

/* Every so many points of a scan, in the frame of the face in it. */
static enum status scan_node(const struct dvec3 *at, size_t n, const double view[16],
                             const struct pose *frame, struct arrays *a,
                             struct glbwrite_node *out)
{
    const size_t step = (n + SHOW_POINTS - 1) / SHOW_POINTS;

    *out = (struct glbwrite_node){.name = "scan"};
    if ((a->at = mem_array(n / step + 1, sizeof *a->at)) == NULL)
        return ST_ENOMEM;
    for (size_t i = 0; i < n; i += step)
        put(a->at[out->n++], frame, moved(view, at[i]));
    out->at = a->at[0];
    return ST_OK;
}

enum status show_scan(const struct face *face, const struct dvec3 *at, size_t n,
                      const double view[16], struct json *j, struct show *out)
{
    static const double same[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    struct pose frame = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    struct glbwrite_node node[2];
    struct arrays a[2] = {0};
    size_t nodes = 0;
    enum status st = ST_OK;

    *out = (struct show){0};
    if (face != NULL) {
        frame = pose_unscaled(&face->frame.pose);
        st = surface_node(face, NULL, &frame, "face", &a[0], &node[nodes++]);
    }
    if (st == ST_OK && n > 0)
        st = scan_node(at, n, face != NULL ? view : same, &frame, &a[1], &node[nodes++]);
    if (st == ST_OK)
        st = glbwrite(node, nodes, j, &out->glb, &out->len);
    else
        json_discard(j);
    arrays_free(&a[0]);
    arrays_free(&a[1]);
    return st;
}
