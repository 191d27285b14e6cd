/* An evaluation as tables (RFC 4180), for other programs. */
#include "lab.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "report.h"

#define THRESHOLDS 2000
#define A_DECADE   20 /* rows of det.csv and methods.csv for a power of ten of the FMR */

/* A field, quoted where it must be. */
static void text(FILE *to, const char *s)
{
    if (strpbrk(s, ",\"\r\n") == NULL && s[0] != ' ' && s[0] != '\0' &&
        s[strlen(s) - 1] != ' ') {
        (void)fputs(s, to);
        return;
    }
    (void)fputc('"', to);
    for (; *s != '\0'; s++)
        (void)fprintf(to, "%s%c", *s == '"' ? "\"" : "", *s);
    (void)fputc('"', to);
}

/* A comma and a number, of so many decimals or so many digits; nothing behind the comma where
 * it is not known. */
static void fixed(FILE *to, int decimals, double value)
{
    (void)fputc(',', to);
    if (isfinite(value))
        (void)fprintf(to, "%.*f", decimals, value);
}

static void digits(FILE *to, int n, double value)
{
    (void)fputc(',', to);
    if (isfinite(value))
        (void)fprintf(to, "%.*g", n, value);
}

/* ---- scores.csv */

static const char *type_name(enum corpus_pair type)
{
    return type == CORPUS_GENUINE    ? "mated"
           : type == CORPUS_IMPOSTOR ? "non-mated"
                                     : "relative";
}

/* The files, the subjects, the kinds; of a scan that was refused one side is NULL. */
static void write_sides(FILE *to, const struct corpus *c,
                        const struct corpus_scan *template,
                        const struct corpus_scan *probe)
{
    const struct corpus_scan *const side[] = {template, probe};

    for (int field = 0; field < 3; field++)
        for (int i = 0; i < 2; i++) {
            if (side[i] != NULL)
                text(to, field == 0   ? side[i]->file
                         : field == 1 ? c->subject[side[i]->subject].id
                                      : c->kind[side[i]->kind]);
            (void)fputc(',', to);
        }
}

/* The numbers of a comparison that was not made. */
static void write_none(FILE *to)
{
    (void)fputs("refused", to);
    for (int i = 0; i < 5 + SURFACE_REGIONS; i++)
        (void)fputc(',', to);
}

static void write_trial(FILE *to, const struct trials *t, const struct trial *x)
{
    const struct corpus *c = t->corpus;
    enum status st;

    write_sides(to, c, &c->scan[x->template], &c->scan[x->probe]);
    (void)fprintf(to, "%s,", type_name(x->type));
    if (!x->done) {
        st = t->template[x->template].st;
        st = st != ST_OK ? st : t->probe[x->probe].st;
        write_none(to);
        (void)fprintf(to, ",%s,\n", status_refusal(st));
        return;
    }
    (void)fputs(lab_decision(x->decision), to);
    fixed(to, 6, x->score);
    fixed(to, 6, t->threshold);
    digits(to, 4, x->fmr_at_score);
    fixed(to, 4, (double)x->disparity_mm);
    fixed(to, 4, (double)x->overlap);
    for (int i = 0; i < SURFACE_REGIONS; i++)
        fixed(to, 4, (double)x->region[i]);
    (void)fputs(",,\n", to);
}

static void write_refused(FILE *to, const struct trials *t, bool template)
{
    const struct trials_scan *scan = template ? t->template : t->probe;
    const struct corpus *c = t->corpus;

    for (uint32_t i = 0; i < c->nscan; i++) {
        if (scan[i].st == ST_OK)
            continue;
        write_sides(to, c, template ? &c->scan[i] : NULL, template ? NULL : &c->scan[i]);
        (void)fprintf(to, "failure_to_%s,", template ? "enroll" : "acquire");
        write_none(to);
        (void)fprintf(to, ",%s,", status_refusal(scan[i].st));
        text(to, scan[i].why);
        (void)fputc('\n', to);
    }
}

enum status report_csv_scores(FILE *to, const void *arg, struct errinfo *e)
{
    const struct trials *t = ((const struct report *)arg)->t;

    (void)e;
    (void)fprintf(to, "template,probe,template_subject,probe_subject,template_kind,"
                      "probe_kind,comparison,decision,score,threshold,fmr_at_score,"
                      "disparity_mm,overlap");
    for (int i = 0; i < SURFACE_REGIONS; i++)
        (void)fprintf(to, ",region_%s", surface_region_name((enum surface_region)i));
    (void)fprintf(to, ",code,detail\n");
    for (size_t i = 0; i < t->n; i++)
        write_trial(to, t, &t->trial[i]);
    write_refused(to, t, true);
    write_refused(to, t, false);
    return ST_OK;
}

/* ---- matrix.csv */

static int by_cell(const void *a, const void *b)
{
    const struct trial *x = *(const struct trial *const *)a,
                       *y = *(const struct trial *const *)b;

    if (x->template != y->template)
        return x->template <y->template ? -1 : 1;
    return (x->probe > y->probe) - (x->probe < y->probe);
}

enum status report_csv_matrix(FILE *to, const void *arg, struct errinfo *e)
{
    const struct trials *t = ((const struct report *)arg)->t;
    const struct corpus *c = t->corpus;
    const struct trial **cell = malloc((t->n + 1) * sizeof *cell);
    size_t next = 0;

    if (cell == NULL)
        return errinfo_set(e, ST_ENOMEM, "matrix.csv: out of memory");
    for (size_t i = 0; i < t->n; i++)
        cell[i] = &t->trial[i];
    qsort(cell, t->n, sizeof *cell, by_cell);
    (void)fputs("template", to);
    for (uint32_t p = 0; p < c->nscan; p++)
        if (t->probe[p].used) {
            (void)fputc(',', to);
            text(to, c->scan[p].file);
        }
    (void)fputc('\n', to);
    for (uint32_t i = 0; i < c->nscan; i++) {
        if (!t->template[i].used)
            continue;
        text(to, c->scan[i].file);
        for (uint32_t p = 0; p < c->nscan; p++) {
            if (!t->probe[p].used)
                continue;
            if (next < t->n && cell[next]->template == i && cell[next]->probe == p)
                fixed(to, 6, cell[next]->done ? cell[next]->score : (double)NAN);
            else
                (void)fputc(',', to);
            while (next < t->n && cell[next]->template == i && cell[next]->probe == p)
                next++; /* a pair that is listed twice has one score */
        }
        (void)fputc('\n', to);
    }
    free(cell);
    return ST_OK;
}

/* ---- rates.csv */

/* Returns the step of thresholds, a round number, that leads from *from, at or below the lowest score, to
 * the highest in *n <= THRESHOLDS steps. */
static double step_of(const struct report *r, double *from, size_t *n)
{
    static const double factor[3] = {2, 2.5, 2}; /* 1, 2, 5, 10 */
    double low = r->t->threshold, high = low, step = 1e-2;

    for (size_t i = 0; i < r->t->n; i++)
        if (r->t->trial[i].done) {
            low = fmin(low, r->t->trial[i].score);
            high = fmax(high, r->t->trial[i].score);
        }
    for (int i = 0; (high - low) / step + 2 > THRESHOLDS; i++)
        step *= factor[i % 3];
    *from = floor(low / step) * step;
    *n = (size_t)ceil((high - *from) / step);
    return step;
}

enum status report_csv_rates(FILE *to, const void *arg, struct errinfo *e)
{
    const struct report *r = arg;
    size_t n;
    double from;
    const double step = step_of(r, &from, &n);

    (void)e;
    (void)fprintf(to, "threshold,fmr,fnmr");
    for (uint32_t k = 1; k < r->ngroup; k++) {
        char name[CORPUS_MAX_NAME + 8];

        (void)snprintf(name, sizeof name, "fnmr_%s", r->group[k].name);
        (void)fputc(',', to);
        text(to, name);
    }
    (void)fputc('\n', to);
    for (size_t i = 0; i <= n; i++) {
        const double score = from + (double)i * step;

        (void)fprintf(to, "%.4f", score);
        digits(to, 8, rates_fmr(r->group[0].curve[REPORT_SCORED].rates, score));
        for (uint32_t k = 0; k < r->ngroup; k++)
            digits(to, 8, rates_fnmr(r->group[k].curve[REPORT_SCORED].rates, score));
        (void)fputc('\n', to);
    }
    return ST_OK;
}

/* ---- det.csv and methods.csv: by FMR */

#define FMRS (5 * A_DECADE + 1)

/* The FMRs of the rows: from 1e-5 to 1. */
static void list_fmrs(double fmr[FMRS])
{
    for (int k = 0; k < FMRS; k++)
        fmr[k] = pow(10, (double)(k + 1 - FMRS) / A_DECADE);
}

/* At the least threshold that keeps the FMR. */
static void write_fnmr(FILE *to, const struct rates *rates, double fmr)
{
    const bool supported = rates_supported(fmr, rates_nimpostor(rates));

    digits(to, 6, supported ? rates_fnmr(rates, rates_at(rates, fmr)) : (double)NAN);
}

enum status report_csv_det(FILE *to, const void *arg, struct errinfo *e)
{
    const struct report *r = arg;
    const struct rates *all = r->group[0].curve[REPORT_SCORED].rates;
    double fmr[FMRS], low[FMRS], high[FMRS];
    enum status st;

    list_fmrs(fmr);
    st = rates_bootstrap_det(all, fmr, FMRS, RATES_REPLICATES, REPORT_SEED, low, high);
    if (st != ST_OK)
        return errinfo_set(e, st, "det.csv: %s", status_message(st));
    (void)fputs("fmr,fnmr,fnmr_low,fnmr_high", to);
    for (uint32_t k = 1; k < r->ngroup; k++) {
        (void)fputc(',', to);
        text(to, r->group[k].name);
    }
    (void)fputc('\n', to);
    for (int i = 0; i < FMRS; i++) {
        const bool known = rates_supported(fmr[i], rates_nimpostor(all));

        (void)fprintf(to, "%.6g", fmr[i]);
        write_fnmr(to, all, fmr[i]);
        digits(to, 6, known ? low[i] : (double)NAN);
        digits(to, 6, known ? high[i] : (double)NAN);
        for (uint32_t k = 1; k < r->ngroup; k++)
            write_fnmr(to, r->group[k].curve[REPORT_SCORED].rates, fmr[i]);
        (void)fputc('\n', to);
    }
    return ST_OK;
}

enum status report_csv_methods(FILE *to, const void *arg, struct errinfo *e)
{
    const struct report *r = arg;
    const struct report_curve *own = r->group[0].curve;
    double fmr[FMRS];

    (void)e;
    (void)fprintf(to, "fmr,surfaced");
    for (size_t i = 0; i < r->nmethod; i++) {
        (void)fputc(',', to);
        text(to, r->method[i].name);
    }
    (void)fputc('\n', to);
    list_fmrs(fmr);
    for (int k = 0; k < FMRS; k++) {
        (void)fprintf(to, "%.6g", fmr[k]);
        write_fnmr(to,
                   own[own[REPORT_ALL].rates != NULL ? REPORT_ALL : REPORT_SCORED].rates,
                   fmr[k]);
        for (size_t i = 0; i < r->nmethod; i++)
            write_fnmr(to, r->method[i].curve.rates, fmr[k]);
        (void)fputc('\n', to);
    }
    return ST_OK;
}

/* ---- sets.csv */

static void write_rate(FILE *to, const struct report_rate *x)
{
    digits(to, 6, x->value);
    digits(to, 6, x->low);
    digits(to, 6, x->high);
    (void)fprintf(to, ",%zu", x->n);
}

static void write_curve(FILE *to, const struct report *r, const struct report_curve *g)
{
    (void)fprintf(to, ",%zu", g->n);
    digits(to, 6, g->f.eer);
    digits(to, 6, g->low.eer);
    digits(to, 6, g->high.eer);
    for (int k = 0; k < RATES_TARGETS; k++) {
        const bool known = rates_supported(rates_target[k], r->non_mated.n);

        digits(to, 6, known ? g->f.tar[k] : (double)NAN);
        digits(to, 6, known ? g->low.tar[k] : (double)NAN);
        digits(to, 6, known ? g->high.tar[k] : (double)NAN);
    }
}

enum status report_csv_sets(FILE *to, const void *sets, struct errinfo *e)
{
    static const char *const rate[] = {"fte", "fta", "fnmr", "frr", "fmr", "far"};
    static const char *const curve[] = {"", "_with_refusals"};
    const struct report_list *list = sets;

    (void)e;
    (void)fprintf(to, "scans,engine,threshold,subjects");
    for (size_t i = 0; i < sizeof rate / sizeof *rate; i++)
        (void)fprintf(to, ",%s,%s_low,%s_high,%s_of", rate[i], rate[i], rate[i], rate[i]);
    for (int i = 0; i < REPORT_OF; i++) {
        (void)fprintf(to, ",mated%s,eer%s,eer%s_low,eer%s_high", curve[i], curve[i],
                      curve[i], curve[i]);
        for (int k = 0; k < RATES_TARGETS; k++)
            (void)fprintf(to, ",tar_at_%g%s,tar_at_%g%s_low,tar_at_%g%s_high",
                          rates_target[k], curve[i], rates_target[k], curve[i],
                          rates_target[k], curve[i]);
    }
    (void)fputc('\n', to);
    for (size_t i = 0; i < list->n; i++) {
        const struct report *r = &list->report[i];
        const struct report_group *all = &r->group[0];

        text(to, r->source);
        (void)fputc(',', to);
        text(to, r->engine);
        fixed(to, 6, r->t->threshold);
        (void)fprintf(to, ",%u", r->t->corpus->nsubject);
        write_rate(to, &r->fte);
        write_rate(to, &all->fta);
        write_rate(to, &all->fnmr);
        write_rate(to, &all->frr);
        write_rate(to, &r->fmr);
        write_rate(to, &r->far);
        for (int k = 0; k < REPORT_OF; k++)
            write_curve(to, r, &all->curve[k]);
        (void)fputc('\n', to);
    }
    return ST_OK;
}
