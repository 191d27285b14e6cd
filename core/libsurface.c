/* libsurface.c -- the library's public functions, over face.h.  Names follow the header as it
 * is installed: surface_*. */
#include "libsurface.h"

#include <math.h>

#include <string.h>

#include "face.h"
#include "mem.h"
#include "minimal.h"
#include "mesh.h"
#include "status.h"

_Static_assert(SURFACE_MIN_POINTS == FACE_MIN_POINTS, "as face.h");
_Static_assert(SURFACE_MAX_POINTS == MESH_MAX_POINTS, "as mesh.h");
_Static_assert(SURFACE_ENGINE_SIZE == FACE_ENGINE_MAX + 1, "as face.h");

struct surface_work {
    struct face_work *face;
    struct scratch points;
};

struct surface_face {
    struct face face;
};

static const enum status internal[SURFACE_STATUSES] = {
    [SURFACE_OK] = ST_OK,
    [SURFACE_ENOMEM] = ST_ENOMEM,
    [SURFACE_ELIMIT] = ST_ELIMIT,
    [SURFACE_ETOOFEW] = ST_ETOOFEW,
    [SURFACE_ENOTFINITE] = ST_ENOTFINITE,
    [SURFACE_ERANGE] = ST_ERANGE,
    [SURFACE_EDEGENERATE] = ST_EDEGENERATE,
    [SURFACE_EUNITS] = ST_EUNITS,
    [SURFACE_ENOTFACE] = ST_ENOTFACE,
    [SURFACE_EQUALITY] = ST_EQUALITY,
};

/* What face_build() and face_compare() return has a public status each. */
static enum surface_status public(enum status st) {
    enum surface_status s = SURFACE_OK;

    while (s < SURFACE_STATUSES - 1 && internal[s] != st) s++;
    return s;
}

const char *surface_message(enum surface_status st)
{
    return status_message((unsigned)st < SURFACE_STATUSES ? internal[st] : ST_COUNT);
}

void surface_engine(char out[SURFACE_ENGINE_SIZE])
{
    face_engine(NULL, out);
}

struct surface_work *surface_work_new(void)
{
    struct surface_work *work = mem_array(1, sizeof *work);

    if (work == NULL)
        return NULL;
    memset(work, 0, sizeof *work);
    if ((work->face = face_work_new(NULL)) == NULL) {
        mem_free(work);
        return NULL;
    }
    return work;
}

void surface_work_free(struct surface_work *work)
{
    if (work == NULL)
        return;
    face_work_free(work->face);
    scratch_free(&work->points);
    mem_free(work);
}

enum surface_status surface_face_new(struct surface_work *work, const double (*points)[3],
                                     size_t n, struct surface_face **out, size_t *bad)
{
    struct surface_face *face;
    struct dvec3 *pts;
    enum status st;

    *out = NULL;
    if (n > SURFACE_MAX_POINTS)
        return SURFACE_ELIMIT;
    pts = scratch_need(&work->points, n * sizeof *pts);
    face = mem_array(1, sizeof *face);
    if (pts == NULL || face == NULL) {
        mem_free(face);
        return SURFACE_ENOMEM;
    }
    for (size_t i = 0; i < n; i++)
        pts[i] = (struct dvec3){points[i][0], points[i][1], points[i][2]};
    memset(face, 0, sizeof *face);
    if ((st = face_build(pts, n, work->face, &face->face, bad)) == ST_OK)
        *out = face;
    else
        surface_face_free(face);
    return public(st);
}

void surface_face_free(struct surface_face *face)
{
    if (face == NULL)
        return;
    face_free(&face->face);
    mem_free(face);
}

void surface_face_quality(const struct surface_face *face, struct surface_quality *out)
{
    const struct quality *q = &face->face.quality;

    *out = (struct surface_quality){face->face.surface.mesh.nv, q->score, q->coverage,
                                    q->density_mm, q->noise_mm};
}

enum surface_status surface_compare(struct surface_work *work,
                                    const struct surface_face *tmpl,
                                    const struct surface_face *probe,
                                    struct surface_comparison *out)
{
    static const enum surface_decision decision[] = {
        [FACE_MATCH] = SURFACE_MATCH,
        [FACE_NO_MATCH] = SURFACE_NO_MATCH,
        [FACE_INCONCLUSIVE] = SURFACE_INCONCLUSIVE,
    };
    struct face_result r;
    struct minimal m;
    enum status st =
        face_compare(&tmpl->face, &probe->face, (double)NAN, NULL, work->face, &r);

    if (st == ST_OK)
        st = face_minimal(&tmpl->face, &probe->face, NULL, work->face, &r, &m);
    *out = (struct surface_comparison){.decision = SURFACE_INCONCLUSIVE};
    if (st != ST_OK)
        return public(st);
    out->decision = decision[r.decision];
    out->score = r.score;
    out->threshold = r.threshold;
    out->false_match_rate = r.fmr_at_score;
    out->overlap = r.overlap;
    memcpy(out->transform, r.align.transform, sizeof out->transform);
    memcpy(out->minimal_transform, m.transform, sizeof out->minimal_transform);
    out->disparity_mm = m.disparity.plain_mm;
    out->volume_mm3 = m.disparity.volume_mm3;
    out->area_mm2 = m.disparity.area_mm2;
    return SURFACE_OK;
}
