/* asymmetry: a scan measured against its own mirror image. */
#include <math.h>
#include <stdio.h>

#include "asymmetry.h"
#include "describe.h"
#include "ctl_command.h"
#include "ctl_face.h"
#include "ctl_sample.h"

static void print_asymmetry(const struct asymmetry *a, const struct face *f,
                            const struct scan_found *found)
{
    (void)printf("asymmetry    %.3f mm (%.1f mm3 over %.1f mm2)%s\n", a->final.plain_mm,
                 a->final.volume_mm3, a->final.area_mm2,
                 asymmetry_conclusive(a) ? "" : ", of too little to say");
    (void)printf("weighted     %.3f mm, by the learned weight\n", a->final.weighted_mm);
    (void)printf(
        "first        %.3f mm before the plane was corrected, by %.2f degrees and "
        "%.2f mm\n",
        a->initial.plain_mm, a->moved_deg, a->moved_mm);
    (void)printf("common       %.0f %% of the face lies over its mirror image\n",
                 100 * a->final.overlap);
    (void)printf("plane        %.4f x %+.4f y %+.4f z = %.2f mm, ", a->normal[0],
                 a->normal[1], a->normal[2], a->offset_mm);
    ctl_face_known(stdout, a->turn_deg, a->shift_mm);
    (void)printf("\n");
    ctl_face_scan(stdout, f);
    ctl_sample_warnings(stdout, "warnings", found);
}

static enum status measure(struct ctl *c)
{
    const double start = ctl_clock_ms();
    struct scan_found found;
    struct face f = {0};
    struct asymmetry a;
    enum status st = ctl_sample_read(c, c->args[0], false, c->work, &f, &found);
    const double prepared = ctl_clock_ms();

    if (st == ST_OK && (st = face_asymmetry(&f, c->work, &a)) != ST_OK)
        (void)errinfo_set(&c->e, st, "%s: %s", c->args[0], status_message(st));
    if (st == ST_OK) {
        const double end = ctl_clock_ms();

        describe_scan(c->out, "scan", &found);
        describe_asymmetry(c->out, &a, &f, c->engine,
                           &(struct describe_times){.parse = NAN,
                                                    .prepare = NAN,
                                                    .minimal = end - prepared,
                                                    .total = end - start});
        if (!c->json)
            print_asymmetry(&a, &f, &found);
        c->code = asymmetry_conclusive(&a) ? EXIT_FINE : EXIT_INCONCLUSIVE;
    }
    face_free(&f);
    return st;
}

const struct ctl_command ctl_asymmetry = {
    .name = "asymmetry",
    .args = "FILE",
    .takes = {1, 1},
    .shared = CTL_SCANS | CTL_MODEL,
    .exits = {"done", NULL,
              "inconclusive: too little of the face lies over its mirror image"},
    .run = measure,
    .summary = "measure a scan against its own mirror image",
    .help =
        "The symmetry plane is corrected until the gap between the face and its mirror image is\n"
        "least; that gap is the asymmetry.  Nothing is stored.",
    .example = "surfacectl asymmetry alice.ply"};
