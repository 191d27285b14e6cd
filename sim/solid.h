/* solid.h -- solids made of simple parts, by their signed distance, and what a scanner sees of
 * them: the objects of object.h, which are no faces. */
#ifndef TOOLS_SOLID_H
#define TOOLS_SOLID_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "draw.h"
#include "vec.h"

#define SOLID_PARTS 48
#define SOLID_WAVES 48

enum solid_form {
    SOLID_BALL, /* an ellipsoid of half axes size */
    SOLID_BOX,  /* of half sides size */
    SOLID_CONE, /* about y: radius size[0] below, size[2] above, half height size[1] */
    SOLID_RING  /* about y: radius size[0], of a tube of radius size[1] */
};

struct solid_part {
    enum solid_form form;
    struct dvec3 at;
    double size[3];
    double turn[9]; /* row-major, the part's own axes -> the solid's */
    double blend;   /* mm over which it runs into the parts before */
    bool carved;    /* taken away from them */
};

struct solid {
    struct solid_part part[SOLID_PARTS];
    uint32_t n;
    struct {
        double k[3], phase, h;
    } wave[SOLID_WAVES]; /* relief of the whole surface: h cos(k . p + phase), mm */
    uint32_t waves;
};

/* solid_add(s, form, x, y, z, a, b, c, blend): a further part, its axes as the solid's.
 * Returns it. */
struct solid_part *solid_add(struct solid *s, enum solid_form form, double x, double y,
                             double z, double a, double b, double c, double blend);

/* solid_turn(yaw, pitch, roll, out): Rz Rx Ry of these angles in degrees. */
void solid_turn(double yaw, double pitch, double roll, double out[9]);

/* solid_roughen(s, n, low, high, slope, r): n waves of lengths between low and high mm and
 * amplitudes slope times that. */
void solid_roughen(struct solid *s, int n, double low, double high, double slope,
                   struct draw *r);

struct solid_view {
    double turn[9];  /* the solid's axes -> the scanner's */
    double wide;     /* mm: half the side of the square that is seen */
    uint32_t points; /* at most */
    double noise;    /* along z, mm */
};

/* solid_scan(s, v, r, out): the points (room for v->points) that a scanner looking along -z
 * sees, in random order, mm.  Returns how many: fewer where little of the square is filled. */
size_t solid_scan(const struct solid *s, const struct solid_view *v, struct draw *r,
                  struct dvec3 *out);

#endif
