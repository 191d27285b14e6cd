/* cloudheading.h -- the names above the columns of a text file with points.  For cloudxyz.c. */
#ifndef SCAN_CLOUDHEADING_H
#define SCAN_CLOUDHEADING_H
#include <stdbool.h>
#include "status.h"

struct cloudtext; /* cloudtext.h */

struct cloudheading {
    int column[6];   /* of x, y, z, nx, ny, nz; of a normal -1 where there is none */
    unsigned last;   /* of these columns */
    unsigned fields; /* names in the heading that is still to be settled; 0: none */
    char separator;  /* ' ', ',', ';' or a tab, by the heading; 0: any, by each line */
    bool normals;
    double unit_mm; /* as in "x (cm)"; 0: it is not said */
};

/* Without a heading: the first three columns. */
#define CLOUDHEADING_NONE                                                                \
    {                                                                                    \
        .column = {0, 1, 2, -1, -1, -1}, .last = 2                                       \
    }

/* cloudheading_is(t): does the line begin with a word, and not with NaN? */
bool cloudheading_is(const struct cloudtext *t);

/* cloudheading_take(h, t, comment): the line at t as a heading; t does not move.  Names are
 * x, y, z, with a unit behind them or without, and Points:0, Points:1, Points:2; nx, ny, nz or
 * normal_x, normal_y, normal_z; in any case, quoted or not.  A line without them is no
 * heading: the first three columns.
 * Returns ST_OK; ST_EINVAL it separates columns by commas, semicolons or tabs, and has only
 * some of x, y and z, or one of them twice, or none among more than three: better no points
 * than wrong ones. */
enum status cloudheading_take(struct cloudheading *h, struct cloudtext *t, bool comment);

/* cloudheading_settle(h, t): t is at the first line of data.  A heading that was words
 * between blanks, or a comment, counts only if it has as many as the line has fields. */
void cloudheading_settle(struct cloudheading *h, const struct cloudtext *t);

/* cloudheading_role(h, i): what of column[] the column i is, or -1. */
int cloudheading_role(const struct cloudheading *h, unsigned i);

#endif
