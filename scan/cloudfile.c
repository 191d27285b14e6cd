#include "cloudfile.h"

#include <string.h>

#include "cloudabs.h"
#include "cloudbnt.h"
#include "clouddepth.h"
#include "cloudglb.h"
#include "cloudjson.h"
#include "cloudlist.h"
#include "cloudnpy.h"
#include "cloudobj.h"
#include "cloudpcd.h"
#include "cloudpgm.h"
#include "cloudply.h"
#include "cloudpng.h"
#include "cloudstl.h"
#include "cloudtext.h"
#include "cloudvrml.h"
#include "cloudxyz.h"
#include "errinfo.h"
#include "inflate.h"
#include "json.h"
#include "mem.h"

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

/* By what it begins with. */
static enum status recognise(const struct cloudtext *text, enum cloudformat *format)
{
    static const struct {
        enum cloudformat format;
        bool (*is)(const struct cloudtext *t);
    } known[] = {{CLOUDFORMAT_PLY, cloudply_is}, {CLOUDFORMAT_GLB, cloudglb_is},
                 {CLOUDFORMAT_PNG, cloudpng_is}, {CLOUDFORMAT_PGM, cloudpgm_is},
                 {CLOUDFORMAT_NPY, cloudnpy_is}, {CLOUDFORMAT_VRML, cloudvrml_is},
                 {CLOUDFORMAT_PCD, cloudpcd_is}, {CLOUDFORMAT_ABS, cloudabs_is},
                 {CLOUDFORMAT_BNT, cloudbnt_is}, {CLOUDFORMAT_STL, cloudstl_is}};
    struct cloudtext t = *text;

    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        if (known[i].is(&t)) {
            *format = known[i].format;
            return ST_OK;
        }
    }
    skip_bom(&t);
    if (!find_line(&t))
        return nothing(&t);
    if (*t.p == '{' || *t.p == '[')
        *format = CLOUDFORMAT_JSON;
    else if (cloudobj_is(&t))
        *format = CLOUDFORMAT_OBJ;
    else if (cloudxyz_is(&t))
        *format = CLOUDFORMAT_XYZ;
    else
        return errinfo_set(t.e, ST_EVERSION,
                           "not a scan in a format that is read: " CLOUDFORMAT_READ);
    return ST_OK;
}

static enum status text_parse(struct cloudtext *t, struct cloudlist *list)
{
    enum status st;

    skip_bom(t);
    if ((st = cloudtext_plain(t)) == ST_OK)
        st = list->out.format == CLOUDFORMAT_OBJ ? cloudobj_parse(t, list)
                                                 : cloudxyz_parse(t, list);
    return st == ST_OK && list->out.read == 0 ? nothing(t) : st;
}

static enum status json_parse(struct cloudtext *t, struct cloudlist *list)
{
    struct json_value *doc;
    enum status st;

    skip_bom(t);
    st = cloudjson_document(t->p, (size_t)(t->end - t->p), list->max, 1, &doc, list->e);
    if (st == ST_OK)
        st = cloudjson_take(doc, "the body", "", list);
    json_free(doc);
    return st;
}

static enum status parse_as(struct cloudtext *t, const struct cloudfile_options *o,
                            struct cloudlist *list)
{
    switch ((enum cloudformat)list->out.format) {
    case CLOUDFORMAT_PLY:
        return cloudply_parse(t, list);
    case CLOUDFORMAT_STL:
        return cloudstl_parse(t, list);
    case CLOUDFORMAT_GLB:
        return cloudglb_parse(t, list);
    case CLOUDFORMAT_PCD:
        return cloudpcd_parse(t, o->max_bytes, list);
    case CLOUDFORMAT_VRML:
        return cloudvrml_parse(t, list);
    case CLOUDFORMAT_BNT:
        return cloudbnt_parse(t, list);
    case CLOUDFORMAT_ABS:
        return cloudabs_parse(t, list);
    case CLOUDFORMAT_NPY:
        return cloudnpy_parse(t, &o->camera, list);
    case CLOUDFORMAT_PNG:
        return cloudpng_parse(t, &o->camera, o->max_bytes, list);
    case CLOUDFORMAT_PGM:
        return cloudpgm_parse(t, &o->camera, list);
    case CLOUDFORMAT_RAW:
        return clouddepth_values(t, &o->camera, o->camera.width, o->camera.height, false,
                                 list);
    case CLOUDFORMAT_JSON:
        return json_parse(t, list);
    default:
        return text_parse(t, list);
    }
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

/* What begins with numbers may begin like anything. */
static const char *foreign(const struct cloudtext *t, enum cloudformat declared)
{
    return declared == CLOUDFORMAT_RAW || cloudbnt_is(t)
               ? NULL
               : cloudformat_foreign((const unsigned char *)t->p,
                                     (size_t)(t->end - t->p));
}

static enum status parse(struct cloudtext *t, const struct cloudfile_options *o,
                         struct cloudlist *list)
{
    const enum cloudformat declared = (enum cloudformat)list->out.format;
    const char *name = foreign(t, declared);
    struct cloudtext whole = *t;
    enum cloudformat found = declared;
    enum status st = ST_OK;

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
static enum status finish(struct cloudlist *list, enum status st,
                          const struct cloudfile_options *o, struct cloudpoints *out)
{
    if (st == ST_OK)
        st = list->out.at == NULL
                 ? errinfo_set(list->e, ST_EINVAL, "there are no points in it")
                 : cloudlist_finish(list);
    if (st != ST_OK) {
        cloudpoints_free(&list->out);
    } else {
        if (list->out.unit_mm == 0)
            list->out.unit_mm = o->unit_mm;
        *out = list->out;
    }
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
    return finish(&list, len == 0 ? nothing(&t) : parse(&t, o, &list), o, out);
}

enum status cloudfile_read(const void *bytes, size_t len,
                           const struct cloudfile_options *o, struct cloudpoints *out,
                           struct errinfo *e)
{
    unsigned char *unpacked;
    size_t n;
    enum status st;

    *out = (struct cloudpoints){0};
    if (len < 2 || memcmp(bytes, "\x1F\x8B", 2) != 0)
        return read_plain(bytes, len, o, out, e);
    st = inflate_body(INFLATE_GZIP, bytes, len, o->max_bytes, &unpacked, &n, e);
    if (st == ST_OK)
        st = read_plain((const char *)unpacked, n, o, out, e);
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
    return finish(&list, cloudjson_take(object, name, prefix, &list), o, out);
}
