#include "explain_plot.h"

#include <math.h>

#include "explain_color.h"
#include "explain_map.h"
#include "plot.h"
#include "tuning.h"

#define SHADES 96  /* of each colour scale */
#define RIM_MM 5.0 /* round the face */

/* The picture, and in it the three columns and the two rows, as shares of it. */
#define PIXELS_X 1560.0
#define PIXELS_Y 1130.0
static const double column[EXPLAIN_KINDS] = {0.045, 0.375, 0.705};
#define WIDE     0.28
#define MAP_LOW  0.445
#define MAP_HIGH 0.86
#define SCALE_AT 0.388
#define BAR_LOW  0.08
#define BAR_HIGH 0.285

struct drawing {
    const struct explanation *x;
    const struct explain_map *map;
};

/* The decision and why; the names of files and subjects stay out of the picture. */
static void print_heading(FILE *to, const struct face_result *r)
{
    static const char *const words[] = {[FACE_MATCH] = "Match",
                                        [FACE_NO_MATCH] = "Non-match",
                                        [FACE_INCONCLUSIVE] = "Inconclusive"};

    (void)fprintf(to,
                  "set label 100 \"{/:Bold*1.8 %s}\" at screen 0.5,0.972 center\n"
                  "set label 101 \"{/*1.15 ",
                  words[r->decision]);
    if (!r->comparable)
        (void)fprintf(to, "too little in common to decide");
    else
        (void)fprintf(to, "score %.3f mm %s threshold %.3f mm%s", r->score_mm,
                      r->decision == FACE_MATCH ? "≤" : ">", r->threshold_mm,
                      r->decision == FACE_INCONCLUSIVE ? ", but a part is hidden" : "");
    (void)fprintf(to,
                  "}\\ncommon area %.0f %% (at least %.0f %%), %.0f %% of the weight (at "
                  "least %.0f %%)\" at screen 0.5,0.942 center\n",
                  100 * r->overlap, 100 * DECISION_MIN_OVERLAP, 100 * r->weight_overlap,
                  100 * DECISION_MIN_WEIGHT);
}

static void print_margins(FILE *to, double left, double right, double low, double high)
{
    (void)fprintf(to,
                  "set lmargin at screen %g\nset rmargin at screen %g\n"
                  "set bmargin at screen %g\nset tmargin at screen %g\n",
                  left, right, low, high);
}

/* ---- the three maps */

static void print_scale(FILE *to, const struct explanation *x, enum explain_kind kind)
{
    static const char *const label[EXPLAIN_KINDS] = {
        "mm (blue: probe behind, red: in front; grey: no value)",
        "mm (pale band: within the threshold)",
        "in thresholds (the mean over the face is score / threshold)"};
    const double end = explain_end(x, kind), low = kind == EXPLAIN_PART ? 0 : -end;
    const double t = x->result.threshold_mm;

    (void)fprintf(to, "set palette defined (");
    for (int k = 0; k <= SHADES; k++) {
        const double value = low + k * (end - low) / SHADES;
        uint8_t rgb[3];

        explain_color(kind, value, end, rgb);
        (void)fprintf(to, "%s%g '#%02x%02x%02x'", k > 0 ? ", " : "", value, rgb[0],
                      rgb[1], rgb[2]);
    }
    (void)fprintf(
        to,
        ")\nset palette maxcolors 0\nset cbrange [%g:%g]\n"
        "set colorbox horizontal user origin screen %g,%g size screen %g,0.014\n"
        "unset cbtics\nset cbtics 1 out nomirror scale 0.6 offset 0,0.4\n"
        "set cblabel '%s' offset 0,0.7\n",
        low, end, column[kind], SCALE_AT, WIDE, label[kind]);
    if (kind == EXPLAIN_REST) /* the threshold on either side of 0, and the ends */
        (void)fprintf(to,
                      "set cbtics ('-%.3f' %g, '-%.3f' %g, 0, '%.3f' %g, '%.3f' %g)\n",
                      end, -end, t, -t, t, t, end, end);
}

static void print_map(FILE *to, const struct explanation *x,
                      const struct explain_map *map, enum explain_kind kind)
{
    static const char *const title[EXPLAIN_KINDS] = {
        "{/:Bold The gap as measured}\\nit does not decide",
        "{/:Bold What is left without learned change}\\nof it the score is taken, by weight",
        "{/:Bold What each place adds to the score}\\nwith its weight"};
    const double wide = map->w * map->pixel_mm + 2 * RIM_MM,
                 high = map->h * map->pixel_mm + 2 * RIM_MM;
    /* As wide as it may be in the column at the row's height. */
    const double share =
        fmin(WIDE, (MAP_HIGH - MAP_LOW) * wide / high * PIXELS_Y / PIXELS_X);

    print_margins(to, column[kind] + (WIDE - share) / 2,
                  column[kind] + (WIDE + share) / 2, MAP_LOW, MAP_HIGH);
    print_scale(to, x, kind);
    (void)fprintf(to,
                  "set title \"%s\" offset 0,-0.4\n"
                  "set size ratio -1\nset tics out nomirror\nset xtics 40 format '%%g'\n"
                  "set ytics 40 format '%%g'\nset grid lc rgb '#d8d8d8'\nunset xlabel\n"
                  "%s\nset xrange [%g:%g]\nset yrange [%g:%g]\n",
                  title[kind],
                  kind == EXPLAIN_GAP ? "set ylabel 'mm' offset 1.5" : "unset ylabel",
                  map->x_mm - RIM_MM, map->x_mm + wide - RIM_MM, map->y_mm - RIM_MM,
                  map->y_mm + high - RIM_MM);
    /* The second plot draws nothing: it is there for the colour scale. */
    (void)fprintf(to,
                  "plot '-' binary array=(%u,%u) origin=(%g,%g) dx=%g dy=%g "
                  "format='%%uchar' using 1:2:3:4 with rgbalpha notitle, "
                  "NaN with points palette notitle\n",
                  map->w, map->h, map->x_mm, map->y_mm, map->pixel_mm, map->pixel_mm);
    (void)fwrite(map->rgba[kind], sizeof *map->rgba[kind], (size_t)map->w * map->h, to);
    (void)fprintf(to, "unset label 100\nunset label 101\n"); /* they are there by now */
}

/* ---- below them */

static int color_of(enum explain_kind kind, double value, double end)
{
    uint8_t rgb[3];

    explain_color(kind, value, end, rgb);
    return rgb[0] << 16 | rgb[1] << 8 | rgb[2];
}

/* How a field is spread, with a grey band from -limit to limit. */
static void print_spread(FILE *to, const struct explain_spread *s, enum explain_kind kind)
{
    const double width = 2 * s->end_mm / EXPLAIN_BINS;
    double most = 0.01;

    for (int k = 0; k < EXPLAIN_BINS; k++)
        most = fmax(most, s->bin[k]);
    print_margins(to, column[kind], column[kind] + WIDE, BAR_LOW, BAR_HIGH);
    (void)fprintf(
        to,
        "set size noratio\nunset colorbox\nset grid noxtics ytics\n"
        "set style fill solid noborder\nset boxwidth %g\n"
        "set xrange [%g:%g]\nset yrange [0:%g]\nset xtics auto\nset ytics auto\n"
        "set format y '%%g %%%%'\nunset ylabel\n"
        "set xlabel '%s (outer bars: and beyond)' offset 0,0.4\n"
        "set object 1 rectangle from %g,graph 0 to %g,graph 1 fc rgb '#e9e9e9' "
        "fs solid noborder behind\n",
        width, -s->end_mm, s->end_mm, 112 * most,
        kind == EXPLAIN_GAP ? "gap in mm, share of the points"
                            : "what is left in mm, share of the weight",
        -s->limit_mm, s->limit_mm);
    if (s->n > 0)
        (void)fprintf(
            to, "set title 'mean amount %.3f mm; grey: within %s%.3g mm' offset 0,-0.6\n",
            s->mean_mm, kind == EXPLAIN_REST ? "the threshold, " : "", s->limit_mm);
    else
        (void)fprintf(to, "set title 'nothing to compare'\n");
    (void)fprintf(to, "$bar << EOD\n");
    for (int k = 0; k < EXPLAIN_BINS; k++) {
        const double mm = (k + 0.5) * width - s->end_mm;

        (void)fprintf(to, "%.6g %.6g %d\n", mm, 100 * s->bin[k],
                      color_of(kind, mm, s->end_mm));
    }
    (void)fprintf(to,
                  "EOD\nplot $bar using 1:2:3 with boxes lc rgb variable fc rgb variable "
                  "notitle, $bar using 1:2 with histeps lw 0.7 lc rgb '#707070' notitle\n"
                  "unset object 1\n");
}

/* The score of the face and of each region of it, beside the threshold. */
static void print_regions(FILE *to, const struct face_result *r)
{
    double most = fmax(r->score_mm, r->threshold_mm);

    for (int k = 0; k < GRID_REGIONS; k++)
        most = fmax(most, isnan(r->region_mm[k]) ? 0 : r->region_mm[k]);
    print_margins(to, column[EXPLAIN_PART], column[EXPLAIN_PART] + WIDE, BAR_LOW,
                  BAR_HIGH);
    (void)fprintf(
        to,
        "set xrange [-0.6:%g]\nset yrange [0:%g]\nset boxwidth 0.7\n"
        "set format y '%%g'\nset xlabel 'score in mm, share of the weight' offset 0,-0.7\n"
        "set title 'score of the face and of its regions; dashed: threshold' "
        "offset 0,-0.6\n"
        "set arrow 1 from graph 0,first %g to graph 1,first %g nohead dt 2 lw 2 "
        "lc rgb 'black' front\n"
        "set xtics scale 0 font 'Sans,11' (\"face\\n100 %%%%\" 0",
        GRID_REGIONS + 0.6, 1.15 * most, r->threshold_mm, r->threshold_mm);
    for (int k = 0; k < GRID_REGIONS; k++)
        (void)fprintf(to, ", \"%s\\n%.0f %%%%\" %d",
                      grid_region_name((enum grid_region)k), 100 * r->region_weight[k],
                      k + 1);
    (void)fprintf(to, ")\n$region << EOD\n0 %.6g %d\n", r->score_mm,
                  color_of(EXPLAIN_PART, r->score_mm / r->threshold_mm, EXPLAIN_TIMES));
    for (int k = 0; k < GRID_REGIONS; k++)
        if (!isnan(r->region_mm[k]))
            (void)fprintf(
                to, "%d %.6g %d\n", k + 1, r->region_mm[k],
                color_of(EXPLAIN_PART, r->region_mm[k] / r->threshold_mm, EXPLAIN_TIMES));
    (void)fprintf(to, "EOD\nset style fill solid border rgb '#707070'\n"
                      "plot $region using 1:2:3 with boxes fc rgb variable notitle\n");
}

static void script(FILE *to, const void *arg)
{
    const struct drawing *d = arg;

    (void)fprintf(to,
                  "set terminal pngcairo size %g,%g font 'Sans,12'\n"
                  "set encoding utf8\nset border lc rgb '#606060'\n"
                  "set multiplot\n",
                  PIXELS_X, PIXELS_Y);
    print_heading(to, &d->x->result);
    for (int k = 0; k < EXPLAIN_KINDS; k++)
        print_map(to, d->x, d->map, (enum explain_kind)k);
    print_spread(to, &d->x->gap, EXPLAIN_GAP);
    print_spread(to, &d->x->rest, EXPLAIN_REST);
    print_regions(to, &d->x->result);
    (void)fprintf(to, "unset multiplot\n");
}

enum status explain_plot(FILE *to, const void *x, struct errinfo *e)
{
    struct explain_map map;
    const struct drawing d = {x, &map};
    enum status st = explain_map(x, &map);

    if (st != ST_OK)
        return errinfo_set(e, st, "%s", status_message(st));
    st = plot_run(fileno(to), script, &d, e);
    explain_map_free(&map);
    return st;
}
