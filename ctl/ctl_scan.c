/* surfacectl scan: what is found in scans, and what would be done with them. */
#include <math.h>
#include <string.h>

#include "advice.h"
#include "cloudpoints.h"
#include "cloudunit.h"
#include "describe.h"
#include "mem.h"
#include "ctl_command.h"
#include "ctl_dir.h"
#include "ctl_face.h"
#include "ctl_sample.h"
#include "scan_picture.h"

static const char *picture; /* --picture */

struct checked {
    struct cloudpoints raw, points; /* as read; of the face, where one was found */
    struct scan_found found;
    struct face face;
    struct advice advice;
    enum status enrol, verify; /* ST_OK: usable */
    struct errinfo why;        /* where not for enrolment */
};

static void *copy_array(const void *from, size_t n, size_t size)
{
    void *to = from != NULL ? mem_array(n, size) : NULL;

    if (to != NULL)
        memcpy(to, from, n * size);
    return to;
}

/* to = from; what it had before is released. */
static enum status copy_points(const struct cloudpoints *from, struct cloudpoints *to)
{
    cloudpoints_free(to);
    *to = *from;
    to->at = copy_array(from->at, from->n, sizeof *to->at);
    to->normal = copy_array(from->normal, from->n, sizeof *to->normal);
    to->index = copy_array(from->index, from->n, sizeof *to->index);
    return (to->at == NULL) == (from->at == NULL) &&
                   (to->normal == NULL) == (from->normal == NULL) &&
                   (to->index == NULL) == (from->index == NULL)
               ? ST_OK
               : ST_ENOMEM;
}

static enum status build(struct ctl *c, struct checked *k, bool enrolment)
{
    const enum status st = copy_points(&k->raw, &k->points);

    return st == ST_OK ? ctl_sample_build(c, "refused", &k->points, enrolment, c->work,
                                          &k->face, &k->found)
                       : errinfo_set(&c->e, st, "%s", status_message(st));
}

/* By the strict gate, and where that refuses by the other; the advice is the strict one's. */
static enum status check(struct ctl *c, struct checked *k)
{
    if ((k->enrol = k->verify = build(c, k, true)) == ST_ENOMEM)
        return ST_ENOMEM;
    advice_give(k->enrol, &k->found, &k->face, &k->advice);
    if (k->enrol != ST_OK) {
        k->why = c->e;
        k->verify = build(c, k, false);
    }
    return k->verify == ST_ENOMEM ? ST_ENOMEM : ST_OK;
}

/* ---- as JSON and text */

static void tell_json(struct json *j, const struct checked *k)
{
    json_object(j, "usable");
    json_flag(j, "enroll", k->enrol == ST_OK);
    json_flag(j, "verify", k->verify == ST_OK);
    json_close(j);
    describe_scan(j, "scan", &k->found);
    if (k->verify == ST_OK)
        describe_quality(j, "quality", &k->face.quality, &k->face.frame);
    else
        json_text(j, "quality", NULL);
    json_text(j, "reason", k->enrol != ST_OK ? status_message(k->enrol) : NULL);
    json_text(j, "detail", k->enrol != ST_OK ? k->why.msg : NULL);
    json_array(j, "advice");
    for (size_t i = 0; i < k->advice.n; i++)
        json_text(j, NULL, k->advice.line[i]);
    json_close(j);
}

static void print_found(const struct scan_found *f)
{
    (void)printf("format       %s, %zu points, %zu without a value, %zu used\n",
                 cloudformat_name(f->format), f->points_read, f->points_dropped,
                 f->points_used);
    (void)printf("unit         %s%s\n",
                 f->unit_mm > 0 ? cloudunit_name(f->unit_mm) : "not found",
                 f->unit_mm > 0 && f->unit_found ? " (found)" : "");
    if (!isnan(f->yaw_deg))
        (void)printf("view         yaw %.0f, pitch %.0f, roll %.0f degrees\n", f->yaw_deg,
                     f->pitch_deg, f->roll_deg);
    (void)printf(
        "covered      %.0f %% of the face; %.0f %% of the points are elsewhere\n",
        100 * f->occluded, 100 * f->elsewhere);
    for (int i = 0; i < SCAN_WARNINGS; i++)
        if ((f->warnings >> i & 1) != 0)
            (void)printf("warning      %s\n", scan_warning_name((enum scan_warning)i));
}

static void print_text(const struct checked *k)
{
    print_found(&k->found);
    if (k->verify == ST_OK) {
        (void)printf("quality      %.2f", k->face.quality.score);
        ctl_face_reasons(stdout, &k->face);
    }
    (void)printf("enrolment    %s\n", k->enrol == ST_OK ? "usable" : k->why.msg);
    (void)printf("verification %s\n", k->verify == ST_OK ? "usable" : "refused");
    for (size_t i = 0; i < k->advice.n; i++)
        (void)printf("advice       %s\n", k->advice.line[i]);
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

static enum status draw(struct ctl *c, const struct checked *k)
{
    uint8_t *used = mem_array(k->raw.n, 1);
    const bool usable = k->verify == ST_OK;
    const struct scan_picture p = {
        .drawn = {.at = k->raw.at,
                  .used = used,
                  .n = k->raw.n,
                  .found = &k->found,
                  .face = usable ? &k->face : NULL,
                  .mean = face_work_mean(c->work)},
        .verdict = k->enrol == ST_OK ? "Usable for enrolment and verification"
                   : usable          ? "Usable for verification only"
                                     : "Refused",
        .reason = k->enrol == ST_OK ? "" : status_message(k->enrol),
        .quality = usable ? k->face.quality.score : (double)NAN,
        .advice = &k->advice};
    enum status st;

    if (used == NULL)
        return errinfo_set(&c->e, ST_ENOMEM, "out of memory");
    memset(used, 0, k->raw.n);
    if (usable)
        mark_used(k, used);
    if ((st = ctl_dir_file(picture, scan_picture, &p, &c->e)) == ST_EINVAL)
        st = ST_EINTERNAL; /* the script that gnuplot refused is this program's */
    mem_free(used);
    return st;
}

/* ---- the command */

/* *usable: for enrolment. */
static enum status scan_file(struct ctl *c, const char *path, bool *usable)
{
    struct checked k = {.raw = {.n = 0}};
    enum status st = ctl_sample_parse(c, path, &k.raw);

    *usable = false;
    ctl_say(c, "scan         %s\n", path);
    json_object(c->out, NULL);
    json_text(c->out, "file", path);
    if (st == ST_OK && (st = check(c, &k)) == ST_OK) {
        *usable = k.enrol == ST_OK;
        tell_json(c->out, &k);
        if (!c->json)
            print_text(&k);
        if (picture != NULL)
            st = draw(c, &k);
    } else {
        json_text(c->out, "error", c->e.msg);
        ctl_say(c, "refused      %s\n", c->e.msg);
    }
    json_close(c->out);
    face_free(&k.face);
    cloudpoints_free(&k.raw);
    cloudpoints_free(&k.points);
    return st;
}

/* Those that end the command: not the scan's fault. */
static bool is_fault(enum status st)
{
    return st == ST_ENOMEM || st == ST_EIO || st == ST_ENOTFOUND || st == ST_EDENIED ||
           st == ST_EINTERNAL;
}

static enum status run(struct ctl *c)
{
    struct errinfo fault = {.code = ST_OK};
    bool usable;

    if (picture != NULL && c->nargs > 1)
        return ctl_usage(c, "--picture is of one scan");
    json_array(c->out, "scans");
    for (int i = 0; i < c->nargs; i++) {
        const enum status st = scan_file(c, c->args[i], &usable);

        if (!usable)
            c->code = EXIT_NO;
        if (is_fault(st) && fault.code == ST_OK) {
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
    .shared = CTL_SCANS | CTL_MODEL,
    .options = {CTL_OPTION("picture", "FILE", ctl_option_text, &picture,
                           "draw what was found (PNG); of one scan")},
    .exits = {"all of them can be enrolled", "some cannot be enrolled"},
    .run = run,
    .summary = "say what is found in scans, and what to do better",
    .help =
        "For each FILE: format and points, the unit, how the face is turned and covered, the\n"
        "quality, whether it can be enrolled and verified with or why not, and what to change at\n"
        "the scanner.  Nothing is stored.  --picture shows the points as they were delivered\n"
        "beside the face that was found.  It is biometric data: only its owner can read it.",
    .example = "surfacectl scan alice.glb --picture alice.png"};
