#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "asymmetry.h"
#include "describe.h"
#include "lattice.h"
#include "mem.h"
#include "simplify.h"
#include "ctl.h"
#include "ctl_dir.h"

static void print_asymmetry(const struct asymmetry *a, const struct face *f)
{
    (void)printf("asymmetry    %.3f mm (%.1f mm3 over %.1f mm2)%s\n", a->final.plain_mm,
                 a->final.volume_mm3, a->final.area_mm2,
                 asymmetry_conclusive(a) ? "" : ", of too little to say");
    (void)printf(
        "first        %.3f mm before the plane was corrected, by %.2f degrees and "
        "%.2f mm\n",
        a->initial.plain_mm, a->moved_deg, a->moved_mm);
    (void)printf("common       %.0f %% of the face lies over its mirror image\n",
                 100 * a->final.overlap);
    (void)printf("plane        %.4f x %+.4f y %+.4f z = %.2f mm, ", a->normal[0],
                 a->normal[1], a->normal[2], a->offset_mm);
    if (isfinite(a->turn_deg))
        (void)printf("known to %.2f degrees and %.2f mm (one standard deviation)\n",
                     a->turn_deg, a->shift_mm);
    else
        (void)printf("how well it is known cannot be told\n");
    (void)printf("scan         %u points, quality %.2f", f->surface.mesh.nv,
                 f->quality.score);
    ctl_face_reasons(stdout, f);
}

int ctl_shape_asymmetry(struct ctl *c)
{
    struct face_work *w = face_work_new(c->model);
    struct face f = {0};
    struct asymmetry a;
    enum status st;

    if (w == NULL)
        st = errinfo_set(&c->e, ST_ENOMEM, "out of memory");
    else if ((st = ctl_scan_read(c, c->args[0], w, &f)) == ST_OK &&
             (st = face_asymmetry(&f, w, &a)) != ST_OK)
        (void)errinfo_set(&c->e, st, "%s: %s", c->args[0], status_message(st));
    if (st == ST_OK) {
        describe_asymmetry(ctl_out_document(c->out), &a, &f, c->engine, NULL);
        if (!c->json)
            print_asymmetry(&a, &f);
    }
    face_free(&f);
    face_work_free(w);
    if (st != ST_OK)
        return ctl_fail(c, st);
    return asymmetry_conclusive(&a) ? EXIT_FINE : EXIT_INCONCLUSIVE;
}

static void tell_simplified(struct ctl *c, const struct face *f,
                            const struct simplify_result *r)
{
    const double share = (double)r->kept / f->surface.mesh.nv;

    ctl_out_text(c->out, "file", c->dir);
    ctl_out_number(c->out, "points", f->surface.mesh.nv);
    ctl_out_number(c->out, "kept", r->kept);
    ctl_out_number(c->out, "share", share);
    ctl_out_number(c->out, "error_mm", r->error / LATTICE_PER_MM);
    ctl_out_number(c->out, "disparity_mm", r->disparity / LATTICE_PER_MM);
    if (!c->json)
        (void)printf("kept         %u of %u points, %.1f %%\n"
                     "error        %.3f mm at most at one of the scan's points\n"
                     "disparity    %.4f mm in the mean\n"
                     "file         %s\n",
                     r->kept, f->surface.mesh.nv, 100 * share, r->error / LATTICE_PER_MM,
                     r->disparity / LATTICE_PER_MM, c->dir);
}

int ctl_shape_simplify(struct ctl *c)
{
    const double tolerance = c->tolerance_mm * LATTICE_PER_MM;
    const struct simplify_limit limit = {c->mean ? (double)INFINITY : tolerance,
                                         c->mean ? tolerance : (double)INFINITY, 0};
    struct face_work *w = face_work_new(c->model);
    struct simplify_result r;
    struct scratch scratch = {0};
    struct mesh small = {0};
    struct face f = {0};
    enum status st;
    int code = EXIT_FINE;

    if (w == NULL)
        st = errinfo_set(&c->e, ST_ENOMEM, "out of memory");
    else if (c->tolerance_mm <= 0 || c->dir == NULL) {
        st =
            errinfo_set(&c->e, ST_EINVAL, "simplify needs --tolerance MM and --out FILE");
        code = EXIT_USAGE;
    } else if ((st = ctl_scan_read(c, c->args[0], w, &f)) == ST_OK &&
               (st = simplify_mesh(&f.surface.mesh, f.surface.bridge, &limit, &scratch,
                                   &small, NULL, &r)) != ST_OK)
        (void)errinfo_set(&c->e, st, "%s: %s", c->args[0], status_message(st));
    if (st == ST_OK && (st = ctl_dir_mesh(c->dir, &small, &c->e)) == ST_OK)
        tell_simplified(c, &f, &r);
    if (st != ST_OK && code == EXIT_FINE)
        code = ctl_fail(c, st);
    mesh_free(&small);
    scratch_free(&scratch);
    face_free(&f);
    face_work_free(w);
    return code;
}
