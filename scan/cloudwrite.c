#include "cloudwrite.h"

#include "lattice.h"
#include "mesh.h"

enum status cloudwrite_ply(FILE *to, const void *arg, struct errinfo *e)
{
    const struct mesh *m = arg;

    (void)e;
    (void)fprintf(
        to,
        "ply\nformat ascii 1.0\ncomment mm\nelement vertex %u\n"
        "property float x\nproperty float y\nproperty float z\n"
        "element face %u\nproperty list uchar uint vertex_indices\nend_header\n",
        m->nv, mesh_real(m));
    for (uint32_t v = 0; v < m->nv; v++)
        (void)fprintf(to, "%.3f %.3f %.3f\n", m->xy[v].x / LATTICE_PER_MM,
                      m->xy[v].y / LATTICE_PER_MM, m->z[v] / LATTICE_PER_MM);
    for (uint32_t t = 0; t < m->nt; t++)
        if (!mesh_is_ghost(m, t))
            (void)fprintf(to, "3 %u %u %u\n", m->org[3 * t], m->org[3 * t + 1],
                          m->org[3 * t + 2]);
    return ST_OK;
}
