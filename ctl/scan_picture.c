#include "scan_picture.h"

#include <math.h>

#include "advice.h"
#include "cloudunit.h"
#include "errinfo.h"
#include "plot.h"
#include "scan.h"

#define PIXELS_X 1240.0
#define PIXELS_Y 880.0
#define ADVICE_Y 0.13 /* of the first line, as a share of the picture */
#define LINE     0.027

struct pictures {
    const struct scan_picture *p;
    struct scan_canvas points, face;
};

static void print_heading(FILE *to, const struct scan_picture *p)
{
    const struct scan_found *f = p->drawn.found;

    (void)fprintf(to,
                  "set label 1 \"{/:Bold*1.7 %s}\" at screen 0.5,0.968 center\n"
                  "set label 2 \"%s\" at screen 0.5,0.934 center noenhanced\n",
                  p->verdict, p->reason);
    (void)fprintf(to, "set label 3 \"unit %s",
                  f->unit_mm > 0 ? cloudunit_name(f->unit_mm) : "not known");
    if (!isnan(f->yaw_deg))
        (void)fprintf(to, " · yaw %.0f°", f->yaw_deg);
    if (!isnan(p->quality))
        (void)fprintf(to, " · quality %.2f", p->quality);
    if (f->occluded > 0)
        (void)fprintf(to, " · %.0f %% of the face covered", 100 * f->occluded);
    if (f->elsewhere > 0)
        (void)fprintf(to, " · %.0f %% of the points elsewhere", 100 * f->elsewhere);
    (void)fprintf(to, "\" at screen 0.5,0.908 center\n");
}

static void print_advice(FILE *to, const struct advice *a)
{
    for (size_t i = 0; i < a->n && (double)i * LINE < ADVICE_Y; i++)
        (void)fprintf(to, "set label %zu \"• %s\" at screen 0.06,%g noenhanced\n", 10 + i,
                      a->line[i], ADVICE_Y - (double)i * LINE);
}

/* What the colours on the right are. */
static void print_key(FILE *to)
{
    static const struct {
        const char *text;
        int rgb;
    } key[] = {{"covered", SCAN_CANVAS_COVERED}, {"not measured", SCAN_CANVAS_EMPTY}};

    for (int i = 0; i < 2; i++)
        (void)fprintf(to,
                      "set object %d rectangle from screen %g,0.173 to screen %g,0.187 "
                      "fc rgb '#%06x' fs solid noborder\n"
                      "set label %d \"%s\" at screen %g,0.18\n",
                      i + 1, 0.6 + 0.17 * i, 0.612 + 0.17 * i, (unsigned)key[i].rgb,
                      40 + i, key[i].text, 0.618 + 0.17 * i);
}

static void print_canvas(FILE *to, const struct scan_canvas *c, double left,
                         const char *title, const char *unit)
{
    (void)fprintf(
        to,
        "set lmargin at screen %g\nset rmargin at screen %g\n"
        "set bmargin at screen 0.255\nset tmargin at screen 0.825\n"
        "set title \"%s\" offset 0,-0.4\nset size ratio -1\n"
        "set tics out nomirror font 'Sans,11'\nset format '%%g'\nset grid lc rgb '#e4e4e4'\n"
        "set xlabel 'x, %s' offset 0,0.6\nset ylabel 'y' offset 1.5\n"
        "set xrange [%.9g:%.9g]\nset yrange [%.9g:%.9g]\n",
        left, left + 0.42, title, unit, c->x - c->step / 2, c->x + (c->w - 0.5) * c->step,
        c->y - c->step / 2, c->y + (c->h - 0.5) * c->step);
    (void)fprintf(to,
                  "plot '-' binary array=(%u,%u) origin=(%.9g,%.9g) dx=%.9g dy=%.9g "
                  "format='%%uchar' using 1:2:3:4 with rgbalpha notitle\n",
                  c->w, c->h, c->x, c->y, c->step, c->step);
    (void)fwrite(c->rgba, sizeof *c->rgba, (size_t)c->w * c->h, to);
    (void)fprintf(to, "\n");
}

static void script(FILE *to, const void *arg)
{
    const struct pictures *s = arg;
    const struct scan_drawn *d = &s->p->drawn;
    const struct scan_found *f = d->found;
    const char *unit = cloudunit_name(f->unit_mm);
    char title[120];

    (void)fprintf(to,
                  "set terminal pngcairo size %g,%g font 'Sans,12'\nset encoding utf8\n"
                  "set border lc rgb '#606060'\nset multiplot\n",
                  PIXELS_X, PIXELS_Y);
    print_heading(to, s->p);
    print_advice(to, s->p->advice);
    (void)snprintf(title, sizeof title,
                   "{/:Bold As delivered}\\n%zu points, %zu without a value",
                   f->points_read, f->points_dropped);
    print_canvas(to, &s->points, 0.07, title, unit[0] != '\0' ? unit : "units");
    (void)fprintf(to, "unset label\n");
    if (d->face != NULL) {
        (void)snprintf(title, sizeof title,
                       "{/:Bold The face, from the front}\\n%zu points", f->points_used);
        print_key(to);
    } else {
        (void)snprintf(title, sizeof title, "{/:Bold %s}\\n",
                       f->found ? "What was taken for a face" : "No face was found");
    }
    print_canvas(to, &s->face, 0.55, title, "mm");
    (void)fprintf(to, "unset multiplot\n");
}

enum status scan_picture(FILE *to, const void *p, struct errinfo *e)
{
    struct pictures s = {.p = p};
    enum status st = scan_canvas_points(&s.p->drawn, &s.points);

    if (st == ST_OK)
        st = scan_canvas_face(&s.p->drawn, &s.face);
    st = st == ST_OK ? plot_run(fileno(to), script, &s, e)
                     : errinfo_set(e, st, "%s", status_message(st));
    scan_canvas_free(&s.points);
    scan_canvas_free(&s.face);
    return st;
}
