#include "report_csv.h"

#include <math.h>
#include <string.h>

#include "report.h"
#include "verdict.h"

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
    return type == CORPUS_GENUINE    ? "mated"
           : type == CORPUS_IMPOSTOR ? "non-mated"
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
                  x->score_mm, x->threshold_mm, x->fmr_at_score, x->overlap,
                  x->weight_overlap);
    if (!isnan(x->rotation_deg))
        (void)fprintf(to, "%.3f", x->rotation_deg);
    (void)fputc('\n', to);
}

enum status report_csv_scores(FILE *to, const void *arg, struct errinfo *e)
{
    const struct report *r = arg;

    (void)e;
    (void)fprintf(to, "enrolled_file,probe_file,enrolled_subject,probe_subject,kind,type,"
                      "decision,disparity_mm,threshold_mm,fmr_at_score,overlap,"
                      "weight_overlap,rotation_deg\n");
    for (size_t i = 0; i < r->t->n; i++)
        write_trial(to, r->t->corpus, &r->t->trial[i]);
    return ST_OK;
}

enum status report_csv_rates(FILE *to, const void *arg, struct errinfo *e)
{
    const struct report *r = arg;
    size_t n;
    const double step = report_step(r, THRESHOLDS, &n);

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
        if (r->non_mated.n > 0) /* else the rate is not known: an empty field */
            (void)fprintf(to, "%.8g", rates_fmr(r->group[0].rates, mm));
        for (uint32_t k = 0; k < r->ngroup; k++) {
            (void)fputc(',', to);
            if (r->group[k].mated.n > 0)
                (void)fprintf(to, "%.8g", rates_fnmr(r->group[k].rates, mm));
        }
        (void)fputc('\n', to);
    }
    return ST_OK;
}
