#include <math.h>
#include <string.h>

#include "verdict.h"
#include "ctl_report.h"

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

static const char *type_name(enum corpus_pair type)
{
    return type == CORPUS_GENUINE    ? "genuine"
           : type == CORPUS_IMPOSTOR ? "impostor"
                                     : "relative";
}

static void write_trial(FILE *to, const struct corpus *c, const struct ctl_trial *x)
{
    const struct corpus_scan *template = &c->scan[x->template],
                             *probe = &c->scan[x->probe];
    const char *const field[] = {template->file, probe->file,
                                 c->subject[template->subject].id,
                                 c->subject[probe->subject].id, c->kind[probe->kind]};

    for (size_t i = 0; i < sizeof field / sizeof *field; i++) {
        text(to, field[i]);
        (void)fputc(',', to);
    }
    (void)fprintf(to, "%s,", type_name(x->type));
    if (!x->done) {
        (void)fprintf(to, "refused,,,,,,\n");
        return;
    }
    (void)fprintf(to, "%s,%.6f,%.6g,%.4g,%.4f,%.4f,", verdict_decision(x->decision),
                  x->disparity_mm, x->threshold_mm, x->fmr_at_score, x->overlap,
                  x->weight_overlap);
    if (!isnan(x->rotation_deg))
        (void)fprintf(to, "%.3f", x->rotation_deg);
    (void)fputc('\n', to);
}

enum status ctl_report_scores(FILE *to, const void *arg, struct errinfo *e)
{
    const struct ctl_report *r = arg;

    (void)e;
    (void)fprintf(to, "enrolled_file,probe_file,enrolled_subject,probe_subject,kind,type,"
                      "decision,disparity_mm,threshold_mm,fmr_at_score,overlap,"
                      "weight_overlap,rotation_deg\n");
    for (size_t i = 0; i < r->t->n; i++)
        write_trial(to, r->t->corpus, &r->t->trial[i]);
    return ST_OK;
}

double ctl_report_step(const struct ctl_report *r, size_t most, size_t *n)
{
    static const double factor[3] = {2, 2.5, 2}; /* 1, 2, 5, 10 */
    double largest = r->threshold_mm, step = 1e-4;

    for (size_t i = 0; i < r->t->n; i++)
        if (r->t->trial[i].done && r->t->trial[i].decision != FACE_INCONCLUSIVE)
            largest = fmax(largest, r->t->trial[i].disparity_mm);
    for (int i = 0; largest / step + 1 > (double)most; i++)
        step *= factor[i % 3];
    *n = (size_t)ceil(largest / step);
    return step;
}

enum status ctl_report_rates(FILE *to, const void *arg, struct errinfo *e)
{
    const struct ctl_report *r = arg;
    size_t n;
    const double step = ctl_report_step(r, THRESHOLDS, &n);

    (void)e;
    (void)fprintf(to, "threshold_mm,fmr,fnmr");
    for (uint32_t k = 1; k < r->ngroup; k++) {
        char name[CORPUS_MAX_NAME + 8];

        (void)snprintf(name, sizeof name, "fnmr_%s", r->group[k].name);
        (void)fputc(',', to);
        text(to, name);
    }
    (void)fputc('\n', to);
    for (size_t i = 0; i <= n; i++) {
        const double mm = (double)i * step;

        (void)fprintf(to, "%.4f,", mm);
        if (r->impostor.n > 0) /* else the rate is not known: an empty field */
            (void)fprintf(to, "%.8g", rates_fmr(r->group[0].rates, mm));
        for (uint32_t k = 0; k < r->ngroup; k++) {
            (void)fputc(',', to);
            if (r->group[k].genuine.n > 0)
                (void)fprintf(to, "%.8g", rates_fnmr(r->group[k].rates, mm));
        }
        (void)fputc('\n', to);
    }
    return ST_OK;
}
