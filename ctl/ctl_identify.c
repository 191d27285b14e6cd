/* identify: whose scan is it, of all who may be found? */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "ctl_command.h"
#include "ctl_face.h"
#include "ctl_session.h"
#include "groups.h"
#include "identify.h"

static const char *group = "";   /* --group */
static uint32_t most_candidates; /* --candidates */

/* What a search costs besides its templates: reading a scan, its compilation, and the comparisons. */
#define SEARCH_MS   30.0
#define TEMPLATE_MS 100e-6

#define BY_LAW ", by a law beyond what comparisons support"

/* ---- the gallery */

struct loaded {
    struct gallery *gallery;
    double ms; /* time to load it */
};

/* Also sets the calibration of c->work to the one in force. */
static enum status load(struct ctl *c, struct loaded *l)
{
    const double start = command_clock_ms();
    struct store_people *people;
    struct store_calibration k;
    enum status st;

    if ((l->gallery = gallery_new(SIZE_MAX)) == NULL)
        return errinfo_memory(&c->e);
    if ((st = store_people_begin(c->store, c->actor, 0, &people, &c->e)) == ST_OK) {
        if (store_people_calibration(people, &k) != 0)
            store_calibration_apply(c->store, k, c->work);
        st = store_people_end(people, gallery_follow(l->gallery, people, &c->e), &c->e);
    }
    l->ms = command_clock_ms() - start;
    return st;
}

static void print_gallery(const struct ctl *c, const struct loaded *l)
{
    const struct gallery_state is = gallery_state(l->gallery);
    char bytes[32];

    ctl_say(c, "gallery      %" PRIu64 " template%s, %s of memory, loaded in %.1f ms\n",
            CTL_COUNT(is.templates), ctl_bytes(is.bytes, bytes), l->ms);
}

/* ---- the result as text */

static void print_scores(const struct identification *x)
{
    double score, threshold;

    if (x->compared == 0)
        return;
    surface_shown(&x->best.result, 100, &score, &threshold);
    if (isfinite(threshold))
        (void)printf("score        %.2f (a match at %.2f or above, among %" PRIu64
                     " people)\n",
                     score, threshold, x->searched);
    else
        (void)printf("score        %.2f (among %" PRIu64 " people no score is a match)\n",
                     score, x->searched);
    (void)printf("fpir         %.2g at this score%s\n", x->fpir,
                 x->extrapolated ? BY_LAW : "");
}

/* Why no score is a match among so many people, and what helps. */
static void print_beyond(const struct ctl *c)
{
    ctl_say(c,
            "the calibration is good for %u people at most. Search a group of\n"
            "             fewer (--group), or calibrate on this database (surfacectl "
            "calibrate)\n",
            surface_search_people(surface_work_calibration(c->work)));
}

/* Why nobody can say, and what helps. */
static void print_doubt(const struct ctl *c, const struct identification *x)
{
    const struct surface_comparison *r = &x->best.result;

    (void)printf("subject      cannot tell: ");
    if (x->unknown)
        (void)printf("too little of the face is known to search by it. Take a better "
                     "scan\n");
    else if (x->compared == 0 || r->decision == SURFACE_NO_MATCH)
        (void)printf("%" PRIu64
                     " template%s could not be searched, and may be the person's: see\n"
                     "             surfacectl template reencode, check-database\n",
                     CTL_COUNT(x->skipped));
    else if (isinf(r->threshold))
        print_beyond(c);
    else
        (void)printf("two such scans of one person would reach %.1f on average. Take\n"
                     "             a better scan or several frames, or search a smaller "
                     "group (--group)\n",
                     r->expected);
}

static void print_subject(const struct ctl *c, const struct identification *x)
{
    if (x->decision == SURFACE_INCONCLUSIVE)
        print_doubt(c, x);
    else if (x->decision == SURFACE_MATCH)
        (void)printf("subject      %s (template %s)\n", x->templates.of.subject.id,
                     x->templates.of.t[x->best.index].id);
    else
        (void)printf("subject      %s\n", x->searched > 0
                                              ? "none of those searched"
                                              : "none: there is nobody to search");
}

static void print_candidates(const struct identification *x)
{
    if (x->n > 0)
        (void)printf("candidates   to be reviewed by a person: they are the most alike, "
                     "not a decision\n");
    for (size_t i = 0; i < x->n; i++) {
        const struct identify_candidate *one = &x->candidate[i];
        double score, threshold;

        surface_shown(&one->result, 100, &score, &threshold);
        (void)printf("  %8.2f  fmr %-8.2g  %-32s  template %s\n", score,
                     one->result.false_match_rate, one->subject, one->template_id);
    }
}

static void ctl_identify_print(const struct ctl *c, const struct identification *x,
                               const struct loaded *l)
{
    (void)printf("decision     %s\n", templates_decision(x->decision));
    print_subject(c, x);
    print_scores(x);
    (void)printf("searched     %" PRIu64 " %s%s%s; %u compared exactly, %" PRIu64
                 " template%s skipped\n",
                 x->searched, x->searched == 1 ? "person" : "people",
                 group[0] != '\0' ? " of the group " : "", group, x->compared,
                 CTL_COUNT(x->skipped));
    print_candidates(x);
    print_gallery(c, l);
    ctl_face_scan(stdout, *x->request->face);
    ctl_face_warnings(stdout, "warnings", &x->request->probe->found);
    (void)printf("time         %.1f ms\n", x->times.total);
}

/* ---- a search */

static enum status ctl_identify_search(struct ctl *c, const struct loaded *l,
                                       struct session *probe)
{
    const double start = command_clock_ms();
    struct templates_context with = ctl_face_context(c, c->work);
    struct surface_face *face = NULL;
    struct identify_request r = {.actor = c->actor,
                                 .group = group,
                                 .candidates = most_candidates,
                                 .probe = probe,
                                 .face = &face};
    struct identification x;
    enum status st = identify_run(&with, l->gallery, &r, &x, &c->e);

    if (probe->files)
        ctl_session_tell(c, probe);
    if (st == ST_OK) {
        x.times.parse = (double)NAN;
        x.times.total = command_clock_ms() - start;
        c->code = ctl_face_exit(x.decision);
        identify_describe(c->out, &x, false, true, c->engine);
        if (!c->json)
            ctl_identify_print(c, &x, l);
    }
    identify_free(&x);
    surface_face_free(face);
    return st;
}

/* ---- --dry-run */

static void print_threshold(struct ctl *c, uint64_t people)
{
    const struct surface_calibration *by = surface_work_calibration(c->work);
    const uint32_t n = people < UINT32_MAX ? (uint32_t)people : UINT32_MAX;
    const double t = surface_search_threshold(by, n);
    int extrapolated = 0;
    const double fpir =
        isfinite(t) ? surface_search_fpir(by, n, t, &extrapolated) : (double)NAN;

    json_score(c->out, "threshold", t);
    json_rate(c->out, "fpir_at_threshold", fpir);
    json_flag(c->out, "extrapolated", extrapolated != 0);
    json_number(c->out, "people_supported", surface_search_people(by));
    ctl_say(c, "threshold    ");
    if (isfinite(t))
        ctl_say(c, "%.2f\nfpir         %.2g at the threshold%s\n", t, fpir,
                extrapolated ? BY_LAW : "");
    else {
        ctl_say(c, "none: ");
        print_beyond(c);
    }
}

static enum status ctl_identify_reckon(struct ctl *c, const struct loaded *l)
{
    const struct gallery_state is = gallery_state(l->gallery);
    const double ms = SEARCH_MS + TEMPLATE_MS * (double)is.templates;
    struct gallery_found all;
    const enum status st = gallery_count(l->gallery, "", group, &all, &c->e);

    if (st != ST_OK)
        return st;
    ctl_say(c, "people       %" PRIu64 "%s%s\n", all.searched,
            group[0] != '\0' ? " of the group " : "", group);
    ctl_say(c, "skipped      %" PRIu64 " template%s that cannot be searched\n",
            CTL_COUNT(all.skipped));
    json_number(c->out, "searched", (double)all.searched);
    json_number(c->out, "skipped", (double)all.skipped);
    print_threshold(c, all.searched);
    json_number(c->out, "templates", (double)is.templates);
    json_number(c->out, "memory_bytes", (double)is.bytes);
    json_number(c->out, "load_ms", l->ms);
    json_number(c->out, "search_ms", ms);
    print_gallery(c, l);
    ctl_say(c, "time         about %.0f ms a search, once the gallery is loaded\n", ms);
    return ST_OK;
}

static enum status ctl_identify_check(struct ctl *c)
{
    if (group[0] != '\0' && !groups_label(group))
        return ctl_usage(c, "--group: a group is 1 to %d characters of a-z 0-9 . _ -",
                         GROUPS_LABEL);
    if (most_candidates > IDENTIFY_MOST)
        return ctl_usage(c, "--candidates is 1 to %d", IDENTIFY_MOST);
    if (c->nargs == 0 && !c->dry_run)
        return ctl_usage(c, "identify needs a scan, or --dry-run");
    return ST_OK;
}

static enum status ctl_identify_run(struct ctl *c)
{
    struct ctl_session *s = calloc(1, sizeof *s);
    struct loaded l = {.ms = 0};
    enum status st = s != NULL ? ctl_identify_check(c) : errinfo_memory(&c->e);

    if (st == ST_OK && (st = ctl_session_list(c, 0, s)) == ST_OK && !c->dry_run)
        st = ctl_session_read(c, s);
    if (st == ST_OK && (st = load(c, &l)) == ST_OK)
        st = c->dry_run ? ctl_identify_reckon(c, &l)
                        : ctl_identify_search(c, &l, &s->session);
    gallery_free(l.gallery);
    if (s != NULL)
        ctl_session_free(s);
    free(s);
    return st;
}

const struct ctl_command ctl_identify = {
    .name = "identify",
    .args = "[SCAN...]",
    .takes = {0, CTL_MANY},
    .database = CTL_WRITES_DATABASE,
    .shared = CTL_SCANS | CTL_MODEL | CTL_DRY_RUN,
    .options = {CTL_OPTION("group", "NAME", command_text, &group,
                           "search only the subjects of this group (all subjects)"),
                CTL_OPTION("candidates", "N", command_whole, &most_candidates,
                           "list the N most alike subjects, 50 at most, for a person to\n"
                           "review (none)")},
    .exits = {"match", "no match",
              "inconclusive: the scan, or the number of people, allows no decision"},
    .run = ctl_identify_run,
    .summary = "find out whose scan it is",
    .help =
        "Several SCANs, or a folder, are frames of one capture session, at most 20, and become\n"
        "one probe. The more people are searched, the higher a score a match needs. Subjects who\n"
        "are disabled, expired or opted out are not searched. --dry-run needs no scan: it shows\n"
        "how many people would be searched, the threshold, the memory and the time.",
    .example = "surfacectl --db faces.db identify probe.ply"};
