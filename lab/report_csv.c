/* An evaluation as tables (RFC 4180), for other programs. */
#include "lab.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "report.h"

#define THRESHOLDS 2000

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
