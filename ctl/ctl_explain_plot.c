#include <math.h>

#include "mem.h"
#include "plot.h"
#include "ctl.h"
#include "ctl_explain.h"

#define SHADES 48 /* of the colour scale beside the picture */

/* What is drawn and what with. */
struct drawing {
    const struct explanation *x;
    const struct explain_map *map;
};

static void print_color(FILE *to, double gap_mm)
{
    uint8_t rgb[3];

    ctl_explain_color(gap_mm, rgb);
    (void)fprintf(to, "'#%02x%02x%02x'", rgb[0], rgb[1], rgb[2]);
}

/* The decision in words; the names of files and subjects stay out of the pictures. */
static void print_title(FILE *to, const struct face_result *r)
{
    static const char *const words[] = {[FACE_MATCH] = "Match",
                                        [FACE_NO_MATCH] = "No match",
                                        [FACE_INCONCLUSIVE] = "Inconclusive"};

    (void)fprintf(to,
                  "set title \"{/:Bold*1.25 %s}\\ndisparity %.3f mm, threshold %.3f mm",
                  words[r->decision], r->score_mm, r->threshold_mm);
    (void)fprintf(to, ", common area %.0f %%\"\n", 100 * r->disparity.overlap);
}

static void picture_script(FILE *to, const void *arg)
{
    const struct explanation *x = ((const struct drawing *)arg)->x;
    const struct explain_map *map = ((const struct drawing *)arg)->map;
    const double wide = map->w * map->pixel_mm, high = map->h * map->pixel_mm;
    const double width = fmax(300, fmin(1, wide / high) * 820) + 340; /* for the title */
    const double height = fmin(1, high / wide) * 820 + 220;

    (void)fprintf(to, "set terminal pngcairo size %.0f,%.0f font 'Sans,13'\n", width,
                  height);
    (void)fprintf(to, "set encoding utf8\n");
    print_title(to, &x->result);
    (void)fprintf(
        to,
        "set size ratio -1\nset tics out nomirror tc rgb 'black'\nset grid lc rgb '#d8d8d8'\n"
        "set border lc rgb '#606060'\nset xtics 20\nset ytics 20\n"
        "set xlabel \"x in mm\\n{/*0.85 grey: the probe is there, but nothing "
        "to compare it with}\"\nset ylabel 'y in mm'\n"
        "set xrange [%g:%g]\nset yrange [%g:%g]\n",
        map->x_mm - 5, map->x_mm + wide + 5, map->y_mm - 5, map->y_mm + high + 5);
    (void)fprintf(to, "set palette defined (");
    for (int k = 0; k <= SHADES; k++) {
        const double gap = (2.0 * k / SHADES - 1) * EXPLAIN_SCALE_MM;

        (void)fprintf(to, "%s%g ", k > 0 ? ", " : "", gap);
        print_color(to, gap);
    }
    (void)fprintf(to,
                  ")\nset palette maxcolors 0\nset cbrange [%g:%g]\nset cbtics 1 out\n"
                  "set cblabel 'probe minus template in mm  "
                  "(blue: behind it, red: in front of it)' offset 1\n",
                  -EXPLAIN_SCALE_MM, EXPLAIN_SCALE_MM);
    /* The second plot draws nothing: it is there for the colour scale. */
    (void)fprintf(to,
                  "plot '-' binary array=(%u,%u) origin=(%g,%g) dx=%g dy=%g "
                  "format='%%uchar' using 1:2:3:4 with rgbalpha notitle, "
                  "NaN with points palette notitle\n",
                  map->w, map->h, map->x_mm, map->y_mm, map->pixel_mm, map->pixel_mm);
    (void)fwrite(map->rgba, sizeof *map->rgba, (size_t)map->w * map->h, to);
}

enum status ctl_explain_picture(FILE *to, const struct explanation *x, struct errinfo *e)
{
    struct explain_map map;
    const struct drawing d = {x, &map};
    enum status st = ctl_explain_map(x, &map);

    if (st != ST_OK)
        return errinfo_set(e, st, "%s", status_message(st));
    st = plot_run(fileno(to), picture_script, &d, e);
    mem_free(map.rgba);
    return st;
}

static void histogram_script(FILE *to, const void *arg)
{
    const struct explanation *x = ((const struct drawing *)arg)->x;
    const struct explain_gap *s = &x->sum;
    const double width = 2 * EXPLAIN_SCALE_MM / EXPLAIN_BINS;

    (void)fprintf(to, "set terminal pngcairo size 1000,620 font 'Sans,13'\n"
                      "set encoding utf8\n");
    print_title(to, &x->result);
    (void)fprintf(
        to,
        "set border 3 lc rgb '#606060'\nset tics out nomirror tc rgb 'black'\n"
        "set grid ytics lc rgb '#d8d8d8'\nset style fill solid border rgb "
        "'#606060'\nset boxwidth %g\nset xrange [%g:%g]\nset yrange [0:*]\n"
        "set xtics 0.5\nset xtics add ('≤ -%g' -%g, '≥ %g' %g)\nset format y '%%g %%%%'\n"
        "set xlabel \"probe minus template in mm  (behind it < 0 < in front of it)\"\n"
        "set ylabel 'share of the points compared'\n"
        "set key top left Left reverse noautotitle samplen 2\n",
        width, -EXPLAIN_SCALE_MM, EXPLAIN_SCALE_MM, EXPLAIN_SCALE_MM, EXPLAIN_SCALE_MM,
        EXPLAIN_SCALE_MM, EXPLAIN_SCALE_MM);
    for (int side = -1; side <= 1; side += 2)
        (void)fprintf(
            to,
            "set arrow from first %g,graph 0 to first %g,graph 1 nohead dt 2 lc "
            "rgb '#808080'\n",
            side * EXPLAIN_BEYOND_MM, side * EXPLAIN_BEYOND_MM);
    if (s->compared > 0)
        (void)fprintf(
            to,
            "set arrow from first %.4f,graph 0 to first %.4f,graph 1 nohead lw 2 "
            "lc rgb 'black' front\n",
            s->median_mm, s->median_mm);
    (void)fprintf(to, "$bar << EOD\n");
    for (int k = 0; k < EXPLAIN_BINS; k++) {
        const double mm = (k + 0.5) * width - EXPLAIN_SCALE_MM;
        uint8_t rgb[3];

        ctl_explain_color(mm, rgb);
        (void)fprintf(to, "%.3f %.6g %d\n", mm,
                      s->compared > 0 ? 100.0 * (double)s->bin[k] / (double)s->compared
                                      : 0,
                      rgb[0] << 16 | rgb[1] << 8 | rgb[2]);
    }
    (void)fprintf(to, "EOD\nplot $bar using 1:2:3 with boxes fc rgb variable, "
                      "NaN with lines lw 2 lc rgb 'black' title ");
    if (s->compared > 0)
        (void)fprintf(to, "'median %+.3f mm', ", s->median_mm);
    else
        (void)fprintf(to, "'nothing to compare', ");
    (void)fprintf(to,
                  "NaN with lines dt 2 lc rgb '#808080' title '%.1f %% beyond %g mm'\n",
                  s->compared > 0 ? 100 * s->beyond : 0, EXPLAIN_BEYOND_MM);
}

enum status ctl_explain_histogram(FILE *to, const struct explanation *x,
                                  struct errinfo *e)
{
    const struct drawing d = {x, NULL};

    return plot_run(fileno(to), histogram_script, &d, e);
}
