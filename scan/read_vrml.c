#include "read.h"

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "cloudlist.h"
#include "cloudtext.h"

#define VRML_DEPTH 64 /* of nodes and lists in each other */
#define VRML_NAMES 64 /* of nodes with points */

enum kind { OTHER, SEPARATOR, TRANSFORM, COORDINATE, FACES, HINTS, REFUSED, LIST };

struct word {
    const char *p;
    size_t len; /* 0: there is none */
};

/* What holds for the nodes that follow: in VRML 1.0 up to the end of their Separator, in 2.0
 * for those inside of a node. */
struct state {
    double m[16];      /* where they are, row by row */
    unsigned place;    /* its number: nodes of one place are moved alike */
    uint64_t first, n; /* the points that faces have */
    bool clockwise;    /* the order of a face's corners, from its front */
};

enum { TRANSLATION, ROTATION, SCALE, CENTER, ORIENTATION, FIELDS };

/* A node or a list that has begun. */
struct frame {
    enum kind kind;
    struct state s;
    struct word name;        /* that DEF gives it */
    uint64_t read;           /* points before it */
    bool moves;              /* it has one of these fields */
    double field[FIELDS][4]; /* of a TRANSFORM */
    struct cloudtext index;  /* the first corner of FACES; p is NULL: none */
};

/* A node with a name and with points. */
struct named {
    struct word name;
    struct state s;
    bool coordinate;
};

struct read_vrml_reading {
    struct cloudtext *t;
    struct cloudlist *list;
    bool old; /* VRML 1.0 */
    unsigned places;
    struct frame frame[VRML_DEPTH]; /* the first one is the file */
    int depth;
    struct named named[VRML_NAMES];
    int names;
};

/* ---- words */

#define MARKS "{}[]\""
#define WORD  'w'

static bool ends_word(char c)
{
    return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f' || c == ',' ||
           memchr(MARKS, c, sizeof MARKS - 1) != NULL;
}

static enum status read_vrml_fail(struct read_vrml_reading *r, const char *what)
{
    return cloudtext_fail(r->t, ST_EINVAL, "%s", what);
}

/* What comes next in the file, which t moves behind: one of the MARKS, WORD, or 0 at the end;
 * '"' stands for a whole string, or for what there is of a string that does not end. */
static char next(struct cloudtext *t, struct word *w)
{
    w->len = 0;
    while (cloudtext_find(t) && (*t->p == ',' || *t->p == '\f' || *t->p == '#'))
        if (*t->p == '#')
            cloudtext_skip(t);
        else
            t->p++;
    w->p = t->p;
    if (t->p == t->end)
        return 0;
    if (*t->p != '"' && ends_word(*t->p))
        return *t->p++;
    if (*t->p != '"') {
        while (t->p < t->end && !ends_word(*t->p))
            t->p++;
        w->len = (size_t)(t->p - w->p);
        return WORD;
    }
    for (t->p++; t->p < t->end && *t->p != '"';) {
        t->p += *t->p == '\\' && t->end - t->p > 1;
        if (cloudtext_eol(t))
            cloudtext_newline(t);
        else
            t->p++;
    }
    t->p += t->p < t->end;
    return '"';
}

static enum status read_numbers(struct read_vrml_reading *r, int n, double *out)
{
    enum status st = ST_OK;

    for (int i = 0; i < n && st == ST_OK; i++) {
        struct cloudtext at;
        struct word w;

        if (next(r->t, &w) != WORD)
            return read_vrml_fail(r, "a number is expected here");
        at = *r->t;
        at.p = w.p;
        at.end = w.p + w.len;
        st = cloudtext_number(&at, &out[i]);
    }
    return st;
}

/* ---- transforms */

/* The turn by an axis and an angle (Rodrigues), of 3 x 3, row by row. */
static void read_vrml_turn(const double by[4], double r[9])
{
    const double len = sqrt(by[0] * by[0] + by[1] * by[1] + by[2] * by[2]);
    const double a[3] = {len > 0 ? by[0] / len : 0, len > 0 ? by[1] / len : 0,
                         len > 0 ? by[2] / len : 0};
    const double c = len > 0 ? cos(by[3]) : 1, s = len > 0 ? sin(by[3]) : 0;
    const double cross[9] = {0, -a[2], a[1], a[2], 0, -a[0], -a[1], a[0], 0};

    for (int i = 0; i < 9; i++)
        r[i] = (i % 4 == 0 ? c : 0) + (1 - c) * a[i / 3] * a[i % 3] + s * cross[i];
}

/* What is inside of a TRANSFORM, or after it: about its center scaled and turned, and then
 * shifted. */
static void move(struct read_vrml_reading *r, const struct frame *f, struct state *s)
{
    const double *t = f->field[TRANSLATION], *scale = f->field[SCALE],
                 *center = f->field[CENTER];
    double rotation[9], own[16] = {0}, m[16];

    if (!f->moves)
        return;
    read_vrml_turn(f->field[ROTATION], rotation);
    for (int i = 0; i < 3; i++) {
        own[4 * i + 3] = t[i] + center[i];
        for (int k = 0; k < 3; k++) {
            own[4 * i + k] = rotation[3 * i + k] * scale[k];
            own[4 * i + 3] -= own[4 * i + k] * center[k];
        }
    }
    own[15] = 1;
    vec_after(s->m, own, m);
    memcpy(s->m, m, sizeof m);
    s->place = ++r->places;
}

/* A field that moves, if w is its name. */
static enum status read_move(struct read_vrml_reading *r, struct frame *f, struct word w)
{
    static const struct {
        const char *name;
        int field, n;
    } fields[] = {{"translation", TRANSLATION, 3},
                  {"rotation", ROTATION, 4},
                  {"scale", SCALE, 3},
                  {"scaleFactor", SCALE, 3},
                  {"scaleOrientation", ORIENTATION, 4},
                  {"center", CENTER, 3}};
    const double *s = f->field[SCALE];
    enum status st = ST_OK;

    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++) {
        if (!cloudtext_is(w.p, w.len, fields[i].name))
            continue;
        f->moves = true;
        if (f->read != r->list->out.read)
            return cloudtext_fail(r->t, ST_EVERSION,
                                  "a transform behind the points that it moves");
        st = read_numbers(r, fields[i].n, f->field[fields[i].field]);
    }
    if (st == ST_OK && !(s[0] > 0 && s[1] > 0 && s[2] > 0))
        return read_vrml_fail(r, "a scale is not above 0");
    return st;
}

/* ---- points and faces */

static enum status read_vrml_read_points(struct read_vrml_reading *r, struct frame *f)
{
    struct word w;

    if (next(r->t, &w) != '[')
        return read_vrml_fail(r, "a list of points is expected here");
    for (;;) {
        struct cloudtext before = *r->t;
        double v[3];
        enum status st;

        if (next(r->t, &w) == ']')
            break;
        *r->t = before;
        if ((st = read_numbers(r, 3, v)) != ST_OK ||
            (st = cloudlist_add(
                 r->list, vec_transform(f->s.m, (struct dvec3){v[0], v[1], v[2]}))) !=
                ST_OK)
            return st;
    }
    f->s.first = f->read;
    f->s.n = r->list->out.read - f->read;
    return ST_OK;
}

/* The faces of a list of corners, each face ended by -1.  If they are none, the faces are forgotten. */
static enum status read_faces(struct read_vrml_reading *r, const struct frame *f)
{
    struct cloudtext t = f->index;
    struct cloudlist_fan fan = {.clockwise = f->s.clockwise};
    enum status st = ST_OK;
    struct word w;
    uint64_t k;

    while (st == ST_OK && next(&t, &w) == WORD)
        if (cloudtext_is(w.p, w.len, "-1")) {
            fan.n = 0;
        } else if (cloudtext_count(w.p, w.len, &k) && k < f->s.n) {
            st = cloudlist_corner(r->list, &fan, f->s.first + k);
        } else {
            cloudlist_forget(r->list);
            return ST_OK;
        }
    return st;
}

/* The list is read when its node ends, which has the points by then. */
static enum status find_index(struct read_vrml_reading *r, struct frame *f)
{
    struct word w;
    char c = next(r->t, &w);

    f->index = *r->t;
    if (c != '[')
        return read_vrml_fail(r, "a list of corners is expected here");
    do
        c = next(r->t, &w);
    while (c == WORD);
    return c == ']' ? ST_OK : read_vrml_fail(r, "a number is expected here");
}

/* ---- nodes */

static enum kind kind_of(const struct read_vrml_reading *r, struct word type)
{
    static const struct {
        const char *name;
        enum kind old, now;
    } kinds[] = {
        {"Coordinate3", COORDINATE, OTHER}, {"Coordinate", OTHER, COORDINATE},
        {"IndexedFaceSet", FACES, FACES},   {"Transform", TRANSFORM, TRANSFORM},
        {"Translation", TRANSFORM, OTHER},  {"Rotation", TRANSFORM, OTHER},
        {"Scale", TRANSFORM, OTHER},        {"Separator", SEPARATOR, OTHER},
        {"WWWAnchor", SEPARATOR, OTHER},    {"TransformSeparator", SEPARATOR, OTHER},
        {"ShapeHints", HINTS, OTHER},       {"MatrixTransform", REFUSED, OTHER},
        {"WWWInline", REFUSED, OTHER},      {"Inline", OTHER, REFUSED},
        {"Switch", REFUSED, REFUSED},       {"LOD", REFUSED, REFUSED}};

    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        if (cloudtext_is(type.p, type.len, kinds[i].name))
            return r->old ? kinds[i].old : kinds[i].now;
    return OTHER;
}

static enum status read_vrml_refuse(struct read_vrml_reading *r, struct word w)
{
    return cloudtext_fail(r->t, ST_EVERSION, "VRML with %.*s is not read", (int)w.len,
                          w.p);
}

static enum status read_vrml_begin(struct read_vrml_reading *r, enum kind kind,
                                   struct word name)
{
    const struct frame *above = &r->frame[r->depth];
    struct frame *f = &r->frame[r->depth + 1];

    if (++r->depth == VRML_DEPTH)
        return cloudtext_fail(r->t, ST_EVERSION, "more than %d nodes in each other",
                              VRML_DEPTH - 1);
    *f = (struct frame){.kind = kind,
                        .s = above->s,
                        .name = name,
                        .read = r->list->out.read,
                        .field = {[SCALE] = {1, 1, 1}}};
    if (!r->old && above->kind == TRANSFORM)
        move(r, above, &f->s);
    return ST_OK;
}

static enum status begin_node(struct read_vrml_reading *r, struct word type,
                              struct word name)
{
    const enum kind kind = kind_of(r, type);

    if (type.len == 0)
        return read_vrml_fail(r, "a node without its type");
    return kind == REFUSED ? read_vrml_refuse(r, type) : read_vrml_begin(r, kind, name);
}

static enum status add_name(struct read_vrml_reading *r, const struct frame *f)
{
    if (f->name.len == 0 || f->read == r->list->out.read)
        return ST_OK;
    if (r->names == VRML_NAMES)
        return cloudtext_fail(r->t, ST_EVERSION,
                              "more than %d names of nodes with points", VRML_NAMES);
    r->named[r->names++] = (struct named){f->name, f->s, f->kind == COORDINATE};
    return ST_OK;
}

static enum status read_vrml_end(struct read_vrml_reading *r, bool list)
{
    struct frame *f = &r->frame[r->depth], *above = f - 1;
    const double *o = f->field[ORIENTATION], *s = f->field[SCALE];
    enum status st = ST_OK;

    if (r->depth == 0 || list != (f->kind == LIST))
        return read_vrml_fail(r, "a closing bracket without an opening one");
    if (o[3] != 0 && (s[0] != s[1] || s[1] != s[2]))
        return read_vrml_refuse(r, (struct word){"a scaleOrientation", 18});
    if (f->kind == FACES && f->index.p != NULL)
        st = read_faces(r, f);
    if (st == ST_OK)
        st = add_name(r, f);
    if (r->old && f->kind == TRANSFORM)
        move(r, f, &f->s);
    if (r->old ? f->kind != SEPARATOR : f->kind == COORDINATE)
        above->s = f->s;
    r->depth--;
    return st;
}

/* A node is used again.  Points may be, by other faces in the same place. */
static enum status use(struct read_vrml_reading *r, struct word name)
{
    struct state *s = &r->frame[r->depth].s;

    for (int i = r->names; i-- > 0;) {
        const struct named *n = &r->named[i];

        if (n->name.len != name.len || memcmp(n->name.p, name.p, name.len) != 0)
            continue;
        if (!n->coordinate || n->s.place != s->place)
            return cloudtext_fail(r->t, ST_EVERSION,
                                  "VRML with USE of points in another place is not read");
        s->first = n->s.first;
        s->n = n->s.n;
        return ST_OK;
    }
    return ST_OK;
}

/* A word in a node, which may be the name of a field or its value; or before a node. */
static enum status take_word(struct read_vrml_reading *r, struct word w,
                             struct word *name)
{
    struct frame *f = &r->frame[r->depth];
    struct word value;
    enum status st = ST_OK;

    if (cloudtext_is(w.p, w.len, "DEF"))
        return next(r->t, name) == WORD ? ST_OK
                                        : read_vrml_fail(r, "a name is expected here");
    if (cloudtext_is(w.p, w.len, "USE"))
        return next(r->t, &value) == WORD ? use(r, value)
                                          : read_vrml_fail(r, "a name is expected here");
    if (cloudtext_is(w.p, w.len, "PROTO") || cloudtext_is(w.p, w.len, "EXTERNPROTO"))
        return read_vrml_refuse(r, w);
    if (f->kind == TRANSFORM)
        return read_move(r, f, w);
    if (f->kind == COORDINATE && cloudtext_is(w.p, w.len, "point"))
        return read_vrml_read_points(r, f);
    if (f->kind == FACES && cloudtext_is(w.p, w.len, "coordIndex"))
        return find_index(r, f);
    if ((f->kind == FACES && cloudtext_is(w.p, w.len, "ccw")) ||
        (f->kind == HINTS && cloudtext_is(w.p, w.len, "vertexOrdering"))) {
        if (next(r->t, &value) != WORD)
            return read_vrml_fail(r, "a word is expected here");
        f->s.clockwise = cloudtext_is(value.p, value.len, "FALSE") ||
                         cloudtext_is(value.p, value.len, "CLOCKWISE");
    }
    return st;
}

static enum status read_nodes(struct read_vrml_reading *r)
{
    struct word w, type = {NULL, 0}, name = {NULL, 0};
    enum status st = ST_OK;
    char c;

    while (st == ST_OK && (c = next(r->t, &w)) != 0) {
        switch (c) {
        case WORD:
            st = take_word(r, w, &name);
            break;
        case '{':
            st = begin_node(r, type, name);
            name.len = 0;
            break;
        case '[':
            st = read_vrml_begin(r, LIST, (struct word){NULL, 0});
            break;
        case '}':
        case ']':
            st = read_vrml_end(r, c == ']');
            break;
        default:
            break;
        }
        type = w;
    }
    if (st == ST_OK && r->depth > 0)
        return read_vrml_fail(r, "the VRML file ends within a node");
    return st;
}

bool read_vrml_is(const struct cloudtext *t)
{
    return t->end - t->p >= 5 && memcmp(t->p, "#VRML", 5) == 0;
}

enum status read_vrml_parse(struct cloudtext *t, const struct cloudfile_options *o,
                            struct cloudlist *list)
{
    (void)o;
    static const double none[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    struct read_vrml_reading r = {.t = t, .list = list};
    enum status st = cloudtext_plain(t);

    if (st != ST_OK)
        return st;
    if (!read_vrml_is(t))
        return read_vrml_fail(&r, "a VRML file begins with #VRML");
    if (t->end - t->p < 9 ||
        (memcmp(t->p, "#VRML V1.", 9) != 0 && memcmp(t->p, "#VRML V2.", 9) != 0))
        return cloudtext_fail(t, ST_EVERSION, "VRML of another version than 1.0 and 2.0");
    r.old = t->p[7] == '1';
    memcpy(r.frame[0].s.m, none, sizeof none);
    return read_nodes(&r);
}
