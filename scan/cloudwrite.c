#include "cloudwrite.h"

#include <stdbool.h>

#include "errinfo.h"
#include "libsurface.h"
#include "mem.h"

enum status cloudwrite_ply(FILE *to, const void *arg, struct errinfo *e)
{
    const struct surface_face *f = arg;
    const uint32_t n = surface_face_points(f, NULL), nt = surface_face_triangles(f, NULL);
    double(*at)[3] = mem_array(n, sizeof *at);
    uint32_t(*corner)[3] = mem_array(nt, sizeof *corner);
    const bool fits = at != NULL && corner != NULL;

    if (fits) {
        (void)surface_face_points(f, at);
        (void)surface_face_triangles(f, corner);
        (void)fprintf(
            to,
            "ply\nformat ascii 1.0\ncomment mm\nelement vertex %u\n"
            "property float x\nproperty float y\nproperty float z\n"
            "element face %u\nproperty list uchar uint vertex_indices\nend_header\n",
            n, nt);
    }
    for (uint32_t v = 0; fits && v < n; v++)
        (void)fprintf(to, "%.3f %.3f %.3f\n", at[v][0], at[v][1], at[v][2]);
    for (uint32_t t = 0; fits && t < nt; t++)
        (void)fprintf(to, "3 %u %u %u\n", corner[t][0], corner[t][1], corner[t][2]);
    mem_free(at);
    mem_free(corner);
    return fits ? ST_OK : errinfo_set(e, ST_ENOMEM, "no memory for the file");
}
