#include "explain_cloud.h"

#include <math.h>
#include <string.h>

#include "bytes.h"
#include "explain.h"
#include "explain_color.h"

static unsigned char *put_float(unsigned char *to, double value)
{
    const float f = isnan(value) ? NAN : (float)value; /* one NaN, without a sign */
    uint32_t bits;

    memcpy(&bits, &f, sizeof bits);
    bytes_put_number(&to, bits, sizeof bits);
    return to;
}

enum status explain_cloud(FILE *to, const void *arg, struct errinfo *e)
{
    const struct explanation *x = arg;
    const double end = explain_end(EXPLAIN_PART);

    (void)e;
    (void)fprintf(
        to,
        "ply\n"
        "format binary_little_endian 1.0\n"
        "comment the probe's points on the template, mm\n"
        "comment gap_mm: as measured, probe minus template; it does not decide\n"
        "comment cell_mm: of the cell there, each face in its own frame; of it the score\n"
        "comment part: what the cell there adds to the score\n"
        "comment nan: no value; colours: part, purple below 0, green above, full at %g, "
        "grey: nan\n"
        "element vertex %zu\n"
        "property float x\nproperty float y\nproperty float z\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\n"
        "property float gap_mm\nproperty float cell_mm\nproperty float part\n"
        "end_header\n",
        end, x->n);
    for (size_t i = 0; i < x->n; i++) {
        unsigned char row[27], *at = row;

        at = put_float(at, x->pts[i].x);
        at = put_float(at, x->pts[i].y);
        at = put_float(at, x->pts[i].z);
        explain_color(EXPLAIN_PART, x->value[EXPLAIN_PART][i], end, at);
        at += 3;
        for (int k = 0; k < EXPLAIN_KINDS; k++)
            at = put_float(at, x->value[k][i]);
        (void)fwrite(row, sizeof row, 1, to);
    }
    return ST_OK;
}
