#include "face_data.h"

#include <string.h>

#include "heatmap.h"
#include "lattice.h"
#include "mesh.h"
#include "mst.h"
#include "quality.h"

const char *surface_reason_name(enum surface_reason reason)
{
    static const char *const name[SURFACE_REASONS] = {[SURFACE_SPARSE] = "sparse",
                                                      [SURFACE_NOISY] = "noisy",
                                                      [SURFACE_INCOMPLETE] = "incomplete",
                                                      [SURFACE_OBLIQUE] = "turned"};

    return (unsigned)reason < SURFACE_REASONS ? name[reason] : NULL;
}

uint32_t surface_quality_reasons(const struct surface_quality *q,
                                 const struct surface_face *face)
{
    return quality_reasons(q, face != NULL ? &face->frame : NULL);
}

struct surface_quality surface_face_quality(const struct surface_face *face)
{
    return face->quality;
}

void surface_face_rate(struct surface_face *face, const struct surface_quality *q)
{
    face->quality = *q;
}

uint32_t surface_face_points(const struct surface_face *face, double (*out)[3])
{
    const struct mesh *m = &face->surface.mesh;

    for (uint32_t v = 0; out != NULL && v < m->nv; v++) {
        const struct dvec3 p = lattice_to_mm(m->xy[v], m->z[v]);

        memcpy(out[v], &p, sizeof p);
    }
    return m->nv;
}

uint32_t surface_face_triangles(const struct surface_face *face, uint32_t (*out)[3])
{
    const struct mesh *m = &face->surface.mesh;

    for (uint32_t t = 0, n = 0; out != NULL && t < m->nt; t++)
        if (!mesh_is_ghost(m, t))
            memcpy(out[n++], &m->org[3 * t], sizeof *out);
    return mesh_real(m);
}

uint32_t surface_face_measured(const struct surface_face *face, uint32_t (*out)[3])
{
    const struct surface *s = &face->surface;
    uint32_t n = 0;

    for (uint32_t t = 0; t < s->mesh.nt; t++)
        if (s->bridge[t] == 0) { /* nor a ghost */
            if (out != NULL)
                memcpy(out[n], &s->mesh.org[3 * t], sizeof *out);
            n++;
        }
    return n;
}

void surface_face_frame(const struct surface_face *face, double transform[16])
{
    const struct pose rigid = pose_unscaled(&face->frame.pose);

    pose_to_matrix(&rigid, transform);
}

enum surface_status surface_face_check(const struct surface_face *face)
{
    const struct mesh *m = &face->surface.mesh;

    return status_to(mesh_check(m, true) == ST_OK ? mst_check(m) : ST_ECORRUPT);
}

enum surface_status surface_gaps(const struct surface_face *tmpl,
                                 const double (*points)[3], size_t n,
                                 const double transform[16], double *gap_mm)
{
    return status_to(
        heatmap_gaps(&tmpl->surface, (const struct dvec3 *)points, n, transform, gap_mm));
}
