/* surfacelab explain: where two scans differ, and what each place adds to the score. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "heatmap.h"
#include "lab.h"
#include "mem.h"
#include "page.h"
#include "show.h"

struct explanation {
    const char *a, *b, *engine;
    const struct surface_calibration *calibration; /* whose decided */
    struct surface_face tmpl, probe;
    struct surface_comparison result;
    struct surface_disparity minimal;
    struct surface_parts field;
    struct dvec3 *pts; /* [n] of the probe, mm */
    double *gap;       /* [n] there, as measured; NAN: nothing to compare */
    size_t n;
};

/* ---- the files */

static void field(FILE *to, double value)
{
    if (isnan(value))
        (void)fputc(',', to);
    else
        (void)fprintf(to, ",%.4f", value);
}

/* points.csv: the probe's points moved onto the template, the gap there, the part. */
static enum status write_points(FILE *to, const void *arg, struct errinfo *e)
{
    const struct explanation *x = arg;

    (void)e;
    (void)fprintf(to, "x,y,z,gap_mm,part\n");
    for (size_t i = 0; i < x->n; i++) {
        const struct dvec3 p = vec_transform(x->minimal.align_transform, x->pts[i]);
        const struct dvec3 q = vec_along((struct dvec3){0, 0, 0}, x->field.scale,
                                         vec_transform(x->field.frame, p));

        (void)fprintf(to, "%.3f,%.3f,%.3f", p.x, p.y, p.z);
        field(to, x->gap[i]);
        field(to, isnan(x->gap[i]) ? (double)NAN
                                   : (double)show_between(x->field.part, q.x, q.y));
        (void)fputc('\n', to);
    }
    return ST_OK;
}

/* cells.csv: the gap of each cell, each face in its own frame, and what it adds to the score. */
static enum status write_cells(FILE *to, const void *arg, struct errinfo *e)
{
    const struct explanation *x = arg;

    (void)e;
    (void)fprintf(to, "x,y,gap_mm,part\n");
    for (uint32_t i = 0; i < GRID_N; i++) {
        if (isnan(x->field.gap_mm[i]) && isnan(x->field.part[i]))
            continue;
        (void)fprintf(to, "%.2f,%.2f", grid_x(i), grid_y(i));
        field(to, (double)x->field.gap_mm[i]);
        field(to, (double)x->field.part[i]);
        (void)fputc('\n', to);
    }
    return ST_OK;
}

/* As the daemon's response to a comparison has it. */
static void comparison(struct json *j, const struct explanation *x)
{
    const struct surface_disparity *d = &x->minimal;
    double score, threshold;

    surface_shown(&x->result, 100, &score, &threshold);
    json_text(j, "engine", x->engine);
    json_text(j, "decision", lab_decision(x->result.decision));
    json_score(j, "score", score);
    json_score(j, "threshold", threshold);
    json_score(j, "expected", x->result.expected);
    json_rate(j, "fmr_at_score", x->result.false_match_rate);
    json_number(j, "overlap", x->result.overlap);
    json_number(j, "disparity_mm", d->disparity_mm);
    json_object(j, "minimal");
    json_extent(j, "volume_mm3", d->volume_mm3);
    json_extent(j, "overlap_mm2", d->area_mm2);
    json_close(j);
    json_object(j, "alignment");
    json_transform(j, "transform", d->align_transform);
    json_close(j);
    json_object(j, "regions");
    for (int i = 0; i < SURFACE_REGIONS; i++)
        json_score(j, surface_region_name((enum surface_region)i), x->field.region[i]);
    json_close(j);
}

static enum status write_json(FILE *to, const void *arg, struct errinfo *e)
{
    const struct explanation *x = arg;
    struct json *j = json_new();
    char *text;
    bool ok;

    json_text(j, "template", x->a);
    json_text(j, "probe", x->b);
    comparison(j, x);
    text = json_pretty(j);
    ok = text != NULL && fprintf(to, "%s\n", text) >= 0;
    free(text);
    return ok ? ST_OK : errinfo_set(e, ST_ENOMEM, "explain.json: out of memory");
}

static enum status lab_explain_write_page(FILE *to, const void *arg, struct errinfo *e)
{
    const struct explanation *x = arg;
    struct json *j = json_new();
    struct show show;
    enum status st;

    json_object(j, "extras");
    comparison(j, x);
    json_object(j, "calibration");
    show_calibration(j, x->calibration);
    json_close(j);
    page_file(j, "a", x->a, surface_face_quality(&x->tmpl).score);
    page_file(j, "b", x->b, surface_face_quality(&x->probe).score);
    page_made(j);
    json_close(j);
    st = show_comparison(&x->tmpl, &x->probe, x->minimal.align_transform, &x->field, j,
                         &show);
    st = st == ST_OK ? page_write(to, &show, e)
                     : errinfo_set(e, st, "explain.html: %s", status_message(st));
    free(show.glb);
    return st;
}

static const struct {
    const char *name;
    newfile_writer *write;
} file[] = {{"explain.html", lab_explain_write_page},
            {"explain.json", write_json},
            {"points.csv", write_points},
            {"cells.csv", write_cells}};
#define FILES (sizeof file / sizeof *file)

/* ---- the command */

static enum status lab_explain_compare(struct lab *c, struct explanation *x)
{
    struct surface_work *w = c->work;
    struct surface_found found;
    struct cloudpoints p;
    enum status st = lab_scan_read(c, x->a, &x->tmpl, &found);

    if (st != ST_OK)
        return st;
    st = lab_scan_parse(c, x->b, &p, &c->e);
    if (st == ST_OK)
        st = lab_scan_build(c, x->b, &p, false, w, &x->probe, &found, &c->e);
    x->pts = p.at;
    x->n = p.n;
    p.at = NULL; /* x owns them */
    cloudpoints_free(&p);
    if (st != ST_OK)
        return st;
    if ((x->gap = mem_array(x->n, sizeof *x->gap)) == NULL)
        return errinfo_memory(&c->e);
    st = status_from(surface_compare(w, &x->tmpl, &x->probe, &x->result));
    if (st == ST_OK)
        st = status_from(surface_disparity(w, &x->tmpl, &x->probe, &x->minimal));
    if (st == ST_OK)
        st = status_from(surface_parts(w, &x->tmpl, &x->probe, &x->field));
    if (st == ST_OK)
        st = heatmap_gaps(&x->tmpl.surface, x->pts, x->n, x->minimal.align_transform,
                          x->gap);
    return st == ST_OK ? st : errinfo_set(&c->e, st, "comparing: %s", status_message(st));
}

enum status lab_explain(struct lab *c)
{
    const char *folder = c->out != NULL ? c->out : "explanation";
    struct explanation x = {.a = c->args[0],
                            .b = c->args[1],
                            .engine = c->engine,
                            .calibration = surface_work_calibration(c->work)};
    char path[PATH_MAX];
    enum status st = ST_OK;

    if (strcmp(folder, "-") == 0)
        return lab_usage(
            c, "explain writes several files: --out takes a folder (./- is one)");
    for (size_t i = 0; st == ST_OK && i < FILES; i++) {
        (void)snprintf(path, sizeof path, "%s/%s", folder, file[i].name);
        st = lab_may_write(c, path);
    }
    if (st == ST_OK)
        st = lab_explain_compare(c, &x);
    for (size_t i = 0; st == ST_OK && i < FILES; i++) {
        (void)snprintf(path, sizeof path, "%s/%s", folder, file[i].name);
        st = lab_write(c, path, file[i].write, &x);
    }
    if (st == ST_OK) {
        (void)printf("decision     %s, score %.2f, a match at %.2f or above\n"
                     "disparity    %.3f mm, minimal\nwritten to   %s\n",
                     lab_decision(x.result.decision), x.result.score, x.result.threshold,
                     x.minimal.disparity_mm, folder);
        c->code = x.result.decision == SURFACE_MATCH      ? EXIT_FINE
                  : x.result.decision == SURFACE_NO_MATCH ? EXIT_NO
                                                          : EXIT_INCONCLUSIVE;
    }
    mem_free(x.gap);
    mem_free(x.pts);
    face_free(&x.tmpl);
    face_free(&x.probe);
    return st;
}
