#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "cloudfile.h"
#include "ctl.h"
#include "ctl_face.h"

int ctl_face_exit(enum surface_decision d)
{
    return d == SURFACE_MATCH      ? EXIT_FINE
           : d == SURFACE_NO_MATCH ? EXIT_NO
                                   : EXIT_INCONCLUSIVE;
}

struct templates_context ctl_face_context(struct ctl *c, struct surface_work *w)
{
    return (struct templates_context){
        .store = c->store, .work = w, .clock_ms = command_clock_ms};
}

void ctl_face_passed_over(const struct templates *t)
{
    if (t->passed_over.code != ST_OK)
        (void)fprintf(stderr, "surfacectl: template skipped: %s\n", t->passed_over.msg);
}

void ctl_face_regions(FILE *to, const struct surface_parts *p)
{
    (void)fprintf(to, "regions      part of the score\n");
    for (int i = 0; i < SURFACE_REGIONS; i++) {
        (void)fprintf(to, "  %-10s ", surface_region_name((enum surface_region)i));
        if (isnan(p->region[i]))
            (void)fprintf(to, "not covered\n");
        else
            (void)fprintf(to, "%+8.2f\n", p->region[i]);
    }
}

/* Without the line's end. */
static void known(FILE *to, double turn_deg, double shift_mm)
{
    if (isfinite(turn_deg) && isfinite(shift_mm))
        (void)fprintf(to, "known to %.2f degrees and %.2f mm (one standard deviation)",
                      turn_deg, shift_mm);
    else
        (void)fprintf(to, "its uncertainty is unknown");
}

void ctl_face_score(FILE *to, const struct surface_comparison *r)
{
    double score, threshold;

    surface_shown(r, 100, &score, &threshold);
    (void)fprintf(to,
                  "score        %.2f (a match at %.2f or above)\n"
                  "fmr          %.2g at this score\n",
                  score, threshold, r->false_match_rate);
}

void ctl_face_minimal(FILE *to, const struct surface_disparity *d)
{
    (void)fprintf(
        to,
        "disparity    %.3f mm, minimal (%.1f mm3 over %.1f mm2); %.3f mm by the "
        "learned weight\n",
        d->disparity_mm, d->volume_mm3, d->area_mm2, d->weighted_mm);
}

void ctl_face_scan(FILE *to, const struct surface_face *f)
{
    (void)fprintf(to, "scan         %u points, quality %.2f",
                  surface_face_points(f, NULL), surface_face_quality(f).score);
    ctl_face_reasons(to, f);
}

void ctl_face_alignment(FILE *to, const struct surface_disparity *a)
{
    (void)fprintf(to, "alignment    ");
    known(to, a->turn_deg, a->shift_mm);
    if (isfinite(a->rival_mm))
        (void)fprintf(to, "; mean gap %.2f mm, %.2f mm at the next best", a->cost_mm,
                      a->rival_mm);
    (void)fprintf(to, "\n");
}

void ctl_face_reasons(FILE *to, const struct surface_face *f)
{
    const struct surface_quality q = surface_face_quality(f);
    const uint32_t reasons = surface_quality_reasons(&q, f);
    const char *between = " (";

    for (int i = 0; i < SURFACE_REASONS; i++)
        if (reasons & (1U << i)) {
            (void)fprintf(to, "%s%s", between,
                          surface_reason_name((enum surface_reason)i));
            between = ", ";
        }
    (void)fprintf(to, "%s\n", reasons != 0 ? ")" : "");
}

/* ---- scans */

enum status ctl_face_parse(struct ctl *c, const char *path, struct cloudpoints *out)
{
    const enum status st =
        cloudfile_read_path(path, c->scans.unit_mm, &c->scans.camera, out, &c->e);

    out->axes_given = out->axes_given || c->scans.frontal;
    return st;
}

enum status ctl_face_read(struct ctl *c, const char *path, bool enrolment,
                          struct surface_work *w, struct surface_face **out,
                          struct sample_found *found)
{
    const struct sample_options o = {.enrolment = enrolment};
    struct cloudpoints p;
    enum status st = ctl_face_parse(c, path, &p);

    if (st == ST_OK)
        st = sample_build(path, &p, &o, w, out, found, &c->e);
    cloudpoints_free(&p);
    return st;
}

void ctl_face_warnings(FILE *to, const char *label, const struct sample_found *f)
{
    const uint32_t warnings = f->scan.warnings;
    const char *comma = "";

    if (warnings != 0)
        (void)fprintf(to, "%-12s ", label);
    for (int i = 0; i < SURFACE_WARNINGS; i++)
        if ((warnings >> i & 1) != 0) {
            (void)fprintf(to, "%s%s", comma,
                          surface_warning_name((enum surface_warning)i));
            comma = ", ";
        }
    if (warnings != 0)
        (void)fprintf(to, "\n");
}
