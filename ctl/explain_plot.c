#include "explain_plot.h"

#include <math.h>

#include "explain_color.h"
#include "explain_map.h"
#include "plot.h"

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
    double score, threshold;

    face_shown(r, 100, &score, &threshold);

    (void)fprintf(to,
                  "set label 100 \"{/:Bold*1.8 %s}\" at screen 0.5,0.972 center\n"
                  "set label 101 \"{/*1.15 ",
                  words[r->decision]);
    (void)fprintf(to,
                  "score %.2f %s threshold %.2f%s}\\ncommon area %.0f %%\" at screen "
                  "0.5,0.942 center\n",
                  score, r->decision == FACE_MATCH ? "≥" : "<", threshold,
                  r->decision == FACE_INCONCLUSIVE ? ": too little to tell" : "",
                  100 * r->overlap);
}

static void print_margins(FILE *to, double left, double right, double low, double high)
{
    (void)fprintf(to,
                  "set lmargin at screen %g\nset rmargin at screen %g\n"
                  "set bmargin at screen %g\nset tmargin at screen %g\n",
                  left, right, low, high);
}

/* ---- the three maps */

static void print_scale(FILE *to, enum explain_kind kind)
{
    static const char *const label[EXPLAIN_KINDS] = {
        "mm (blue: probe behind, red: in front; grey: no value)",
        "mm (blue: probe behind, red: in front; grey: no value)",
        "score of a cell (green: for one person, purple: for two)"};
    const double end = explain_end(kind);

    (void)fprintf(to, "set palette defined (");
    for (int k = 0; k <= SHADES; k++) {
        const double value = -end + 2 * k * end / SHADES;
        uint8_t rgb[3];

        explain_color(kind, value, end, rgb);
        (void)fprintf(to, "%s%g '#%02x%02x%02x'", k > 0 ? ", " : "", value, rgb[0],
                      rgb[1], rgb[2]);
    }
    (void)fprintf(
        to,
        ")\nset palette maxcolors 0\nset cbrange [%g:%g]\n"
        "set colorbox horizontal user origin screen %g,%g size screen %g,0.014\n"
        "unset cbtics\nset cbtics %g out nomirror scale 0.6 offset 0,0.4\n"
        "set cblabel '%s' offset 0,0.7\n",
        -end, end, column[kind], SCALE_AT, WIDE, kind == EXPLAIN_PART ? end / 2 : 1,
        label[kind]);
}

static void print_map(FILE *to, const struct explain_map *map, enum explain_kind kind)
{
    static const char *const title[EXPLAIN_KINDS] = {
        "{/:Bold The gap as measured}\\nit does not decide",
        "{/:Bold The gap by cells, each face in its own frame}\\nof it the score is taken",
        "{/:Bold What each place adds to the score}\\nthe sum decides"};
    const double wide = map->w * map->pixel_mm + 2 * RIM_MM,
                 high = map->h * map->pixel_mm + 2 * RIM_MM;
    /* As wide as it may be in the column at the row's height. */
    const double share =
        fmin(WIDE, (MAP_HIGH - MAP_LOW) * wide / high * PIXELS_Y / PIXELS_X);

    print_margins(to, column[kind] + (WIDE - share) / 2,
                  column[kind] + (WIDE + share) / 2, MAP_LOW, MAP_HIGH);
    print_scale(to, kind);
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

/* How a field is spread, with a grey band of what is not far. */
static void print_spread(FILE *to, const struct explain_spread *s, enum explain_kind kind)
{
    const double end = EXPLAIN_GAP_MM, width = 2 * end / EXPLAIN_BINS;
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
        width, -end, end, 112 * most,
        kind == EXPLAIN_GAP ? "gap in mm, share of the points"
                            : "gap in mm, share of the cells",
        -EXPLAIN_BEYOND_MM, EXPLAIN_BEYOND_MM);
    if (s->n > 0)
        (void)fprintf(
            to, "set title 'mean amount %.3f mm; grey: within %.3g mm' offset 0,-0.6\n",
            s->mean_mm, EXPLAIN_BEYOND_MM);
    else
        (void)fprintf(to, "set title 'nothing to compare'\n");
    (void)fprintf(to, "$bar << EOD\n");
    for (int k = 0; k < EXPLAIN_BINS; k++) {
        const double mm = (k + 0.5) * width - end;

        (void)fprintf(to, "%.6g %.6g %d\n", mm, 100 * s->bin[k], color_of(kind, mm, end));
    }
    (void)fprintf(to,
                  "EOD\nplot $bar using 1:2:3 with boxes lc rgb variable fc rgb variable "
                  "notitle, $bar using 1:2 with histeps lw 0.7 lc rgb '#707070' notitle\n"
                  "unset object 1\n");
}

/* Each region's part of the score. */
static void print_regions(FILE *to, const double region[GRID_REGIONS])
{
    double low = 0, high = 0;

    for (int k = 0; k < GRID_REGIONS; k++)
        if (!isnan(region[k])) {
            low = fmin(low, region[k]);
            high = fmax(high, region[k]);
        }
    print_margins(to, column[EXPLAIN_PART], column[EXPLAIN_PART] + WIDE, BAR_LOW,
                  BAR_HIGH);
    (void)fprintf(to,
                  "set xrange [-0.6:%g]\nset yrange [%g:%g]\nset boxwidth 0.7\n"
                  "set format y '%%g'\nset xlabel 'part of the score' offset 0,-0.7\n"
                  "set title 'the score, by region' offset 0,-0.6\n"
                  "set xtics scale 0 font 'Sans,11' (",
                  GRID_REGIONS - 0.4, 1.15 * low - 0.1, 1.15 * high + 0.1);
    for (int k = 0; k < GRID_REGIONS; k++)
        (void)fprintf(to, "%s\"%s\" %d", k > 0 ? ", " : "",
                      grid_region_name((enum grid_region)k), k);
    (void)fprintf(to, ")\n$region << EOD\n");
    for (int k = 0; k < GRID_REGIONS; k++)
        if (!isnan(region[k]))
            (void)fprintf(to, "%d %.6g %d\n", k, region[k],
                          color_of(EXPLAIN_PART, region[k], fmax(-low, high)));
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
        print_map(to, d->map, (enum explain_kind)k);
    print_spread(to, &d->x->gap, EXPLAIN_GAP);
    print_spread(to, &d->x->cell, EXPLAIN_CELL);
    print_regions(to, d->x->result.region);
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
