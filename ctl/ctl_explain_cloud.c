#include <math.h>
#include <string.h>

#include "bytes.h"
#include "ctl_explain.h"
#include "vec.h"

static unsigned char *put_float(unsigned char *to, double value)
{
    const float f = (float)value;
    uint32_t bits;

    memcpy(&bits, &f, sizeof bits);
    bytes_put_number(&to, bits, sizeof bits);
    return to;
}

enum status ctl_explain_cloud(FILE *to, const struct explanation *x, struct errinfo *e)
{
    (void)e;
    (void)fprintf(to,
                  "ply\n"
                  "format binary_little_endian 1.0\n"
                  "comment mm; gap_mm: probe minus template, nan: nothing to compare\n"
                  "comment colours: blue behind, red in front, full at %g mm; grey: nan\n"
                  "element vertex %zu\n"
                  "property float x\nproperty float y\nproperty float z\n"
                  "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                  "property float gap_mm\n"
                  "end_header\n",
                  EXPLAIN_SCALE_MM, x->n);
    for (size_t i = 0; i < x->n; i++) {
        unsigned char row[19], *at = row;

        at = put_float(at, x->pts[i].x);
        at = put_float(at, x->pts[i].y);
        at = put_float(at, x->pts[i].z);
        ctl_explain_color(x->gap[i], at);
        (void)put_float(at + 3, isnan(x->gap[i]) ? (double)NAN : x->gap[i]);
        (void)fwrite(row, sizeof row, 1, to);
    }
    return ST_OK;
}
