/* surfacectl scan: the faces in scans, and whether they can be enrolled and verified. */
#include <math.h>
#include <stdlib.h>

#include "cloudformat.h"
#include "cloudpoints.h"
#include "cloudunit.h"
#include "describe.h"
#include "dry_run.h"
#include "ctl_command.h"
#include "ctl_face.h"
#include "page.h"
#include "show.h"

static const char *face_file; /* --face */
static const char *page;      /* --page */

#define PAGE_POINTS 10000 /* of a scan, shown as dots: 300 KB in all */

struct checked {
    struct cloudpoints points;
    struct surface_face *face;
    struct dry_run trial;
};

/* ---- as text */

static void print_found(const struct sample_found *s)
{
    const struct surface_found *f = &s->scan;

    (void)printf("format       %s, %zu points, %zu without a value, %zu used\n",
                 cloudformat_name(s->format), s->points_read, s->points_dropped,
                 f->points_used);
    (void)printf("unit         %s%s\n",
                 f->unit_mm > 0 ? cloudunit_name(f->unit_mm) : "not found",
                 f->unit_mm > 0 && f->unit_found ? " (found)" : "");
    if (!isnan(f->yaw_deg))
        (void)printf("view         yaw %ld, pitch %ld, roll %ld degrees\n",
                     lrint(f->yaw_deg), lrint(f->pitch_deg), lrint(f->roll_deg));
    (void)printf("covered      %.0f %% of the face\n", 100 * f->occluded);
    (void)printf("elsewhere    %.0f %% of the points\n", 100 * f->elsewhere);
    ctl_face_warnings(stdout, "warnings", s);
}

static void print_text(const struct checked *k)
{
    const struct dry_run *t = &k->trial;

    if (t->found.points_read > 0)
        print_found(&t->found);
    if (t->verification == ST_OK) {
        (void)printf("quality      %.2f", t->found.scan.quality.score);
        ctl_face_reasons(stdout, k->face);
    }
    (void)printf("enrolment    %s%s\n", t->enrolment == ST_OK ? "usable" : "refused: ",
                 t->enrolment == ST_OK ? "" : t->why.msg);
    (void)printf("verification %s\n", t->verification != ST_OK ? "refused"
                                      : t->enrolment == ST_ENOTFACE
                                          ? "accepted, but hardly a face"
                                          : "usable");
    for (size_t i = 0; t->enrolment == ST_OK && i < t->advice.n; i++)
        (void)printf("advice       %s\n", t->advice.line[i]);
    for (size_t i = 0; i < t->advice.nnote; i++)
        (void)printf("note         %s\n", t->advice.note[i]);
}

/* ---- the command */

/* A file whose points cannot be read is refused as well; other failures are not the scan's. */
static enum status ctl_scan_check(struct ctl *c, const char *path, struct checked *k)
{
    enum status st = ctl_face_parse(c, path, &k->points);

    if (st == ST_EINVAL || st == ST_EVERSION || dry_run_is_refusal(st)) {
        dry_run_unread(st, &c->e, &k->trial);
        return ST_OK;
    }
    if (st == ST_OK &&
        (st = dry_run_run(path, &k->points, &(struct sample_options){.stop = NULL},
                          c->work, &k->face, &k->trial)) != ST_OK)
        c->e = k->trial.why;
    return st;
}

static enum status ctl_scan_write_page(struct ctl *c, const char *path,
                                       const struct checked *k)
{
    struct json *j = json_new();
    struct show show;
    enum status st;

    json_object(j, "extras");
    describe_dry_run(j, &k->trial, k->face, &(struct describe_times){0});
    page_file(j, "a", path,
              k->face != NULL ? k->trial.found.scan.quality.score : (double)NAN);
    page_made(j);
    json_close(j);
    st = show_scan(k->face, k->points.at, k->points.n, PAGE_POINTS,
                   k->trial.found.scan.view, j, &show);
    st = st == ST_OK ? ctl_write(c, page, page_write, &show)
                     : errinfo_set(&c->e, st, "%s: %s", page, status_message(st));
    free(show.glb);
    return st;
}

static enum status scan_file(struct ctl *c, const char *path, bool *usable)
{
    const double start = command_clock_ms();
    struct checked k = {.points = {.n = 0}};
    enum status st = ctl_scan_check(c, path, &k);

    *usable = st == ST_OK && k.trial.enrolment == ST_OK;
    if (st == ST_OK) {
        ctl_say(c, "scan         %s\n", path);
        json_object(c->out, NULL);
        json_text(c->out, "file", path);
        describe_dry_run(c->out, &k.trial, k.face,
                         &(struct describe_times){.parse = NAN,
                                                  .prepare = NAN,
                                                  .total = command_clock_ms() - start});
        json_close(c->out);
        if (!c->json)
            print_text(&k);
    }
    if (st == ST_OK && face_file != NULL && k.trial.verification == ST_OK)
        st = ctl_write_face(c, face_file, k.face);
    if (st == ST_OK && page != NULL && k.points.n > 0)
        st = ctl_scan_write_page(c, path, &k);
    surface_face_free(k.face);
    cloudpoints_free(&k.points);
    return st;
}

/* A fault that is no scan's does not stop the others either. */
static enum status ctl_scan_run(struct ctl *c)
{
    struct errinfo fault = {.code = ST_OK};
    enum status may = ST_OK;
    bool usable;

    if ((face_file != NULL || page != NULL) && c->nargs > 1)
        return ctl_usage(c, "--face and --page need exactly one scan");
    if (face_file != NULL)
        may = ctl_may_write(c, face_file, c->nargs);
    if (may == ST_OK && page != NULL)
        may = ctl_may_write(c, page, c->nargs);
    if (may != ST_OK)
        return may;
    json_array(c->out, "scans");
    for (int i = 0; i < c->nargs; i++) {
        const enum status st = scan_file(c, c->args[i], &usable);

        if (!usable)
            c->code = EXIT_NO;
        if (st != ST_OK && fault.code == ST_OK) {
            fault = c->e;
            fault.code = st;
        }
    }
    json_close(c->out);
    c->e = fault;
    return fault.code;
}

const struct ctl_command ctl_scan = {
    .name = "scan",
    .args = "FILE...",
    .takes = {1, CTL_MANY},
    .shared = CTL_SCANS | CTL_MODEL | CTL_FORCE,
    .options = {CTL_OPTION("face", "FILE", command_text, &face_file,
                           "write the cropped face (PLY, mm) of one scan"),
                CTL_OPTION(
                    "page", "FILE", command_text, &page,
                    "write a page for a browser (HTML): the scan, and the face in it")},
    .exits = {"all of them can be enrolled", "some cannot be enrolled"},
    .run = ctl_scan_run,
    .summary = "describe scans, and what to change at the scanner",
    .help =
        "Prints what is found, whether it can be enrolled and verified, and what to change.\n"
        "Nothing is stored. Only the owner can read the files of --face and --page: they are\n"
        "biometric data.",
    .example = "surfacectl scan alice.glb --page alice.html"};
