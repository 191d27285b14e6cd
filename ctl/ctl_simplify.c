/* simplify: the points that a scan's surface needs. */
#include <math.h>
#include <stdio.h>

#include "lattice.h"
#include "mem.h"
#include "simplify.h"
#include "ctl_command.h"
#include "ctl_dir.h"
#include "ctl_sample.h"

static double tolerance_mm; /* --tolerance */
static bool mean;           /* --mean */

static void tell_simplified(struct ctl *c, const struct face *f,
                            const struct simplify_result *r)
{
    const double share = (double)r->kept / f->surface.mesh.nv;

    json_text(c->out, "file", c->dir);
    json_number(c->out, "points", f->surface.mesh.nv);
    json_number(c->out, "kept", r->kept);
    json_number(c->out, "share", share);
    json_number(c->out, "error_mm", r->error / LATTICE_PER_MM);
    json_number(c->out, "plain_mm", r->disparity / LATTICE_PER_MM);
    ctl_say(c,
            "kept         %u of %u points, %.1f %%\n"
            "error        %.3f mm at most at one of the scan's points\n"
            "disparity    %.4f mm in the mean\n"
            "file         %s\n",
            r->kept, f->surface.mesh.nv, 100 * share, r->error / LATTICE_PER_MM,
            r->disparity / LATTICE_PER_MM, c->dir);
}

static enum status run(struct ctl *c)
{
    const double tolerance = tolerance_mm * LATTICE_PER_MM;
    const struct simplify_limit limit = {mean ? (double)INFINITY : tolerance,
                                         mean ? tolerance : (double)INFINITY, 0};
    struct simplify_result r;
    struct scratch scratch = {0};
    struct mesh small = {0};
    struct scan_found found;
    struct face f = {0};
    enum status st;

    if (!(tolerance_mm > 0) || c->dir == NULL)
        return ctl_usage(c, "simplify needs --tolerance MM and --out FILE");
    if ((st = ctl_dir_may_pipe(c, 1)) != ST_OK)
        return st;
    if ((st = ctl_sample_read(c, c->args[0], false, c->work, &f, &found)) == ST_OK &&
        (st = simplify_mesh(&f.surface.mesh, f.surface.bridge, &limit, &scratch, &small,
                            NULL, &r)) != ST_OK)
        (void)errinfo_set(&c->e, st, "%s: %s", c->args[0], status_message(st));
    if (st == ST_OK && (st = ctl_dir_mesh(c, c->dir, &small)) == ST_OK)
        tell_simplified(c, &f, &r);
    mesh_free(&small);
    scratch_free(&scratch);
    face_free(&f);
    return st;
}

const struct ctl_command ctl_simplify = {
    .name = "simplify",
    .args = "FILE",
    .takes = {1, 1},
    .shared = CTL_SCANS | CTL_MODEL | CTL_OUT | CTL_FORCE,
    .options = {CTL_OPTION("tolerance", "MM", ctl_option_mm, &tolerance_mm,
                           "the largest gap that may open; required"),
                CTL_OPTION("mean", NULL, ctl_option_flag, &mean,
                           "the tolerance is for the mean gap over the area")},
    .run = run,
    .summary = "keep the points that a scan's surface needs",
    .help =
        "Points are removed one by one, the least needed first, as long as the surface of the\n"
        "others stays within --tolerance of the scan's at each of its points.  The points that\n"
        "remain are written with their triangles to the file --out (PLY; -: standard output).\n"
        "Spikes are flattened first.",
    .example = "surfacectl simplify alice.ply --tolerance 0.3 --out small.ply"};
