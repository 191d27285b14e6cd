/* asymmetry: a scan measured against its own mirror image. */
#include <math.h>
#include <stdio.h>

#include "lab.h"
#include "show.h"

static void print_asymmetry(const struct surface_asymmetry *a,
                            const struct surface_face *f)
{
    (void)printf("asymmetry    %.3f mm (%.1f mm3 over %.1f mm2)%s\n", a->disparity_mm,
                 a->volume_mm3, a->area_mm2,
                 a->conclusive ? "" : ", but too little was measured to decide");
    (void)printf("weighted     %.3f mm, by the learned weight\n", a->weighted_mm);
    (void)printf(
        "first        %.3f mm before the plane was corrected, by %.2f degrees and "
        "%.2f mm\n",
        a->first_mm, a->moved_deg, a->moved_mm);
    (void)printf("common       %.0f %% of the face lies over its mirror image\n",
                 100 * a->overlap);
    (void)printf("plane        %.4f x %+.4f y %+.4f z = %.2f mm, ", a->normal[0],
                 a->normal[1], a->normal[2], a->offset_mm);
    if (isfinite(a->turn_deg) && isfinite(a->shift_mm))
        (void)printf("known to %.2f degrees and %.2f mm (one standard deviation)\n",
                     a->turn_deg, a->shift_mm);
    else
        (void)printf("its uncertainty is unknown\n");
    (void)printf("scan         %u points, quality %.2f\n", f->surface.mesh.nv,
                 f->quality.score);
}

static void report_asymmetry(struct json *j, const struct surface_asymmetry *a,
                             const struct surface_face *f, const char *engine)
{
    show_asymmetry(j, a);
    json_number(j, "quality", f->quality.score);
    json_text(j, "engine", engine);
}

enum status lab_asymmetry(struct lab *c)
{
    struct surface_found found;
    struct surface_face f = {0};
    struct surface_asymmetry a;
    enum status st = lab_scan_read(c, c->args[0], &f, &found);

    if (st == ST_OK && (st = status_from(surface_asymmetry(c->work, &f, &a))) != ST_OK)
        (void)errinfo_set(&c->e, st, "%s: %s", c->args[0], status_message(st));
    if (st == ST_OK) {
        report_asymmetry(c->report, &a, &f, c->engine);
        if (!c->json)
            print_asymmetry(&a, &f);
        c->code = a.conclusive ? EXIT_FINE : EXIT_INCONCLUSIVE;
    }
    face_free(&f);
    return st;
}
