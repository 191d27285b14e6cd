/* surfacectl scan: what is found in scans, and what would be done with them. */
#include <math.h>
#include <string.h>

#include "cloudformat.h"
#include "cloudpoints.h"
#include "cloudunit.h"
#include "describe.h"
#include "mem.h"
#include "dry_run.h"
#include "ctl_command.h"
#include "ctl_dir.h"
#include "ctl_face.h"
#include "ctl_sample.h"
#include "scan_picture.h"

static const char *picture, *face_file; /* --picture, --face */

struct checked {
    struct cloudpoints raw,
        points; /* as read (for a picture); afterwards those of the face */
    struct face face;
    struct dry_run trial;
};

/* ---- as text */

static void print_found(const struct scan_found *f)
{
    (void)printf("format       %s, %zu points, %zu without a value, %zu used\n",
                 cloudformat_name((enum cloudformat)f->format), f->points_read,
                 f->points_dropped, f->points_used);
    (void)printf("unit         %s%s\n",
                 f->unit_mm > 0 ? cloudunit_name(f->unit_mm) : "not found",
                 f->unit_mm > 0 && f->unit_found ? " (found)" : "");
    if (!isnan(f->yaw_deg))
        (void)printf("view         yaw %ld, pitch %ld, roll %ld degrees\n",
                     lrint(f->yaw_deg), lrint(f->pitch_deg), lrint(f->roll_deg));
    (void)printf("covered      %.0f %% of the face\n", 100 * f->occluded);
    (void)printf("elsewhere    %.0f %% of the points\n", 100 * f->elsewhere);
    ctl_sample_warnings(stdout, "warnings", f);
}

static void print_text(const struct checked *k)
{
    const struct dry_run *t = &k->trial;

    if (t->found.points_read > 0)
        print_found(&t->found);
    if (t->verification == ST_OK) {
        (void)printf("quality      %.2f", k->face.quality.score);
        ctl_face_reasons(stdout, &k->face);
    }
    (void)printf("enrolment    %s\n", t->enrolment == ST_OK ? "usable" : t->why.msg);
    (void)printf("verification %s\n", t->verification == ST_OK ? "usable" : "refused");
    for (size_t i = 0; t->enrolment == ST_OK && i < t->advice.n; i++)
        (void)printf("advice       %s\n", t->advice.line[i]);
}

/* ---- as a picture */

/* used[i]: is raw point i among those of the face? */
static void mark_used(const struct checked *k, uint8_t *used)
{
    const struct cloudpoints *raw = &k->raw, *face = &k->points;
    size_t at = 0;

    for (size_t i = 0; i < raw->n; i++) {
        const size_t place = raw->index != NULL ? raw->index[i] : i;

        while (at < face->n && (face->index != NULL ? face->index[at] : at) < place)
            at++;
        used[i] = at < face->n && (face->index != NULL ? face->index[at] : at) == place;
    }
}

/* What was measured, of "refused: what was measured: what to do"; "" for none. */
static void tell_reason(const struct dry_run *t, char *out, size_t size)
{
    const char *colon = strchr(t->why.msg, ':');
    const char *text = colon != NULL ? colon + 2 : "";

    (void)snprintf(out, size, "%.*s", (int)strcspn(text, ":"), text);
}

static enum status draw(struct ctl *c, const struct checked *k)
{
    const struct dry_run *t = &k->trial;
    const bool usable = t->verification == ST_OK;
    uint8_t *used = mem_array(k->raw.n, 1);
    char reason[160];
    const struct scan_picture p = {
        .drawn = {.at = k->raw.at,
                  .used = used,
                  .n = k->raw.n,
                  .found = &t->found,
                  .face = usable ? &k->face : NULL,
                  .mean = face_work_mean(c->work)},
        .verdict = t->enrolment == ST_OK ? "Usable for enrolment and verification"
                   : usable              ? "Usable for verification only"
                                         : "Refused",
        .reason = reason,
        .quality = usable ? k->face.quality.score : (double)NAN,
        .advice = &t->advice};
    enum status st;

    if (used == NULL)
        return errinfo_set(&c->e, ST_ENOMEM, "out of memory");
    tell_reason(t, reason, sizeof reason);
    memset(used, 0, k->raw.n);
    if (usable)
        mark_used(k, used);
    if ((st = ctl_dir_file(c, picture, scan_picture, &p)) == ST_EINVAL)
        st = ST_EINTERNAL; /* the script that gnuplot refused is this program's */
    mem_free(used);
    return st;
}

/* ---- the command */

/* A file whose points cannot be read is refused as well; other failures are not the scan's. */
static enum status check(struct ctl *c, const char *path, struct checked *k)
{
    enum status st = ctl_sample_parse(c, path, &k->points);

    if (st == ST_EINVAL || st == ST_EVERSION || dry_run_is_refusal(st)) {
        dry_run_unread(st, &c->e, &k->trial);
        return ST_OK;
    }
    if (st == ST_OK && picture != NULL && cloudpoints_copy(&k->points, &k->raw) != ST_OK)
        st = errinfo_set(&c->e, ST_ENOMEM, "out of memory");
    if (st == ST_OK && (st = dry_run_run("refused", &k->points,
                                         &(struct scan_options){.axes = c->scans.axes},
                                         c->work, &k->face, &k->trial)) != ST_OK)
        c->e = k->trial.why;
    return st;
}

static enum status scan_file(struct ctl *c, const char *path, bool *usable)
{
    const double start = ctl_clock_ms();
    struct checked k = {.raw = {.n = 0}};
    enum status st = check(c, path, &k);

    *usable = st == ST_OK && k.trial.enrolment == ST_OK;
    if (st == ST_OK) {
        ctl_say(c, "scan         %s\n", path);
        json_object(c->out, NULL);
        json_text(c->out, "file", path);
        describe_dry_run(c->out, &k.trial, &k.face,
                         &(struct describe_times){.parse = NAN,
                                                  .prepare = NAN,
                                                  .total = ctl_clock_ms() - start});
        json_close(c->out);
        if (!c->json)
            print_text(&k);
    }
    if (st == ST_OK && picture != NULL && k.raw.n > 0)
        st = draw(c, &k);
    if (st == ST_OK && face_file != NULL && k.trial.verification == ST_OK)
        st = ctl_dir_mesh(c, face_file, &k.face.surface.mesh);
    face_free(&k.face);
    cloudpoints_free(&k.raw);
    cloudpoints_free(&k.points);
    return st;
}

/* A fault that is no scan's does not stop the others either. */
static enum status run(struct ctl *c)
{
    const char *const output[] = {picture, face_file};
    struct errinfo fault = {.code = ST_OK};
    bool usable;

    if ((picture != NULL || face_file != NULL) && c->nargs > 1)
        return ctl_usage(c, "--picture and --face are of one scan");
    if (picture != NULL && face_file != NULL && strcmp(picture, face_file) == 0)
        return ctl_usage(c, "--picture and --face name the same file");
    for (int i = 0; i < 2; i++) {
        const enum status st =
            output[i] == NULL ? ST_OK : ctl_dir_may_write(c, output[i], c->nargs);

        if (st != ST_OK)
            return st;
    }
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
    .options = {CTL_OPTION("picture", "FILE", ctl_option_text, &picture,
                           "draw what was found (PNG); of one scan"),
                CTL_OPTION("face", "FILE", ctl_option_text, &face_file,
                           "write the face as it is compared (PLY, mm); of one scan")},
    .exits = {"all of them can be enrolled", "some cannot be enrolled"},
    .run = run,
    .summary = "say what is found in scans, and what to do better",
    .help =
        "For each FILE: format and points, the unit, how the face is turned and covered, the\n"
        "quality, whether it can be enrolled and verified with or why not, and what to change at\n"
        "the scanner.  Nothing is stored.  --picture shows the points as they were delivered\n"
        "beside the face that was found; --face writes that face with its triangles: cropped, in\n"
        "millimetres, seen from the front (x to the image's right, y up, z towards the scanner).\n"
        "Both are biometric data: only their owner can read them.",
    .example = "surfacectl scan alice.glb --picture alice.png"};
