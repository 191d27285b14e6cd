/* The command calibrate: a threshold and a table of false match rates from the owner's own
 * database (docs/decision.md). */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "store.h"
#include "describe.h"
#include "rates.h"
#include "ctl_command.h"
#include "ctl_cross.h"
#include "ctl_model.h"
#include "ctl_search.h"
#include "show.h"

#define SEED         UINT64_C(20250) /* of everything that is drawn */
#define DEFAULT_FMR  0.001
#define LEAST_LIMIT  20000.0 /* at least this many non-mated comparisons, or */
#define ERRORS_LIMIT 60.0    /* those that give this many errors at the wanted rate, or */
#define PEOPLE_LIMIT                                                                     \
    (2 * 3 / SURFACE_FPIR) /* so many for each template: all can be searched */

/* Where not all are compared, scores that so few of the sample reach are searched among all people: in the sample
 * they are too few for a rate. */
#define TAIL_RATE 5e-5

static bool wants_list, wants_reset; /* --list, --reset */
static double wanted_fmr;            /* --fmr; 0: not given */

struct result {
    struct ctl_cross cross;
    struct rates *rates;
    struct store_calibration k;
    size_t pairs; /* pairs of subjects that were compared, at least */
    double fnmr, fnmr_low, fnmr_high;
    double shipped_fmr, shipped_fnmr; /* here, at the shipped threshold */
    size_t suspects;                  /* comparisons */
    bool all;                         /* all people were compared with all */
    struct {
        uint32_t subjects; /* 0: none was searched */
        double score;      /* from this on */
        uint64_t compared; /* exactly */
    } tail;
};

/* ---- two ids, one face? */

/* From this score on two people may be one, or relatives: the highest that the shipped table
 * gives a false match rate for. */
static const struct surface_knot *suspicious(const struct ctl *c)
{
    const struct surface_calibration *own = surface_model_calibration(c->model);

    return &own->knot[own->n - 1];
}

/* Comparisons of two subjects with such a score. */
static size_t count_suspects(const struct ctl *c, const struct ctl_cross *p)
{
    size_t n = 0;

    for (size_t i = 0; i < p->nscore; i++)
        n += p->score[i].template != p->score[i].probe &&
             p->score[i].score >= suspicious(c)->score;
    return n;
}

/* ---- the work */

static enum status too_few(struct ctl *c, size_t subjects, size_t pairs)
{
    char supported[64] = "";

    if (pairs > 3)
        (void)snprintf(supported, sizeof supported, ", which support %.2g",
                       rates_least(pairs));
    return errinfo_set(
        &c->e, ST_ETOOFEW,
        "a false match rate of %g needs %u subjects with templates (%zu pairs "
        "of people, rule of 3); the database has %zu (%zu pair%s%s)",
        wanted_fmr, rates_subjects(wanted_fmr), rates_needed(wanted_fmr), subjects, pairs,
        pairs == 1 ? "" : "s", supported);
}

static size_t pairs_of(size_t n)
{
    return n > 1 ? n * (n - 1) / 2 : 0;
}

/* Each subject by all probes of the others. */
static size_t comparisons_of(const struct ctl_cross *p)
{
    size_t n = 0;

    for (uint32_t i = 0; i < p->nsubject; i++)
        n += p->ntemplate - p->subject[i].n;
    return n;
}

static enum status compare_all(struct ctl *c, struct result *r)
{
    struct ctl_cross *p = &r->cross;
    enum status st = ctl_cross_load(c, SEED, p);

    if (st != ST_OK)
        return st;
    if (!rates_supported(wanted_fmr, pairs_of(p->nsubject)))
        return too_few(c, p->nenrolled, pairs_of(p->nsubject));
    st = ctl_cross_non_mated(
        c, p,
        fmax(fmax(LEAST_LIMIT, ERRORS_LIMIT / wanted_fmr), PEOPLE_LIMIT * p->ntemplate),
        SEED);
    r->all = p->nsubject == p->nenrolled && p->nscore == comparisons_of(p);
    /* Each pair was compared from both sides, or else nscore / 2 pairs were. */
    r->pairs =
        p->nscore / 2 < pairs_of(p->nsubject) ? p->nscore / 2 : pairs_of(p->nsubject);
    if (st == ST_OK && !rates_supported(wanted_fmr, r->pairs))
        return too_few(c, p->nenrolled, r->pairs);
    if (st == ST_OK)
        st = ctl_cross_mated(c, p);
    return st;
}

/* Returns the highest score: the interval ends there if no threshold keeps the rate. */
static double highest(const struct ctl_cross *p)
{
    double most = -(double)INFINITY;

    for (size_t i = 0; i < p->nscore; i++)
        most = fmax(most, p->score[i].score);
    return most;
}

/* ---- the tail */

static int by_trial(const void *p, const void *q)
{
    const struct rates_score *v = p, *w = q;

    if (v->template != w->template)
        return v->template <w->template ? -1 : 1;
    if (v->probe != w->probe)
        return v->probe < w->probe ? -1 : 1;
    return (v->score < w->score) - (v->score > w->score);
}

/* The pairs as comparisons of each subject with probes: the highest score of a subject's templates counts, lowered
 * as a verification's.  s has room for two of each pair.  Returns how many are at or above the floor. */
static size_t tail_scores(struct ctl *c, const struct ctl_cross *all,
                          const struct ctl_search *found, double floor,
                          struct rates_score *s)
{
    size_t n = 0, kept = 0;

    for (size_t i = 0; i < found->n; i++) { /* the probe: its template, at first */
        const struct ctl_search_pair *x = &found->pair[i];

        s[n++] = (struct rates_score){x->score, all->tmpl[x->a].owner, x->b};
        s[n++] = (struct rates_score){x->score, all->tmpl[x->b].owner, x->a};
    }
    if (n > 0)
        qsort(s, n, sizeof *s, by_trial);
    for (size_t i = 0; i < n; i++) {
        struct surface_comparison x = {.score = s[i].score};

        if (i > 0 && s[i].template == s[i - 1].template && s[i].probe == s[i - 1].probe)
            continue;
        surface_best_of(c->work, all->subject[s[i].template].n, &x);
        if (x.score >= floor)
            s[kept++] = (struct rates_score){x.score, s[i].template, s[i].probe};
    }
    for (size_t i = 0; i < kept; i++)
        s[i].probe = all->tmpl[s[i].probe].owner;
    return kept;
}

static enum status extend_by(struct ctl *c, const struct ctl_cross *all,
                             const struct ctl_search *found, double floor,
                             struct surface_calibration *table)
{
    struct rates_score *s = malloc((2 * found->n + 1) * sizeof *s);
    uint32_t *probes = malloc((all->nsubject + (size_t)1) * sizeof *probes);
    struct rates *tail = NULL;
    enum status st = s != NULL && probes != NULL ? ST_OK : ST_ENOMEM;

    for (uint32_t i = 0; st == ST_OK && i < all->nsubject; i++)
        probes[i] = all->subject[i].n;
    if (st == ST_OK)
        st = rates_new_tail(s, tail_scores(c, all, found, floor, s), probes,
                            all->nsubject, &tail);
    if (st == ST_OK)
        st = rates_extend(tail, pairs_of(all->nsubject), SEED, table);
    rates_free(tail);
    free(probes);
    free(s);
    return st;
}

/* The table of a sample goes on by the highest scores among all people. */
static enum status search_tail(struct ctl *c, struct result *r)
{
    struct ctl_cross all = {.nsubject = 0};
    struct ctl_search found = {.n = 0};
    const double floor = rates_at(r->rates, TAIL_RATE);
    enum status st;

    if (r->all || !isfinite(floor))
        return ST_OK;
    st = ctl_cross_list(c, &all);
    if (st == ST_OK)
        st = ctl_search_run(c, &all, CTL_SEARCH_ALL, floor, &found);
    if (st == ST_OK)
        st = extend_by(c, &all, &found, floor, &r->k.table);
    r->tail.subjects = all.nsubject;
    r->tail.score = floor;
    r->tail.compared = found.compared;
    ctl_search_free(&found);
    ctl_cross_free(&all);
    return st;
}

/* From the scores to the calibration. */
static enum status learn(struct ctl *c, struct result *r)
{
    struct store_calibration *k = &r->k;
    struct rates_figures low, high;
    double threshold;
    enum status st =
        rates_new(r->cross.score, r->cross.nscore, r->cross.nsubject, &r->rates);

    r->suspects = count_suspects(c, &r->cross);
    if (st == ST_OK)
        st = rates_calibrate(r->rates, wanted_fmr, &k->table);
    if (st == ST_OK)
        st = rates_extend(r->rates, r->pairs, SEED, &k->table);
    if (st == ST_OK)
        st = search_tail(c, r);
    threshold = k->table.threshold;
    if (st == ST_OK)
        st = rates_bootstrap(r->rates, threshold, wanted_fmr, RATES_REPLICATES, SEED,
                             &low, &high);
    if (st == ST_OK)
        st = det_learn(r->rates, r->pairs, threshold,
                       surface_model_calibration(c->model)->threshold, SEED, &k->det);
    if (st == ST_ETOOFEW)
        return errinfo_set(&c->e, st,
                           "no threshold gives a false match rate of %g: too many of "
                           "the %zu comparisons have equal scores: find people who are "
                           "enrolled twice with surfacectl dedup",
                           wanted_fmr, r->cross.nscore);
    if (st != ST_OK)
        return errinfo_set(&c->e, st, "calibrating: %s", status_message(st));
    k->low = fmin(low.at, threshold);
    k->high = fmax(fmin(high.at, highest(&r->cross)), threshold);
    k->fmr = wanted_fmr;
    k->subjects = r->cross.nsubject;
    k->impostors = rates_nimpostor(r->rates);
    k->genuine = rates_ngenuine(r->rates);
    r->fnmr = rates_fnmr(r->rates, threshold);
    r->fnmr_low = k->det.n > 0 ? k->det.own.low : low.fnmr;
    r->fnmr_high = k->det.n > 0 ? k->det.own.high : high.fnmr;
    r->shipped_fmr = rates_fmr(r->rates, surface_model_calibration(c->model)->threshold);
    r->shipped_fnmr =
        rates_fnmr(r->rates, surface_model_calibration(c->model)->threshold);
    return ST_OK;
}

/* ---- printing */

/* The table as it decides: a row has no law. */
static struct surface_calibration table_of(const struct ctl *c,
                                           const struct store_calibration *k)
{
    struct surface_calibration d =
        k->shipped ? *surface_model_calibration(c->model) : k->table;

    surface_calibration_continue(&d, surface_model_calibration(c->model));
    return d;
}

/* In how large a gallery somebody can match. */
static uint32_t people(const struct ctl *c, const struct store_calibration *k)
{
    const struct surface_calibration d = table_of(c, k);

    return surface_search_people(&d);
}

/* The members of a new calibration and of those in the list. */
static void out_calibration(struct ctl *c, const struct store_calibration *k)
{
    const struct surface_calibration *d = &k->table;
    struct json *o = c->out;

    json_text(o, "source", k->shipped ? "shipped" : "database");
    json_score(o, "threshold", d->threshold);
    json_rate(o, "fmr", k->fmr);
    if (!k->shipped) {
        json_score(o, "low", k->low);
        json_score(o, "high", k->high);
        json_number(o, "subjects", (double)k->subjects);
        json_number(o, "non_mated", (double)k->impostors);
        json_number(o, "mated", (double)k->genuine);
        describe_det(o, "det", &k->det);
    }
    json_number(o, "people", people(c, k));
    show_knots(o, "table", d);
}

static void out_result(struct ctl *c, const struct result *r)
{
    struct json *o = c->out;

    out_calibration(c, &r->k);
    json_number(o, "templates", r->cross.ntemplate);
    json_number(o, "pairs", (double)r->pairs);
    json_number(o, "replicates", RATES_REPLICATES);
    json_number(o, "seed", (double)SEED);
    json_object(o, "shipped");
    json_score(o, "threshold", surface_model_calibration(c->model)->threshold);
    json_rate(o, "fmr", r->shipped_fmr);
    if (r->k.genuine > 0)
        json_rate(o, "fnmr", r->shipped_fnmr);
    json_close(o);
    if (r->k.genuine > 0) {
        json_rate(o, "fnmr", r->fnmr);
        json_rate(o, "fnmr_low", r->fnmr_low);
        json_rate(o, "fnmr_high", r->fnmr_high);
    }
    json_number(o, "suspicious", (double)r->suspects);
    if (r->tail.subjects == 0)
        return;
    json_object(o, "tail");
    json_score(o, "score", r->tail.score);
    json_number(o, "subjects", r->tail.subjects);
    json_number(o, "pairs", (double)pairs_of(r->tail.subjects));
    json_number(o, "compared", (double)r->tail.compared);
    json_close(o);
}

static void print_suspects(const struct ctl *c, const struct result *r)
{
    if (r->suspects > 0)
        (void)printf(
            "suspicious   %zu comparisons of two subjects score %.2f or more, as "
            "one person's scans do (false\n"
            "             match rate %g).  They are counted as different people: "
            "surfacectl dedup lists them\n",
            r->suspects, suspicious(c)->score, suspicious(c)->rate);
}

/* How many people can be searched for one, and at which score. */
static void print_search(const struct ctl *c, const struct result *r)
{
    const struct surface_calibration d = table_of(c, &r->k);
    const uint32_t n = r->cross.nenrolled, most = surface_search_people(&d);
    const uint32_t among = n < most ? n : most;
    const double at = surface_search_threshold(&d, among);

    (void)printf("identify     %.2f among %u people%s%s\n", at, among,
                 at > d.knot[d.n - 1].score ? ", by the shipped law beyond the table"
                                            : "",
                 n <= most ? "" : "; among more never a match");
}

/* How often the own people are refused, by how often others match. */
static void print_det(const struct det *d)
{
    if (d->n == 0) {
        (void)printf(
            "\nno error trade-off (DET): %u of the people have two templates, and "
            "%d are needed\n",
            d->people, DET_PEOPLE);
        return;
    }
    (void)printf(
        "\n  other people match    score     do not match of %u people's own scans, "
        "95 %% interval\n",
        d->people);
    for (uint32_t i = 0; i < d->n; i++)
        (void)printf("  %16.4g %%  %7.2f  %12.3g %%  %.3g to %.3g %%\n",
                     100 * d->point[i].fmr, d->point[i].score, 100 * d->point[i].fnmr,
                     100 * d->point[i].low, 100 * d->point[i].high);
}

static void print_result(const struct ctl *c, const struct result *r)
{
    const struct ctl_cross *p = &r->cross;
    const struct store_calibration *k = &r->k;
    const struct surface_calibration *d = &k->table;

    (void)printf("subjects     %u%s, %" PRIu64 " template%s\n", p->nsubject,
                 p->nenrolled > p->nsubject ? " of more, drawn" : "",
                 CTL_COUNT(p->ntemplate));
    (void)printf("non-mated    %llu comparisons of %zu pairs of subjects\n",
                 (unsigned long long)k->impostors, r->pairs);
    (void)printf("threshold    %.2f for a false match rate of %g %%\n", d->threshold,
                 100 * k->fmr);
    (void)printf("             95 %% interval %.2f to %.2f (%d bootstrap replicates over "
                 "subjects, seed %llu)\n",
                 k->low, k->high, RATES_REPLICATES, (unsigned long long)SEED);
    if (r->tail.subjects > 0)
        (void)printf(
            "tail         from %.2f on of all %zu pairs of subjects: searched, and "
            "%" PRIu64 " compared\n",
            r->tail.score, pairs_of(r->tail.subjects), r->tail.compared);
    print_search(c, r);
    (void)printf("shipped      %.2f: %.3g %% here\n",
                 surface_model_calibration(c->model)->threshold, 100 * r->shipped_fmr);
    if (k->genuine > 0)
        (void)printf(
            "mated        %llu comparisons: %.3g %% do not match, 95 %% interval %.3g to "
            "%.3g %%; %.3g %% by the shipped threshold\n",
            (unsigned long long)k->genuine, 100 * r->fnmr, 100 * r->fnmr_low,
            100 * r->fnmr_high, 100 * r->shipped_fnmr);
    else
        (void)printf("mated        none: the false non-match rate is unknown\n");
    (void)printf("\n  false match rate      score\n");
    for (uint32_t i = 0; i < d->n; i++)
        (void)printf("  %14.4g %%  %7.2f\n", 100 * d->knot[i].rate, d->knot[i].score);
    print_det(&k->det);
    print_suspects(c, r);
}

/* ---- the command */

/* A lower threshold than the one in force lets more other people match: only when that is
 * confirmed.  A calibration in force that is damaged decides nothing, so that none is laxer. */
static enum status may_store(struct ctl *c, const struct store_calibration *k)
{
    struct store_calibration now;
    char what[160];
    const enum status st = store_calibration_current(c->store, &now, &c->e);

    if (st != ST_OK)
        return st == ST_ECORRUPT ? ST_OK : st;
    if (k->table.threshold >= now.table.threshold)
        return ST_OK;
    (void)snprintf(
        what, sizeof what,
        "lowers the threshold from %.2f to %.2f, so that more other people match",
        now.table.threshold, k->table.threshold);
    if (!c->dry_run)
        return ctl_confirm(c, what, "accept");
    json_flag(c->out, "needs_yes", true);
    ctl_say(c, "\nthis %s: it needs --yes\n", what);
    return ST_OK;
}

static enum status store_it(struct ctl *c, struct store_calibration *k)
{
    enum status st = may_store(c, k);

    if (st == ST_OK && !c->dry_run)
        st = store_calibration_add(c->store, c->actor, k, &c->e);
    if (st != ST_OK)
        return st;
    json_flag(c->out, "stored", !c->dry_run);
    if (!c->dry_run)
        json_number(c->out, "version", (double)k->version);
    if (c->dry_run)
        ctl_say(c, "\nnothing was stored (--dry-run)\n");
    else
        ctl_say(c, "\nversion %lld is in force\n", (long long)k->version);
    return ST_OK;
}

static enum status calibrate(struct ctl *c)
{
    struct result r = {0};
    enum status st = compare_all(c, &r);

    if (st == ST_OK)
        st = learn(c, &r);
    if (st == ST_OK) {
        out_result(c, &r);
        if (!c->json)
            print_result(c, &r);
        st = store_it(c, &r.k);
    }
    rates_free(r.rates);
    ctl_cross_free(&r.cross);
    return st;
}

static enum status reset(struct ctl *c)
{
    const struct surface_calibration *d = surface_model_calibration(c->model);
    struct store_calibration k = {.shipped = true,
                                  .fmr = surface_calibration_rate(d, d->threshold),
                                  .low = d->threshold,
                                  .high = d->threshold,
                                  .table = *d};

    out_calibration(c, &k);
    ctl_say(c, "the shipped calibration is in force: %.2f\n", d->threshold);
    return store_it(c, &k);
}

static enum status ctl_calibrate_list(struct ctl *c)
{
    struct store_calibration *k, now;
    size_t n;
    enum status st = store_calibration_list(c->store, &k, &n, &c->e);

    if (st != ST_OK)
        return st;
    if ((st = store_calibration_current(c->store, &now, &c->e)) != ST_OK)
        goto out;
    json_array(c->out, "calibrations");
    ctl_say(c, "%7s  %-24s  %-8s  %9s  %-15s  %7s  %8s  %8s\n", "VERSION", "CREATED",
            "SOURCE", "THRESHOLD", "INTERVAL", "FMR", "SUBJECTS", "IDENTIFY");
    for (size_t i = 0; i < n; i++) {
        json_object(c->out, NULL);
        json_number(c->out, "version", (double)k[i].version);
        json_text(c->out, "created", k[i].created);
        json_text(c->out, "actor", k[i].actor);
        json_text(c->out, "engine", k[i].engine);
        out_calibration(c, &k[i]);
        json_close(c->out);
        ctl_say(c, "%7lld  %-24s  %-8s  %9.2f  %6.2f - %6.2f  %7.2g  %8llu  %8u\n",
                (long long)k[i].version, k[i].created,
                k[i].shipped ? "shipped" : "database", k[i].table.threshold, k[i].low,
                k[i].high, k[i].fmr, (unsigned long long)k[i].subjects, people(c, &k[i]));
    }
    json_close(c->out);
    json_object(c->out, "in_force");
    json_number(c->out, "version", (double)now.version);
    json_text(c->out, "source", now.shipped ? "shipped" : "database");
    json_score(c->out, "threshold", now.table.threshold);
    json_close(c->out);
    ctl_say(c, "in force: %s, %.2f\n",
            now.shipped ? "the shipped calibration" : "the newest", now.table.threshold);
out:
    free(k);
    return st;
}

static enum status ctl_calibrate_run(struct ctl *c)
{
    const bool learns = !wants_list && !wants_reset;
    enum status st;

    if ((wants_list && wants_reset) || (!learns && wanted_fmr > 0) ||
        (wants_list && (c->dry_run || c->yes)))
        return ctl_usage(c, "--list takes no other option of calibrate, and --reset only "
                            "--dry-run and --yes");
    if (!(wanted_fmr > 0))
        wanted_fmr = DEFAULT_FMR;
    st = ctl_model_open(c, wants_list || c->dry_run ? STORE_READ : STORE_WRITE);
    if (st != ST_OK)
        return st;
    return wants_list ? ctl_calibrate_list(c) : wants_reset ? reset(c) : calibrate(c);
}

const struct ctl_command ctl_calibrate = {
    .name = "calibrate",
    .args = "[--list | --reset]",
    .database = CTL_NEEDS_DATABASE,
    .shared = CTL_MODEL | CTL_THREADS | CTL_DRY_RUN | CTL_YES,
    .options = {CTL_OPTION("fmr", "RATE", command_rate, &wanted_fmr,
                           "the wanted false match rate (0.001)"),
                CTL_OPTION("list", NULL, command_flag, &wants_list,
                           "list the calibrations"),
                CTL_OPTION("reset", NULL, command_flag, &wants_reset,
                           "use the calibration that comes with the program")},
    .run = ctl_calibrate_run,
    .summary = "compute a threshold from the enrolled templates",
    .help =
        "Compares templates of different subjects; the threshold is the score that a share --fmr\n"
        "of these comparisons reaches. It is in force at once. A lower threshold than the one in\n"
        "force needs --yes, or accept typed on a terminal.",
    .example = "surfacectl --db faces.db calibrate --fmr 0.01 --dry-run"};
