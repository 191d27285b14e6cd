/* mirror.c -- asymmetry (the disparity-measure paper's section 4, its [9]): made-up faces
 * with a planted asymmetry, scanned several times: does the estimate follow what was
 * planted, does it agree with itself, is the plane found? */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "asymmetry.h"
#include "face.h"
#include "facegen.h"
#include "lab.h"
#include "study.h"

#define SIDE 200 /* the face's heights, every millimetre */

struct planted {
    double height[SIDE][SIDE];
};

static double height_at(const struct planted *p, double x, double y)
{
    const double u = x + SIDE / 2.0, v = y + SIDE / 2.0;
    const int i = (int)u, j = (int)v;
    const double s = u - i, t = v - j;

    return (1 - t) * ((1 - s) * p->height[j][i] + s * p->height[j][i + 1]) +
           t * ((1 - s) * p->height[j + 1][i] + s * p->height[j + 1][i + 1]);
}

/* By definition: the mean gap over an oval of the face and its image in the plane
 * (1, n[0], n[1]) . p = n[2], the normal to scale. */
static double gap_in(const struct planted *p, const double n[3])
{
    const double length = sqrt(1 + n[0] * n[0] + n[1] * n[1]);
    const double e[3] = {1 / length, n[0] / length, n[1] / length};
    double sum = 0, count = 0;

    for (int y = -75; y < 79; y += 2)
        for (int x = -62; x < 63; x += 2) {
            const double z = height_at(p, x, y);
            const double off = 2 * (e[0] * x + e[1] * y + e[2] * z - n[2]);

            if (x * x / (62.0 * 62) + (y - 2) * (y - 2) / (77.0 * 77) > 1)
                continue;
            sum += fabs(z - off * e[2] - height_at(p, x - off * e[0], y - off * e[1]));
            count++;
        }
    return sum / count;
}

/* The least of it over the planes near x = 0, by trying: what is there to be found. */
static double least_gap(struct planted *p, const struct facegen_scan *s, double n[3])
{
    struct facegen_face f;
    double best;

    facegen_face(s->subject, 0, &f);
    f.symmetry = s->symmetry;
    for (int j = 0; j < SIDE; j++)
        for (int i = 0; i < SIDE; i++)
            p->height[j][i] = facegen_height(&f, i - SIDE / 2, j - SIDE / 2);
    memset(n, 0, 3 * sizeof *n);
    best = gap_in(p, n);
    for (double by = 0.016; by > 2e-4; by /= 2)
        for (int k = 0, failed = 0; failed < 6; k = (k + 1) % 6) {
            const double was = n[k / 2], d = k / 2 == 2 ? 40 * by : by;
            double gap;

            n[k / 2] += k % 2 ? d : -d;
            if ((gap = gap_in(p, n)) < best) {
                best = gap;
                failed = 0;
            } else {
                n[k / 2] = was;
                failed++;
            }
        }
    return best;
}

/* The angle between the plane's normal as found and as the head's, turned with it. */
static double angle(const struct facegen_scan *s, const double found[3],
                    const double n[3])
{
    const double rad = acos(-1.0) / 180;
    const double cy = cos(s->yaw * rad), sy = sin(s->yaw * rad);
    const double cx = cos(s->pitch * rad), sx = sin(s->pitch * rad);
    const double cz = cos(s->roll * rad), sz = sin(s->roll * rad);
    const double v[3] = {1, n[0], n[1]};
    const double a[3] = {cy * v[0] + sy * v[2], v[1], cy * v[2] - sy * v[0]};
    const double b[3] = {a[0], cx * a[1] - sx * a[2], sx * a[1] + cx * a[2]};
    const double c[3] = {cz * b[0] - sz * b[1], sz * b[0] + cz * b[1], b[2]};
    const double length = sqrt(1 + n[0] * n[0] + n[1] * n[1]);

    return acos(fmin((found[0] * c[0] + found[1] * c[1] + found[2] * c[2]) / length, 1)) /
           rad;
}

static double correlation(const double *x, const double *y, size_t n)
{
    double mx = 0, my = 0, xx = 0, xy = 0, yy = 0;

    for (size_t i = 0; i < n; i++) {
        mx += x[i] / (double)n;
        my += y[i] / (double)n;
    }
    for (size_t i = 0; i < n; i++) {
        xx += (x[i] - mx) * (x[i] - mx);
        xy += (x[i] - mx) * (y[i] - my);
        yy += (y[i] - my) * (y[i] - my);
    }
    return xy / sqrt(xx * yy);
}

void mirror_run(const struct lab *lab)
{
    enum { SUBJECTS = 16, LEVELS = 5, SCANS = 4, MOST = SUBJECTS * LEVELS * SCANS };
    const int subjects = lab->reduced ? 4 : SUBJECTS, scans = lab->reduced ? 2 : SCANS;
    struct face_work *w = face_work_new(NULL);
    struct planted *p = lab_alloc(1, sizeof *p);
    struct dvec3 *pts = lab_alloc(3000, sizeof *pts);
    double *x = lab_alloc(MOST, sizeof *x), *y = lab_alloc(MOST, sizeof *y);
    double *first = lab_alloc(MOST, sizeof *first), *off = lab_alloc(MOST, sizeof *off);
    double *spread = lab_alloc(SUBJECTS * LEVELS, sizeof *spread);
    FILE *f = lab_open(lab, "scans.csv"), *sum = lab_open(lab, "summary.csv");
    struct face face = {0};
    size_t n = 0, faces = 0;

    if (w == NULL)
        lab_must(ST_ENOMEM);
    fprintf(f,
            "subject,asymmetry times,planted mm,first mm,final mm,plane error degrees\n");
    for (int i = 0; i < subjects * LEVELS; i++) {
        double plane[3], truth, low = INFINITY, high = 0;
        struct facegen_scan s;

        facegen_default(&s);
        s.subject = (uint64_t)(1 + i / LEVELS);
        s.symmetry = 1 - 0.5 * (i % LEVELS);
        truth = least_gap(p, &s, plane);
        for (int k = 0; k < scans; k++, n++) {
            struct asymmetry a;

            s.scan = (uint64_t)(scans * i + k);
            facegen_pose(&s, 12, 10);
            lab_must(face_build(pts, facegen_sample(&s, pts), w, &face, NULL));
            lab_must(face_asymmetry(&face, w, &a));
            x[n] = truth;
            y[n] = a.final.plain_mm;
            first[n] = a.initial.plain_mm;
            off[n] = angle(&s, a.normal, plane);
            low = fmin(low, y[n]);
            high = fmax(high, y[n]);
            fprintf(f, "%d,%g,%.4f,%.4f,%.4f,%.4f\n", (int)s.subject, 1 - s.symmetry,
                    truth, first[n], y[n], off[n]);
        }
        spread[faces++] = high - low;
    }
    fprintf(sum, "what,wanted,here\n");
    fprintf(sum, "correlation of the first estimate with what was planted,,%.4f\n",
            correlation(x, first, n));
    fprintf(sum, "of the final one,0.98 at least,%.4f\n", correlation(x, y, n));
    fprintf(sum, "plane: median error degrees,,%.3f\n", lab_spread(off, n).median);
    fprintf(sum, "plane: largest error degrees,0.5,%.3f\n",
            off[n - 1]); /* (sorted now) */
    fprintf(sum, "%d scans of one face differ by: median mm,,%.3f\n", scans,
            lab_spread(spread, faces).median);
    fprintf(sum, "by: most mm,,%.3f\n", spread[faces - 1]);
    lab_close(f);
    lab_close(sum);
    face_free(&face);
    face_work_free(w);
    free(p);
    free(pts);
    free(x);
    free(y);
    free(first);
    free(off);
    free(spread);
}
