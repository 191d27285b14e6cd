#include "params.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "auth.h"
#include "clouddepth.h"
#include "cloudunit.h"
#include "errmap.h"
#include "number.h"
#include "request.h"

/* The value into buf; *there tells whether it was given.  False when it cannot be read, and
 * buf is "". */
static bool get(struct request *r, const char *name, char *buf, size_t size, bool *there)
{
    enum status st = request_query(r, name, buf, size);

    *there = st != ST_ENOTFOUND;
    if (st != ST_OK)
        buf[0] = '\0';
    return st == ST_OK || st == ST_ENOTFOUND;
}

bool params_flag(struct request *r, const char *name, bool *out)
{
    char buf[8];
    bool there;

    if (get(r, name, buf, sizeof buf, &there)) {
        if (!there)
            return true;
        *out = strcmp(buf, "true") == 0;
        if (*out || strcmp(buf, "false") == 0)
            return true;
    }
    request_problem(r, ERRMAP_PARAMETER, "%s must be true or false", name);
    return false;
}

bool params_units(struct request *r, double *mm)
{
    char buf[8];
    bool there;

    if (get(r, "units", buf, sizeof buf, &there) &&
        (!there || cloudunit_or_auto(buf, mm)))
        return true;
    request_problem(r, ERRMAP_PARAMETER, "units must be auto, " CLOUDUNIT_NAMES);
    return false;
}

bool params_axes(struct request *r, bool *axes_given)
{
    char buf[8];
    bool there;

    if (get(r, "axes", buf, sizeof buf, &there)) {
        if (!there)
            return true;
        *axes_given = strcmp(buf, "scanner") == 0;
        if (*axes_given || strcmp(buf, "auto") == 0)
            return true;
    }
    request_problem(r, ERRMAP_PARAMETER, "axes must be auto or scanner");
    return false;
}

/* A finite number, above 0 or of any sign. */
static bool take_number(struct request *r, const char *name, bool positive, double *out)
{
    char buf[40];
    bool there;

    if (get(r, name, buf, sizeof buf, &there)) {
        const char *end = buf + strlen(buf);

        if (!there)
            return true;
        if (number_read(buf, end, out) == end && isfinite(*out) &&
            (!positive || *out > 0))
            return true;
    }
    request_problem(r, ERRMAP_PARAMETER, "%s is not a number%s", name,
                    positive ? " above 0" : "");
    return false;
}

bool params_camera(struct request *r, struct clouddepth_camera *c)
{
    size_t width = 0, height = 0;

    if (!take_number(r, "fx", true, &c->fx) || !take_number(r, "fy", true, &c->fy) ||
        !take_number(r, "cx", false, &c->cx) || !take_number(r, "cy", false, &c->cy) ||
        !take_number(r, "depth_scale", true, &c->scale) ||
        !params_count(r, "width", 1, CLOUDDEPTH_SIDE_MAX, &width) ||
        !params_count(r, "height", 1, CLOUDDEPTH_SIDE_MAX, &height))
        return false;
    c->width = (uint32_t)width;
    c->height = (uint32_t)height;
    if ((width > 0) == (height > 0))
        return true;
    request_problem(r, ERRMAP_PARAMETER, "width and height are given together");
    return false;
}

bool params_detail(struct request *r, unsigned scopes, enum verify_detail *out)
{
    char buf[64];
    bool there;

    if (get(r, "detail", buf, sizeof buf, &there)) {
        *out = r->minimal ? VERIFY_DECISION : VERIFY_BRIEF;
        if (!there)
            return true;
        *out = strcmp(buf, "heatmap") == 0   ? VERIFY_HEATMAP
               : strcmp(buf, "surface") == 0 ? VERIFY_SURFACE
               : strcmp(buf, "measure") == 0 ? VERIFY_MEASURE
                                             : VERIFY_BRIEF;
        if (*out != VERIFY_BRIEF)
            return auth_may(r, scopes);
    }
    request_problem(r, ERRMAP_PARAMETER,
                    "detail must be measure, heatmap or surface, not '%s'", buf);
    return false;
}

bool params_surface(struct request *r, bool *out)
{
    char buf[64];
    bool there;

    if (get(r, "detail", buf, sizeof buf, &there)) {
        *out = there;
        if (!there || strcmp(buf, "surface") == 0)
            return true;
    }
    request_problem(r, ERRMAP_PARAMETER, "detail must be surface, not '%s'", buf);
    return false;
}

bool params_format(struct request *r, bool *ply)
{
    char buf[64];
    bool there;

    if (get(r, "format", buf, sizeof buf, &there)) {
        *ply = there && strcmp(buf, "ply") == 0;
        if (!there || *ply || strcmp(buf, "glb") == 0)
            return true;
    }
    request_problem(r, ERRMAP_PARAMETER, "format must be glb or ply, not '%s'", buf);
    return false;
}

bool params_text(struct request *r, const char *name, char *out, size_t size)
{
    bool there;

    if (get(r, name, out, size, &there) && (!there || out[0] != '\0'))
        return true;
    request_problem(r, ERRMAP_PARAMETER, "%s is not a text of 1 to %zu bytes", name,
                    size - 1);
    return false;
}

bool params_group(struct request *r, char out[GROUPS_LABEL + 1])
{
    bool there;

    if (get(r, "group", out, GROUPS_LABEL + 1, &there) && (!there || groups_label(out)))
        return true;
    request_problem(r, ERRMAP_PARAMETER,
                    "group must be 1 to %d characters of a-z 0-9 . _ -", GROUPS_LABEL);
    return false;
}

bool params_count(struct request *r, const char *name, size_t min, size_t max,
                  size_t *out)
{
    char buf[16], *end;
    bool there;

    if (get(r, name, buf, sizeof buf, &there)) {
        unsigned long n;

        if (!there)
            return true;
        errno = 0;
        n = strtoul(buf, &end, 10);
        if (buf[0] >= '0' && buf[0] <= '9' && *end == '\0' && errno == 0 && n >= min &&
            n <= max) {
            *out = n;
            return true;
        }
    }
    request_problem(r, ERRMAP_PARAMETER, "%s is not an integer from %zu to %zu", name,
                    min, max);
    return false;
}
