#include <math.h>
#include <string.h>

#include "plot.h"
#include "ctl_report.h"

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

static void begin(FILE *to, const struct ctl_report_picture *p)
{
    const bool svg = strcmp(p->format, "svg") == 0;

    (void)fprintf(to,
                  "set encoding utf8\n"
                  "set terminal %s noenhanced size %s font 'DejaVu Sans,%d' %s\n"
                  "set border lw 1 lc rgb '#444444'\n"
                  "set grid lw 1 lc rgb '#dddddd'\n"
                  "set tics nomirror out textcolor rgb '#222222'\n",
                  p->format, svg ? "900,720" : "1350,1080", svg ? 13 : 20,
                  svg ? "background rgb 'white'"
                      : "background rgb 'white' linewidth 1.5");
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

/* The curve of each group, at its changes alone.  What is 0 is drawn on the axis. */
static void det_data(FILE *to, const struct ctl_report *r, double x0, double y0)
{
    const double most = 0.9999;
    size_t n;
    const double step = ctl_report_step(r, POINTS, &n);

    for (uint32_t k = 0; k < r->ngroup; k++) {
        double last_x = -1, last_y = -1;

        (void)fprintf(to, "$curve%u << EOD\n", k);
        for (size_t i = 0; i <= n; i++) {
            const double mm = (double)i * step;
            const double x = within(rates_fmr(r->group[k].rates, mm), x0, most),
                         y = within(rates_fnmr(r->group[k].rates, mm), y0, most);

            if (x != last_x || y != last_y)
                (void)fprintf(to, "%.8g %.8g\n", x, y);
            last_x = x;
            last_y = y;
        }
        (void)fprintf(to, "EOD\n$point%u << EOD\n%.8g %.8g\nEOD\n", k,
                      within(rates_fmr(r->group[k].rates, r->threshold_mm), x0, most),
                      within(rates_fnmr(r->group[k].rates, r->threshold_mm), y0, most));
    }
}

/* All black, the kinds in colours that are told apart by the colour-blind too. */
static const char *color(uint32_t group)
{
    static const char *const name[] = {"rgb '#000000'", "rgb '#0072b2'", "rgb '#d55e00'",
                                       "rgb '#009e73'", "rgb '#cc79a7'", "rgb '#56b4e9'",
                                       "rgb '#e69f00'"};
    const uint32_t n = sizeof name / sizeof *name - 1;

    return name[group == 0 ? 0 : 1 + (group - 1) % n];
}

static void det_script(FILE *to, const void *arg)
{
    const struct ctl_report_picture *p = arg;
    const struct ctl_report *r = p->r;
    const double x0 = floor_of(r->impostor.n), y0 = floor_of(r->group[0].genuine.n);
    const double least = rates_least(r->impostor.n);
    double most = 0.6;

    for (uint32_t k = 0; k < r->ngroup; k++) /* room for the threshold's points */
        if (r->group[k].f.fnmr > 0.55 || r->group[k].f.fmr > 0.55)
            most = 0.98;
    begin(to, p);
    det_data(to, r, x0, y0);
    (void)fprintf(to,
                  "set title 'Detection error trade-off: %zu genuine, %zu impostor "
                  "comparisons'\n"
                  "set xlabel 'false match rate FMR, %%'\n"
                  "set ylabel 'false non-match rate FNMR, %%'\n"
                  "set xrange [invnorm(%g):invnorm(%g)]\n"
                  "set yrange [invnorm(%g):invnorm(%g)]\n"
                  "set key top right box lc rgb '#cccccc' opaque\n",
                  r->group[0].genuine.n, r->impostor.n, x0, most, y0, most);
    ticks(to, "x");
    ticks(to, "y");
    if (least < most)
        (void)fprintf(to,
                      "set object 1 rectangle from invnorm(%g), graph 0 to invnorm(%g), "
                      "graph 1 fc rgb '#f2f2f2' fs solid noborder behind\n"
                      "set label 1 ' too few comparisons to state' at invnorm(%g), graph "
                      "0.02 rotate by 90 textcolor rgb '#777777' offset character 1, 0\n",
                      x0, least, x0);
    (void)fprintf(to,
                  "set arrow 1 from invnorm(%g), invnorm(%g) to invnorm(%g), "
                  "invnorm(%g) nohead dt 3 lc rgb '#999999'\nplot ",
                  fmax(x0, y0), fmax(x0, y0), most, most);
    for (uint32_t k = r->ngroup; k-- > 0;) { /* all lies on top */
        (void)fprintf(to, "$curve%u using (invnorm($1)):(invnorm($2)) with lines ", k);
        (void)fprintf(to, "lw %d lc %s title ", k == 0 ? 3 : 2, color(k));
        quoted(to, r->group[k].name);
        (void)fprintf(to,
                      ", $point%u using (invnorm($1)):(invnorm($2)) with points pt 7 ps "
                      "1.2 lc %s notitle, ",
                      k, color(k));
    }
    (void)fprintf(to,
                  "NaN with points pt 7 ps 1.2 lc rgb '#777777' title 'threshold %.3g "
                  "mm', NaN with lines dt 3 lc rgb '#999999' title 'equal error'\n",
                  r->threshold_mm);
}

/* Shares of the comparisons of a type that lie in each bin. */
static bool bins(FILE *to, const struct ctl_report *r, enum corpus_pair type,
                 const char *name, double width, size_t n)
{
    size_t count[BINS + 2] = {0}, all = 0;

    for (size_t i = 0; i < r->t->n; i++) {
        const struct ctl_trial *x = &r->t->trial[i];

        if (!x->done || x->type != type || x->decision == FACE_INCONCLUSIVE)
            continue;
        count[(size_t)within(x->disparity_mm / width, 0, (double)n)]++;
        all++;
    }
    (void)fprintf(to, "$%s << EOD\n", name);
    for (size_t i = 0; i <= n && all > 0; i++)
        (void)fprintf(to, "%.6g %.6g\n", ((double)i + 0.5) * width,
                      100 * (double)count[i] / (double)all);
    (void)fprintf(to, "EOD\n");
    return all > 0;
}

/* How many bins hold all but one in 500 of the scores: a few far ones would make the
 * picture small.  They are counted in the last bin. */
static size_t most_bins(const struct ctl_report *r, double width, size_t n)
{
    size_t left = (r->t->n - r->undone) / 500, beyond = 0;

    while (n > 1 && (double)n * width > 1.5 * r->threshold_mm) {
        beyond = 0;
        for (size_t i = 0; i < r->t->n; i++)
            beyond += r->t->trial[i].done &&
                      r->t->trial[i].decision != FACE_INCONCLUSIVE &&
                      r->t->trial[i].disparity_mm > (double)n * width;
        if (beyond > left)
            break;
        n--;
    }
    return n;
}

static void histogram_script(FILE *to, const void *arg)
{
    static const struct {
        enum corpus_pair type;
        const char *name, *title, *color;
    } series[] = {{CORPUS_IMPOSTOR, "impostor", "different people", "#d95f02"},
                  {CORPUS_GENUINE, "genuine", "the same person", "#1b9e77"},
                  {CORPUS_RELATIVE, "relative", "close relatives", "#7570b3"}};
    const struct ctl_report_picture *p = arg;
    const struct ctl_report *r = p->r;
    bool any[3];
    size_t n, whole;
    const double wanted = within(4 * cbrt((double)r->t->n), 40, BINS);
    const double width = ctl_report_step(r, (size_t)wanted, &n);

    begin(to, p);
    whole = n;
    n = most_bins(r, width, n);
    for (int i = 0; i < 3; i++)
        any[i] = bins(to, r, series[i].type, series[i].name, width, n);
    (void)fprintf(to,
                  "set title 'Scores: %zu genuine, %zu impostor comparisons, %zu "
                  "inconclusive left out'\n"
                  "set xlabel 'disparity, mm%s'\n"
                  "set ylabel 'share of the comparisons in each %g mm, %%'\n"
                  "set xrange [0:%g]\nset yrange [0:*]\n"
                  "set key top right box lc rgb '#cccccc' opaque\n"
                  "set boxwidth %g\n"
                  "set arrow 1 from %g, graph 0 to %g, graph 1 nohead lw 2 dt 2 lc rgb "
                  "'black' front\nplot ",
                  r->group[0].genuine.n, r->impostor.n,
                  r->group[0].genuine.inconclusive + r->impostor.inconclusive +
                      r->relative.inconclusive,
                  n < whole ? " (the last bar: all beyond)" : "", width,
                  width * (double)(n + 1), width, r->threshold_mm, r->threshold_mm);
    for (int i = 0; i < 2; i++)
        if (any[i])
            (void)fprintf(to,
                          "$%s with boxes fs transparent solid 0.5 noborder fc rgb '%s' "
                          "title '%s', ",
                          series[i].name, series[i].color, series[i].title);
    if (any[2])
        (void)fprintf(to, "$%s with histeps lw 2 lc rgb '%s' title '%s', ",
                      series[2].name, series[2].color, series[2].title);
    (void)fprintf(to,
                  "NaN with lines lw 2 dt 2 lc rgb 'black' title 'threshold %.3g mm'\n",
                  r->threshold_mm);
}

enum status ctl_report_det(FILE *to, const void *p, struct errinfo *e)
{
    return plot_run(fileno(to), det_script, p, e);
}

enum status ctl_report_histogram(FILE *to, const void *p, struct errinfo *e)
{
    return plot_run(fileno(to), histogram_script, p, e);
}
