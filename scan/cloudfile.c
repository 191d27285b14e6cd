#include "cloudfile.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "clouddepth.h"
#include "cloudlist.h"
#include "cloudtext.h"
#include "cloudunit.h"
#include "errinfo.h"
#include "inflate.h"
#include "json.h"
#include "mem.h"
#include "read.h"
#include "readfile.h"

static void skip_bom(struct cloudtext *t)
{
    if (t->end - t->p >= 3 && memcmp(t->p, "\xEF\xBB\xBF", 3) == 0)
        t->p += 3;
}

static enum status nothing(struct cloudtext *t)
{
    return cloudtext_fail(t, ST_EINVAL, "there are no points in it");
}

/* The first line that is not a comment.  False: there is none. */
static bool find_line(struct cloudtext *t)
{
    for (; t->p < t->end; cloudtext_skip(t)) {
        cloudtext_blank(t);
        if (!cloudtext_eol(t) && !cloudtext_comment(t))
            return true;
    }
    return false;
}

/* The formats that a file's first bytes show. */
static const struct {
    enum cloudformat format;
    read_is *is;
    read_parse *parse;
    read_count *count; /* NULL: a point takes at least half of what it weighs */
} reader[] = {
    {CLOUDFORMAT_PLY, read_ply_is, read_ply_parse, read_ply_count},
    {CLOUDFORMAT_GLB, read_glb_is, read_glb_parse, NULL},
    {CLOUDFORMAT_PNG, read_png_is, read_png_parse, read_png_count},
    {CLOUDFORMAT_PGM, read_pgm_is, read_pgm_parse, read_pgm_count},
    {CLOUDFORMAT_NPY, read_npy_is, read_npy_parse, read_npy_count},
    {CLOUDFORMAT_VRML, read_vrml_is, read_vrml_parse, NULL},
    {CLOUDFORMAT_PCD, read_pcd_is, read_pcd_parse, read_pcd_count},
    {CLOUDFORMAT_ABS, read_abs_is, read_abs_parse, NULL},
    {CLOUDFORMAT_BNT, read_bnt_is, read_bnt_parse, NULL},
    {CLOUDFORMAT_STL, read_stl_is, read_stl_parse, NULL},
};
#define READERS (sizeof reader / sizeof *reader)

/* By what it begins with. */
static enum status recognise(const struct cloudtext *text, enum cloudformat *format)
{
    struct cloudtext t = *text;

    for (size_t i = 0; i < READERS; i++) {
        if (reader[i].is(&t)) {
            *format = reader[i].format;
            return ST_OK;
        }
    }
    if (!find_line(&t))
        return nothing(&t);
    if (*t.p == '{' || *t.p == '[')
        *format = CLOUDFORMAT_JSON;
    else if (read_obj_is(&t))
        *format = CLOUDFORMAT_OBJ;
    else if (read_xyz_is(&t))
        *format = CLOUDFORMAT_XYZ;
    else
        return errinfo_set(t.e, ST_EVERSION,
                           "not a scan in a format that is read: " CLOUDFORMAT_READ);
    return ST_OK;
}

static enum status text_parse(struct cloudtext *t, const struct cloudfile_options *o,
                              struct cloudlist *list)
{
    enum status st = cloudtext_plain(t);

    if (st == ST_OK)
        st = list->out.format == CLOUDFORMAT_OBJ ? read_obj_parse(t, o, list)
                                                 : read_xyz_parse(t, o, list);
    return st == ST_OK && list->out.read == 0 ? nothing(t) : st;
}

static enum status take_units(const struct json_value *units, const char *prefix,
                              struct cloudlist *list)
{
    const char *name = json_get_text(units);

    if (units == NULL)
        return ST_OK;
    if (name == NULL || !cloudunit_or_auto(name, &list->out.unit_mm))
        return errinfo_set(list->e, ST_EINVAL, "%sunits must be auto, " CLOUDUNIT_NAMES,
                           prefix);
    return ST_OK;
}

static enum status take_axes(const struct json_value *axes, const char *prefix,
                             struct cloudlist *list)
{
    const char *name = json_get_text(axes);

    if (axes == NULL)
        return ST_OK;
    list->out.axes_given = name != NULL && strcmp(name, "scanner") == 0;
    if (name == NULL || (!list->out.axes_given && strcmp(name, "auto") != 0))
        return errinfo_set(list->e, ST_EINVAL, "%saxes must be auto or scanner", prefix);
    return ST_OK;
}

static enum status take_points(const struct json_value *points, const char *prefix,
                               struct cloudlist *list)
{
    const size_t n = json_count(points);
    struct dvec3 *at;
    size_t got;
    enum status st;

    if (n > list->max)
        return errinfo_set(list->e, ST_ELIMIT,
                           "%spoints has %zu points; the limit is %zu", prefix, n,
                           list->max);
    if ((at = mem_array(n, sizeof *at)) == NULL)
        return errinfo_set(list->e, ST_ENOMEM, "no memory for %zu points", n);
    if ((st = json_get_points(points, at, &got)) != ST_OK)
        (void)errinfo_set(list->e, st, "%spoints[%zu] is not three finite numbers",
                          prefix, got);
    else
        st = cloudlist_room(list, n);
    for (size_t i = 0; i < n && st == ST_OK; i++)
        st = cloudlist_add(list, at[i]);
    mem_free(at);
    return st;
}

/* Says what an object is that other programs write and that is not read. */
static enum status check_kind(const struct json_value *object, struct errinfo *e)
{
    if (json_member(object, "asset") != NULL)
        return errinfo_set(e, ST_EVERSION,
                           "glTF as text, whose data may be beside it: send a GLB");
    if (json_member(object, "points") == NULL && json_member(object, "x") != NULL &&
        json_member(object, "y") != NULL && json_member(object, "z") != NULL)
        return errinfo_set(
            e, ST_EVERSION,
            "JSON with columns x, y and z, which is not read: send each point as [x, y, z]");
    return ST_OK;
}

/* A list of points, or an object's points, unit and axes, and no other members; the message is in
 * list->e. */
static enum status take_cloud(const struct json_value *object, const char *name,
                              const char *prefix, struct cloudlist *list)
{
    static const char *const known[] = {"points", "units", "axes", NULL};
    const struct json_value *points = json_member(object, "points");
    enum status st = check_kind(object, list->e);

    if (json_is_array(object))
        return take_points(object, prefix, list);
    if (st == ST_OK)
        st = json_expect(object, name, known, list->e);
    if (st == ST_OK)
        st = take_units(json_member(object, "units"), prefix, list);
    if (st == ST_OK)
        st = take_axes(json_member(object, "axes"), prefix, list);
    if (st != ST_OK)
        return st;
    if (points == NULL)
        return errinfo_set(list->e, ST_EINVAL, "%spoints is missing", prefix);
    if (!json_is_array(points))
        return errinfo_set(list->e, ST_EINVAL, "%spoints is not an array", prefix);
    return take_points(points, prefix, list);
}

static enum status json_parse(struct cloudtext *t, struct cloudlist *list)
{
    struct json_value *doc;
    enum status st;

    st = cloudfile_read_document(t->p, (size_t)(t->end - t->p), list->max, 1, &doc,
                                 list->e);
    if (st == ST_OK)
        st = take_cloud(doc, "the JSON", "", list);
    json_free(doc);
    return st;
}

static enum status parse_as(struct cloudtext *t, const struct cloudfile_options *o,
                            struct cloudlist *list)
{
    const enum cloudformat format = (enum cloudformat)list->out.format;

    for (size_t i = 0; i < READERS; i++)
        if (reader[i].format == format)
            return reader[i].parse(t, o, list);
    if (format == CLOUDFORMAT_RAW)
        return clouddepth_values(t, &o->camera, o->camera.width, o->camera.height, false,
                                 list);
    return format == CLOUDFORMAT_JSON ? json_parse(t, list) : text_parse(t, o, list);
}

/* What is malformed as what it was declared to be may be something else.  Nearly every text
 * could be XYZ, which therefore says nothing. */
static enum status blame(struct cloudtext *whole, enum cloudformat declared)
{
    struct cloudtext t = *whole;
    enum cloudformat is = declared;

    t.e = NULL;
    if (recognise(&t, &is) == ST_OK && is != declared && is != CLOUDFORMAT_XYZ)
        (void)cloudtext_fail(whole, ST_EINVAL, "this is %s, not %s as declared",
                             cloudformat_name(is), cloudformat_name(declared));
    return ST_EINVAL;
}

static enum status check_converted(const char *bytes, size_t len, struct errinfo *e)
{
    return cloudformat_converted(bytes, len)
               ? errinfo_set(
                     e, ST_EINVAL,
                     "the file was changed by a conversion as text, which damages "
                     "binary data: transfer it in binary mode")
               : ST_OK;
}

/* The kind of a file that is no scan, by its first bytes or its first line that is no comment. */
static const char *foreign(const struct cloudtext *t)
{
    struct cloudtext line = *t;
    const char *name = cloudformat_foreign(t->p, (size_t)(t->end - t->p));

    return name == NULL && find_line(&line)
               ? cloudformat_foreign(line.p, (size_t)(line.end - line.p))
               : name;
}

static enum status parse(struct cloudtext *t, const struct cloudfile_options *o,
                         struct cloudlist *list)
{
    const enum cloudformat declared = (enum cloudformat)list->out.format;
    const char *name = NULL;
    struct cloudtext whole;
    enum cloudformat found = declared;
    enum status st = check_converted(t->p, (size_t)(t->end - t->p), t->e);

    if (st != ST_OK)
        return st;
    /* what begins with numbers, or with anything, may begin like another kind */
    if (declared != CLOUDFORMAT_RAW && !read_bnt_is(t) && !read_stl_is(t)) {
        skip_bom(t);
        name = foreign(t);
    }
    whole = *t;
    if (name != NULL)
        return errinfo_set(t->e, ST_EVERSION,
                           "%s, which is not read: send " CLOUDFORMAT_READ, name);
    if (declared == CLOUDFORMAT_ANY)
        st = recognise(t, &found);
    list->out.format = found;
    if (st == ST_OK)
        st = parse_as(t, o, list);
    return st == ST_EINVAL && declared != CLOUDFORMAT_ANY ? blame(&whole, declared) : st;
}

/* What is in the list becomes *out, if st is ST_OK. */
static enum status cloudfile_finish(struct cloudlist *list, enum status st,
                                    const struct cloudfile_options *o,
                                    struct cloudpoints *out)
{
    if (list->out.unit_mm == 0)
        list->out.unit_mm = o->unit_mm;
    if (st == ST_OK)
        st = list->out.at == NULL
                 ? errinfo_set(list->e, ST_EINVAL, "there are no points in it")
                 : cloudlist_finish(list);
    if (st == ST_OK)
        *out = list->out;
    else
        cloudpoints_free(&list->out);
    return st;
}

/* The file, unpacked. */
static enum status read_plain(const char *bytes, size_t len,
                              const struct cloudfile_options *o, struct cloudpoints *out,
                              struct errinfo *e)
{
    struct cloudtext t = {
        .start = bytes, .p = bytes, .end = bytes + len, .line = 1, .e = e};
    struct cloudlist list = {.out = {.format = o->format}, .max = o->max_points, .e = e};

    if (o->format == CLOUDFORMAT_ANY && o->camera.width > 0)
        list.out.format = CLOUDFORMAT_RAW;
    return cloudfile_finish(&list, len == 0 ? nothing(&t) : parse(&t, o, &list), o, out);
}

static bool is_gzip(const char *bytes, size_t len)
{
    return len >= 2 && memcmp(bytes, "\x1F\x8B", 2) == 0;
}

size_t cloudfile_weight(const void *bytes, size_t len, enum cloudformat format)
{
    struct cloudtext t = {
        .start = bytes, .p = bytes, .end = (const char *)bytes + len, .line = 1};
    uint64_t n = format == CLOUDFORMAT_RAW ? len / 2 : 0;

    if (is_gzip(bytes, len))
        return SIZE_MAX;
    skip_bom(&t);
    for (size_t i = 0; i < READERS; i++)
        if (reader[i].count != NULL && (reader[i].format == format ||
                                        (format == CLOUDFORMAT_ANY && reader[i].is(&t))))
            n = reader[i].count(t);
    if (n > SIZE_MAX / CLOUDFILE_POINT_WEIGHT)
        return SIZE_MAX;
    n *= CLOUDFILE_POINT_WEIGHT;
    return n > len ? (size_t)n : len;
}

enum status cloudfile_read(const void *bytes, size_t len,
                           const struct cloudfile_options *o, struct cloudpoints *out,
                           struct errinfo *e)
{
    unsigned char *unpacked;
    size_t n;
    enum status st;

    *out = (struct cloudpoints){0};
    if (!is_gzip(bytes, len))
        return read_plain(bytes, len, o, out, e);
    st = inflate_body(INFLATE_GZIP, bytes, len, o->max_bytes, &unpacked, &n, e);
    if (st == ST_OK)
        st = read_plain((const char *)unpacked, n, o, out, e);
    else if (st == ST_EINVAL)
        (void)check_converted(bytes, len, e);
    mem_free(unpacked);
    return st;
}

enum status cloudfile_read_json(const struct json_value *object, const char *name,
                                const char *prefix, const struct cloudfile_options *o,
                                struct cloudpoints *out, struct errinfo *e)
{
    struct cloudlist list = {
        .out = {.format = CLOUDFORMAT_JSON}, .max = o->max_points, .e = e};

    *out = (struct cloudpoints){0};
    return cloudfile_finish(&list, take_cloud(object, name, prefix, &list), o, out);
}

enum status cloudfile_read_document(const char *text, size_t len, size_t max_points,
                                    size_t clouds, struct json_value **out,
                                    struct errinfo *e)
{
    /* Four values a point, and a few for other members. */
    const enum status st =
        json_read_points(text, len, clouds * (4 * max_points + 64), out, e);

    return st == ST_ELIMIT
               ? errinfo_set(e, ST_ELIMIT, "more values than %zu points can have",
                             clouds * max_points)
               : st;
}

/* ---- the programs' */

enum status cloudfile_read_path(const char *path, double unit_mm,
                                const struct clouddepth_camera *camera,
                                struct cloudpoints *out, struct errinfo *e)
{
    const size_t most = (size_t)256 << 20;
    const struct cloudfile_options o = {.max_points = CLOUDFILE_POINTS,
                                        .max_bytes = most,
                                        .unit_mm = unit_mm,
                                        .camera = *camera};
    struct errinfo why = {.msg = "out of memory"};
    unsigned char *bytes;
    size_t len;
    enum status st = readfile_all(path, most, &bytes, &len, e);

    *out = (struct cloudpoints){0};
    if (st == ST_OK && (st = cloudfile_read(bytes, len, &o, out, &why)) != ST_OK)
        (void)errinfo_set(e, st, "%.100s: %s", path, why.msg);
    free(bytes);
    return st;
}

const char *cloudfile_option_units(const char *text, void *value)
{
    return cloudunit_or_auto(text, value) ? NULL : "auto, " CLOUDUNIT_NAMES;
}

const char *cloudfile_option_axes(const char *text, void *value)
{
    const bool scanner = strcmp(text, "scanner") == 0;

    *(bool *)value = scanner;
    return scanner || strcmp(text, "auto") == 0 ? NULL : "auto or scanner";
}

const char *cloudfile_option_camera(const char *text, void *value)
{
    return clouddepth_camera_read(text, value)
               ? NULL
               : "FX,FY,CX,CY[,SCALE[,WIDTH,HEIGHT]], pixels";
}
