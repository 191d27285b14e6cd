#include "show.h"

#include <math.h>
#include <string.h>

#include "glbwrite.h"
#include "json.h"
#include "libsurface.h"
#include "mem.h"
#include "vec.h"

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
    double (*point)[3]; /* in the frontal view of their own scan */
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

/* To 1/256, of a mm or of a part of the score, which no scanner resolves and no picture shows, so
 * that the file packs well. */
static float coarse(double v)
{
    return (float)(nearbyint(256 * v) / 256);
}

/* Moved by m into a face's frame; NULL: as it is. */
static void show_put(float to[3], const double m[16], const double p[3])
{
    for (int i = 0; i < 3; i++)
        to[i] = m == NULL ? (float)p[i]
                          : coarse(m[4 * i] * p[0] + m[4 * i + 1] * p[1] +
                                   m[4 * i + 2] * p[2] + m[4 * i + 3]);
}

/* The surface of f, moved by m. */
static enum status surface_node(const struct surface_face *f, const double m[16],
                                const char *name, struct arrays *a,
                                struct glbwrite_node *out)
{
    const uint32_t n = surface_face_points(f, NULL);
    const uint32_t triangles = surface_face_measured(f, NULL);

    a->at = mem_array(n, sizeof *a->at);
    a->point = mem_array(n, sizeof *a->point);
    a->triangle = mem_array(triangles + 1, sizeof *a->triangle);
    if (a->at == NULL || a->point == NULL || a->triangle == NULL)
        return ST_ENOMEM;
    (void)surface_face_points(f, a->point);
    (void)surface_face_measured(f, a->triangle);
    for (uint32_t v = 0; v < n; v++)
        show_put(a->at[v], m, a->point[v]);
    *out = (struct glbwrite_node){.name = name,
                                  .at = a->at[0],
                                  .n = n,
                                  .triangle = a->triangle[0],
                                  .triangles = triangles};
    return ST_OK;
}

float show_between(const float cell[SURFACE_CELLS], double x, double y)
{
    const double i = (x - SURFACE_CELLS_LEFT) / SURFACE_CELL_MM;
    const double j = (y - SURFACE_CELLS_BOTTOM) / SURFACE_CELL_MM;
    const int i0 = (int)floor(i - 0.5), j0 = (int)floor(j - 0.5);
    double sum = 0, weight = 0;

    if (!(i >= 0 && i < SURFACE_CELLS_X && j >= 0 && j < SURFACE_CELLS_Y) ||
        isnan(cell[(int)j * SURFACE_CELLS_X + (int)i]))
        return (float)NAN;
    for (int k = 0; k < 4; k++) {
        const int u = i0 + k % 2, v = j0 + k / 2;
        const double w = (1 - fabs(i - 0.5 - u)) * (1 - fabs(j - 0.5 - v));

        if (u < 0 || u >= SURFACE_CELLS_X || v < 0 || v >= SURFACE_CELLS_Y ||
            isnan(cell[v * SURFACE_CELLS_X + u]))
            continue;
        sum += w * (double)cell[v * SURFACE_CELLS_X + u];
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
static enum status differences(const struct surface_face *tmpl,
                               const double transform[16],
                               const struct surface_parts *parts, struct arrays *a,
                               struct glbwrite_node *node)
{
    double *gap = mem_array(node->n, sizeof *gap);
    enum status st = ST_ENOMEM;

    a->gap = mem_array(node->n, sizeof *a->gap);
    a->rest = mem_array(node->n, sizeof *a->rest);
    a->part = mem_array(node->n, sizeof *a->part);
    a->color = mem_array(node->n, sizeof *a->color);
    if (gap != NULL && a->gap != NULL && a->rest != NULL && a->part != NULL &&
        a->color != NULL)
        st = status_from(
            surface_gaps(tmpl, (const double(*)[3])a->point, node->n, transform, gap));
    for (uint32_t v = 0; st == ST_OK && v < node->n; v++) {
        const double x = (double)a->at[v][0] * parts->scale,
                     y = (double)a->at[v][1] * parts->scale;

        a->gap[v] = coarse(gap[v]);
        a->rest[v] = coarse((double)show_between(parts->rest_mm, x, y));
        a->part[v] = coarse((double)show_between(parts->part, x, y));
        if (isnan(a->gap[v]) || isnan(a->rest[v]) || isnan(a->part[v])) {
            a->gap[v] = a->rest[v] = a->part[v] = 0.0f;
            memset(a->color[v], 0, sizeof a->color[v]);
        } else {
            paint(a->part[v], a->color[v]);
        }
    }
    mem_free(gap);
    if (st != ST_OK)
        return st;
    node->color = a->color[0];
    node->scalar[0] = (struct glbwrite_scalar){"_GAP_MM", a->gap};
    node->scalar[1] = (struct glbwrite_scalar){"_REST_MM", a->rest};
    node->scalar[2] = (struct glbwrite_scalar){"_PART", a->part};
    return ST_OK;
}

void show_knots(struct json *j, const char *name, const struct surface_calibration *c)
{
    json_array(j, name);
    for (uint32_t i = 0; i < c->n; i++) {
        json_object(j, NULL);
        json_score(j, "score", c->knot[i].score);
        json_rate(j, "rate", c->knot[i].rate);
        json_close(j);
    }
    json_close(j);
}

void show_calibration(struct json *j, const struct surface_calibration *c)
{
    json_number(j, "threshold", c->threshold);
    show_knots(j, "knots", c);
}

enum status show_comparison(const struct surface_face *tmpl,
                            const struct surface_face *probe, const double transform[16],
                            const struct surface_parts *parts, struct json *j,
                            struct show *out)
{
    struct glbwrite_node node[2];
    struct arrays a[2] = {0};
    double both[16];
    enum status st = surface_node(tmpl, parts->frame, "template", &a[0], &node[0]);

    *out = (struct show){0};
    vec_after(parts->frame, transform, both);
    if (st == ST_OK)
        st = surface_node(probe, both, "probe", &a[1], &node[1]);
    if (st == ST_OK)
        st = differences(tmpl, transform, parts, &a[1], &node[1]);
    if (st == ST_OK)
        st = glbwrite(node, 2, j, &out->glb, &out->len);
    else
        json_discard(j);
    arrays_free(&a[0]);
    arrays_free(&a[1]);
    return st;
}

/* An even choice of a scan's points, moved by m. */
static enum status scan_node(const struct dvec3 *at, size_t n, size_t most,
                             const double m[16], struct arrays *a,
                             struct glbwrite_node *out)
{
    const size_t step = (n + most - 1) / most;

    *out = (struct glbwrite_node){.name = "scan"};
    if ((a->at = mem_array(n / step + 1, sizeof *a->at)) == NULL)
        return ST_ENOMEM;
    for (size_t i = 0; i < n; i += step)
        show_put(a->at[out->n++], m, (const double[]){at[i].x, at[i].y, at[i].z});
    out->at = a->at[0];
    return ST_OK;
}

enum status show_scan(const struct surface_face *face, const struct dvec3 *at, size_t n,
                      size_t most, const double view[16], struct json *j,
                      struct show *out)
{
    struct glbwrite_node node[2];
    struct arrays a[2] = {0};
    double frame[16], both[16];
    size_t nodes = 0;
    enum status st = ST_OK;

    *out = (struct show){0};
    if (face != NULL) {
        surface_face_frame(face, frame);
        st = surface_node(face, frame, "face", &a[0], &node[nodes++]);
    }
    if (st == ST_OK && n > 0) {
        if (face != NULL)
            vec_after(frame, view, both);
        st = scan_node(at, n, most, face != NULL ? both : NULL, &a[1], &node[nodes++]);
    }
    if (st == ST_OK)
        st = glbwrite(node, nodes, j, &out->glb, &out->len);
    else
        json_discard(j);
    arrays_free(&a[0]);
    arrays_free(&a[1]);
    return st;
}

void show_asymmetry(struct json *j, const struct surface_asymmetry *a)
{
    json_flag(j, "conclusive", a->conclusive != 0);
    json_number(j, "plain_mm", a->disparity_mm);
    json_number(j, "weighted_mm", a->weighted_mm);
    json_number(j, "first_mm", a->first_mm);
    json_extent(j, "volume_mm3", a->volume_mm3);
    json_extent(j, "overlap_mm2", a->area_mm2);
    json_number(j, "overlap", a->overlap);
    json_object(j, "plane");
    json_direction(j, "normal", a->normal);
    json_number(j, "offset_mm", a->offset_mm);
    json_number(j, "moved_deg", a->moved_deg);
    json_number(j, "moved_mm", a->moved_mm);
    json_number(j, "evaluations", a->evaluations);
    json_text(j, "stop", a->stop);
    json_number(j, "turn_deg", a->turn_deg);
    json_number(j, "shift_mm", a->shift_mm);
    json_close(j);
}
