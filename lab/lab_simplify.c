/* simplify: the points that a scan's surface needs. */
#include <math.h>
#include <stdio.h>

#include "cloudwrite.h"
#include "lab.h"
#include "lattice.h"
#include "mem.h"
#include "simplify.h"

static void print_simplified(struct lab *c, const struct surface_face *f,
                             const struct simplify_result *r)
{
    const double share = (double)r->kept / f->surface.mesh.nv;

    json_text(c->report, "file", c->out);
    json_number(c->report, "points", f->surface.mesh.nv);
    json_number(c->report, "kept", r->kept);
    json_number(c->report, "share", share);
    json_number(c->report, "error_mm", r->error / LATTICE_PER_MM);
    json_number(c->report, "plain_mm", r->disparity / LATTICE_PER_MM);
    lab_say(c,
            "kept         %u of %u points, %.1f %%\n"
            "error        %.3f mm at most at one of the scan's points\n"
            "disparity    %.4f mm in the mean\n"
            "file         %s\n",
            r->kept, f->surface.mesh.nv, 100 * share, r->error / LATTICE_PER_MM,
            r->disparity / LATTICE_PER_MM, c->out);
}

enum status lab_simplify(struct lab *c)
{
    const double tolerance = c->tolerance_mm * LATTICE_PER_MM;
    const struct simplify_limit limit = {c->mean ? (double)INFINITY : tolerance,
                                         c->mean ? tolerance : (double)INFINITY, 0};
    struct simplify_result r;
    struct scratch scratch = {0};
    struct mesh small = {0};
    struct surface_found found;
    struct surface_face f = {0};
    enum status st;

    if (!(c->tolerance_mm > 0) || c->out == NULL)
        return lab_usage(c, "simplify needs --tolerance MM and --out FILE");
    if ((st = lab_may_pipe(c)) != ST_OK)
        return st;
    if ((st = lab_scan_read(c, c->args[0], &f, &found)) == ST_OK &&
        (st = simplify_mesh(&f.surface.mesh, f.surface.bridge, &limit, &scratch, &small,
                            NULL, &r)) != ST_OK)
        (void)errinfo_set(&c->e, st, "%s: %s", c->args[0], status_message(st));
    if (st == ST_OK &&
        (st = lab_write(c, c->out, cloudwrite_ply,
                        &(struct surface_face){.surface = {.mesh = small}})) == ST_OK)
        print_simplified(c, &f, &r);
    mesh_free(&small);
    scratch_free(&scratch);
    face_free(&f);
    return st;
}
