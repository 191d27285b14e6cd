#include "report_plot.h"

#include <math.h>
#include <string.h>

#include "plot.h"
#include "report.h"
#include "report_text.h"

#define POINTS 4000
#define BINS   250 /* at most */

/* A word of the user's in gnuplot's single quotes, in which only they mean anything. */
static void quoted(FILE *to, const char *s)
{
    (void)fputc('\'', to);
    for (; *s != '\0'; s++)
        (void)fprintf(to, "%s%c", *s == '\'' ? "'" : "", *s);
    (void)fputc('\'', to);
}

/* rows: of the legend, below the picture, where it hides nothing. */
static void begin(FILE *to, const struct report_plot *p, unsigned rows)
{
    const bool svg = strcmp(p->format, "svg") == 0;

    (void)fprintf(
        to,
        "set encoding utf8\n"
        "set terminal %s noenhanced size %s font 'DejaVu Sans,%d' %s\n"
        "set border lw 1 lc rgb '#444444'\n"
        "set grid lw 1 lc rgb '#dddddd'\n"
        "set tics nomirror out textcolor rgb '#222222'\n"
        "set key outside bottom center vertical maxrows %u Left reverse height 1\n",
        p->format, svg ? "900,760" : "1350,1140", svg ? 13 : 20,
        svg ? "background rgb 'white'" : "background rgb 'white' linewidth 1.5", rows);
}

/* The largest power of ten that the number of comparisons still reaches: an axis's end. */
static double floor_of(size_t n)
{
    return n > 0 ? pow(10, floor(log10(1 / (double)n) + 1e-9)) : 0.001;
}

static double within(double x, double low, double high)
{
    return fmax(low, fmin(high, x));
}

static void ticks(FILE *to, const char *axis)
{
    static const double at[] = {1e-5, 1e-4, 1e-3, 0.01, 0.02, 0.05, 0.1,
                                0.2,  0.4,  0.6,  0.8,  0.9,  0.98, 0.999};

    (void)fprintf(to, "set %stics (", axis);
    for (size_t i = 0; i < sizeof at / sizeof *at; i++)
        (void)fprintf(to, "%s'%g' invnorm(%g)", i > 0 ? ", " : "", 100 * at[i], at[i]);
    (void)fprintf(to, ")\n");
}

/* ---- the trade-off between the errors */

#define MOST 0.98 /* the largest rate that is drawn */

/* A rate as it is drawn: where no error was seen, its bound. */
static double drawn(double rate, size_t n)
{
    return fmin(rate > 0 ? rate : rates_least(n), MOST);
}

/* The curve of a group where both errors were seen, and its bound where not, at the changes
 * alone.  An empty line parts the pieces of a bound. */
static void det_curve(FILE *to, const struct report *r, uint32_t k, bool seen)
{
    const struct report_group *g = &r->group[k];
    double last_x = -1, last_y = -1;
    bool gap = false;
    size_t n;
    const double step = report_step(r, POINTS, &n);

    (void)fprintf(to, "$%s%u << EOD\n", seen ? "curve" : "bound", k);
    for (size_t i = 0; i <= n; i++) {
        const double fmr = rates_fmr(g->rates, (double)i * step),
                     fnmr = rates_fnmr(g->rates, (double)i * step);
        const double x = fmax(fmin(fmr, MOST), seen ? 0 : drawn(0, r->non_mated.n)),
                     y = fmax(fmin(fnmr, MOST), seen ? 0 : drawn(0, g->mated.n));

        if ((fmr > 0 && fnmr > 0) != seen) {
            gap = last_x >= 0;
            continue;
        }
        if (x != last_x || y != last_y || gap)
            (void)fprintf(to, "%s%.8g %.8g\n", gap ? "\n" : "", x, y);
        last_x = x;
        last_y = y;
        gap = false;
    }
    /* Never empty, which gnuplot refuses. */
    (void)fprintf(to, "%sEOD\n", last_x < 0 ? "NaN NaN\n" : "");
}

static void det_data(FILE *to, const struct report *r)
{
    for (uint32_t k = 0; k < r->ngroup; k++) {
        const struct report_group *g = &r->group[k];

        det_curve(to, r, k, true);
        det_curve(to, r, k, false);
        (void)fprintf(to, "$point%u << EOD\n%.8g %.8g\nEOD\n", k,
                      drawn(g->f.fmr, r->non_mated.n), drawn(g->f.fnmr, g->mated.n));
    }
}

/* All in black, the kinds in colours that the colour-blind can tell apart too. */
static const char *color(uint32_t group)
{
    static const char *const name[] = {"rgb '#000000'", "rgb '#0072b2'", "rgb '#d55e00'",
                                       "rgb '#009e73'", "rgb '#cc79a7'", "rgb '#56b4e9'",
                                       "rgb '#e69f00'"};
    const uint32_t n = sizeof name / sizeof *name - 1;

    return name[group == 0 ? 0 : 1 + (group - 1) % n];
}

/* What can be said, in words. */
static void det_title(FILE *to, const struct report *r)
{
    const struct report_group *all = &r->group[0];

    (void)fprintf(to,
                  "set title \"Detection error trade-off: %zu mated, %zu non-mated "
                  "comparisons\\nat the threshold: FMR %s, FNMR %s",
                  all->mated.n, r->non_mated.n, report_text_rate(&r->match).s,
                  report_text_rate(&all->unmatched).s);
    if (all->f.eer <= 0)
        (void)fprintf(
            to, "\\n%s",
            fmax(rates_least(r->non_mated.n), rates_least(all->mated.n)) < MOST
                ? "No error at some thresholds: the rates are below the dashed "
                  "bound (95 %)"
                : "No error at some thresholds: too few comparisons to say more");
    (void)fprintf(to, "\"\n");
}

/* An axis to where so many comparisons reach; grey what they cannot state. */
static void det_axis(FILE *to, char axis, size_t n, double most)
{
    const double from = fmin(floor_of(n), 0.1), least = rates_least(n);
    const bool x = axis == 'x';

    (void)fprintf(to, "set %crange [invnorm(%g):invnorm(%g)]\n", axis, from, most);
    ticks(to, x ? "x" : "y");
    if (least >= most)
        return;
    (void)fprintf(
        to,
        x ? "set object 1 rectangle from invnorm(%g), graph 0 to invnorm(%g), graph 1 "
          : "set object 2 rectangle from graph 0, first invnorm(%g) to graph 1, first "
            "invnorm(%g) ",
        from, least);
    (void)fprintf(to, "fc rgb '#f2f2f2' fs solid noborder behind\n");
    (void)fprintf(to,
                  x ? "set label 1 'FMR below 3 / %zu: too few comparisons to state' at "
                      "graph 0, 0.97 right rotate by 90 offset character 1.2, 0 "
                    : "set label 2 'FNMR below 3 / %zu: too few comparisons to state' at "
                      "graph 0.98, 0 right offset character 0, 0.8 ",
                  n);
    (void)fprintf(to, "textcolor rgb '#777777'\n");
}

static void det_script(FILE *to, const void *arg)
{
    const struct report_plot *p = arg;
    const struct report *r = p->r;
    double most = 0.6;

    for (uint32_t k = 0; k < r->ngroup; k++) /* room for the threshold's points */
        if (drawn(r->group[k].f.fnmr, r->group[k].mated.n) > 0.5 ||
            drawn(r->group[k].f.fmr, r->non_mated.n) > 0.5)
            most = MOST;
    begin(to, p, (r->ngroup + 5) / 2); /* two columns */
    det_data(to, r);
    det_title(to, r);
    det_axis(to, 'x', r->non_mated.n, most);
    det_axis(to, 'y', r->group[0].mated.n, most);
    (void)fprintf(to, "set xlabel 'false match rate FMR, %%'\n"
                      "set ylabel 'false non-match rate FNMR, %%'\nplot ");
    for (uint32_t k = r->ngroup; k-- > 0;) { /* all lies on top */
        const struct report_group *g = &r->group[k];
        const int width = k == 0 ? 3 : 2;

        (void)fprintf(to, "$curve%u using (invnorm($1)):(invnorm($2)) with lines ", k);
        (void)fprintf(to, "lw %d lc %s title ", width, color(k));
        quoted(to, g->name);
        (void)fprintf(
            to,
            ", $bound%u using (invnorm($1)):(invnorm($2)) with lines lw %d dt 2 "
            "lc %s notitle, $point%u using (invnorm($1)):(invnorm($2)) with "
            "points pt %d ps 1.4 lw 2 lc %s notitle, ",
            k, width, color(k), k, g->f.fmr > 0 && g->f.fnmr > 0 ? 7 : 6, color(k));
    }
    (void)fprintf(
        to,
        "x with lines dt 3 lc rgb '#999999' title 'equal error', "
        "NaN with points pt 7 ps 1.4 lc rgb '#777777' title 'threshold %.3g mm', NaN with points pt 6 ps 1.4 lw 2 lc rgb '#777777' title 'no error there', NaN with lines lw 2 dt 2 lc rgb '#777777' title 'bound 3 / N, no error seen'\n",
        r->threshold_mm);
}

/* ---- the scores */

/* Shares of the comparisons of a type that lie in each bin, per cent; returns the largest,
 * 0 where there are none. */
static double bins(FILE *to, const struct report *r, enum corpus_pair type,
                   const char *name, double width, size_t n)
{
    size_t count[BINS + 2] = {0}, all = 0, most = 0;

    for (size_t i = 0; i < r->t->n; i++) {
        const struct ctl_trial *x = &r->t->trial[i];

        if (!x->done || x->type != type || x->decision == FACE_INCONCLUSIVE)
            continue;
        count[(size_t)within(x->calibrated_mm / width, 0, (double)n)]++;
        all++;
    }
    (void)fprintf(to, "$%s << EOD\n", name);
    for (size_t i = 0; i <= n && all > 0; i++) {
        (void)fprintf(to, "%.6g %.6g\n", ((double)i + 0.5) * width,
                      100 * (double)count[i] / (double)all);
        most = count[i] > most ? count[i] : most;
    }
    (void)fprintf(to, "EOD\n");
    return all > 0 ? 100 * (double)most / (double)all : 0;
}

/* How many bins hold all but one in 500 of the scores: a few far ones would make the
 * picture small.  They are counted in the last bin. */
static size_t most_bins(const struct report *r, double width, size_t n)
{
    size_t left = (r->t->n - r->undone) / 500, beyond = 0;

    while (n > 1 && (double)n * width > 1.5 * r->threshold_mm) {
        beyond = 0;
        for (size_t i = 0; i < r->t->n; i++)
            beyond += r->t->trial[i].done &&
                      r->t->trial[i].decision != FACE_INCONCLUSIVE &&
                      r->t->trial[i].calibrated_mm > (double)n * width;
        if (beyond > left)
            break;
        n--;
    }
    return n;
}

static void scores_script(FILE *to, const void *arg)
{
    static const struct {
        enum corpus_pair type;
        const char *name, *title, *color;
    } series[] = {{CORPUS_IMPOSTOR, "non_mated", "non-mated", "#d95f02"},
                  {CORPUS_GENUINE, "mated", "mated", "#1b9e77"},
                  {CORPUS_RELATIVE, "relative", "close relatives", "#7570b3"}};
    const struct report_plot *p = arg;
    const struct report *r = p->r;
    double share[3], most = 0;
    size_t n, whole;
    const double wanted = within(4 * cbrt((double)r->t->n), 40, BINS);
    const double width = report_step(r, (size_t)wanted, &n);

    begin(to, p, 2);
    whole = n;
    n = most_bins(r, width, n);
    for (int i = 0; i < 3; i++)
        most =
            fmax(most, share[i] = bins(to, r, series[i].type, series[i].name, width, n));
    (void)fprintf(to,
                  "set title 'Scores: %zu mated, %zu non-mated comparisons, %zu "
                  "inconclusive left out'\n"
                  "set xlabel 'comparison score, mm%s'\n"
                  "set ylabel 'share of the comparisons in each %g mm, %%'\n"
                  "set xrange [0:%g]\nset yrange [0:%g]\n"
                  "set boxwidth %g\n"
                  "set arrow 1 from %g, graph 0 to %g, graph 1 nohead lw 2 dt 2 lc rgb "
                  "'black' front\nplot ",
                  r->group[0].mated.n, r->non_mated.n,
                  r->group[0].mated.inconclusive + r->non_mated.inconclusive +
                      r->relative.inconclusive,
                  n < whole ? " (the last bar: all beyond)" : "", width,
                  width * (double)(n + 1), 1.08 * most, width, r->threshold_mm,
                  r->threshold_mm);
    for (int i = 0; i < 2; i++)
        if (share[i] > 0)
            (void)fprintf(to,
                          "$%s with boxes fs transparent solid 0.5 noborder fc rgb '%s' "
                          "title '%s', ",
                          series[i].name, series[i].color, series[i].title);
    if (share[2] > 0)
        (void)fprintf(to, "$%s with histeps lw 2 lc rgb '%s' title '%s', ",
                      series[2].name, series[2].color, series[2].title);
    (void)fprintf(to,
                  "NaN with lines lw 2 dt 2 lc rgb 'black' title 'threshold %.3g mm'\n",
                  r->threshold_mm);
}

enum status report_plot_det(FILE *to, const void *p, struct errinfo *e)
{
    return plot_run(fileno(to), det_script, p, e);
}

enum status report_plot_scores(FILE *to, const void *p, struct errinfo *e)
{
    return plot_run(fileno(to), scores_script, p, e);
}
