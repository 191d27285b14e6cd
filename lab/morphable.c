#include "morphable.h"

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "pose.h"
#include "objmesh.h"
#include "rates.h"

/* mm: how high a head is, with its neck, or a face alone. */
#define LOWEST_MM  120.0
#define HIGHEST_MM 1200.0

/* mm: heights are compared this far above and below the nose tip; and how far from that the mesh's
 * part in front is, once it is about at its place. */
#define UPRIGHT_MM    60.0
#define NOSE_MM       30.0
#define STANDS_OUT_MM 5.0 /* the nose tip, from the mean of both heights, at least */

#define PLACINGS                                                                         \
    6 /* each moves the face by a tenth of what the one before did, or less */
#define MIDDLE_MM  5.0 /* the nose tip is not farther from the plane of symmetry */
#define UNLIKE_MM  3.0 /* root mean square of the two halves' difference, at most */
#define LEAST_SEEN 300 /* cells */

struct folder {
    const char *dir;
    char **name; /* [n] sorted by bytes */
    uint32_t n;
};

enum role { NO_ROLE, NEUTRAL, IDENTITY, EXPRESSION };

static bool begins(const char *name, const char *with)
{
    return strncasecmp(name, with, strlen(with)) == 0;
}

static bool contains(const char *name, const char *what)
{
    for (; *name != '\0'; name++)
        if (begins(name, what))
            return true;
    return false;
}

static enum role role_of(const char *name)
{
    static const char *const parts[] = {"brow", "cheek", "eye", "jaw", "mouth", "nose"};
    const size_t len = strlen(name);

    if (len < 4 || strcasecmp(name + len - 4, ".obj") != 0 || name[0] == '.')
        return NO_ROLE;
    if (contains(name, "neutral"))
        return NEUTRAL;
    if (begins(name, "identity"))
        return IDENTITY;
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        if (begins(name, parts[i]))
            return EXPRESSION;
    return NO_ROLE;
}

static bool is_seen(const char *material)
{
    return !contains(material, "blend") && !contains(material, "fluid") &&
           !contains(material, "lash") && !contains(material, "occlusion");
}

/* ---- the folder */

static int has_role(const struct dirent *d)
{
    return role_of(d->d_name) != NO_ROLE;
}

static int by_name(const struct dirent **a, const struct dirent **b)
{
    return strcmp((*a)->d_name, (*b)->d_name);
}

static void close_folder(struct folder *f)
{
    for (uint32_t i = 0; i < f->n; i++)
        free(f->name[i]);
    free(f->name);
}

static uint32_t count(const struct folder *f, enum role role)
{
    uint32_t n = 0;

    for (uint32_t i = 0; i < f->n; i++)
        n += role_of(f->name[i]) == role;
    return n;
}

static enum status check_folder(const struct folder *f, struct errinfo *e)
{
    if (count(f, NEUTRAL) != 1)
        return errinfo_set(e, ST_EINVAL,
                           "%.160s: %u files of a neutral face (*neutral*.obj), not one",
                           f->dir, (unsigned)count(f, NEUTRAL));
    if (count(f, IDENTITY) == 0 || count(f, EXPRESSION) == 0)
        return errinfo_set(
            e, ST_EINVAL,
            "%.160s: %u modes of identity (identity*.obj) and %u expressions (brow*.obj, "
            "cheek*, eye*, jaw*, mouth*, nose*): one of each is the least",
            f->dir, (unsigned)count(f, IDENTITY), (unsigned)count(f, EXPRESSION));
    if (f->n > MORPHABLE_MODES)
        return errinfo_set(e, ST_ELIMIT, "%.160s: more than %d files", f->dir,
                           MORPHABLE_MODES);
    return ST_OK;
}

static enum status open_folder(const char *dir, struct folder *f, struct errinfo *e)
{
    struct dirent **list;
    const int n = scandir(dir, &list, has_role, by_name);
    bool whole = true;

    *f = (struct folder){.dir = dir};
    if (n < 0)
        return errinfo_set(e, errno == ENOENT ? ST_ENOTFOUND : ST_EIO, "%.160s: %s", dir,
                           strerror(errno));
    if ((f->name = calloc((size_t)n + 1, sizeof *f->name)) == NULL)
        whole = false;
    for (int i = 0; i < n; i++) {
        if (whole && (f->name[i] = strdup(list[i]->d_name)) == NULL)
            whole = false;
        f->n += whole;
        free(list[i]);
    }
    free(list);
    return whole ? check_folder(f, e) : errinfo_set(e, ST_ENOMEM, "out of memory");
}

static enum status read_file(const struct folder *f, const char *name, bool faces,
                             struct objmesh *out, struct errinfo *e)
{
    const size_t size = strlen(f->dir) + strlen(name) + 2;
    char *path = malloc(size);
    enum status st;

    if (path == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    (void)snprintf(path, size, "%s/%s", f->dir, name);
    st = objmesh_read(path, faces ? is_seen : NULL, out, e);
    free(path);
    return st;
}

/* ---- the neutral face and its place */

/* A file's vertices, and how they become the model's. */
struct placing {
    uint32_t nv;    /* in the file */
    uint32_t *kept; /* [model's nv] rising: those that a triangle has */
    double unit_mm;
    struct pose pose; /* mm -> canonical frame */
};

static struct dvec3 place(const struct pose *pose, double unit_mm, const float *at)
{
    return pose_apply(pose,
                      (struct dvec3){unit_mm * (double)at[0], unit_mm * (double)at[1],
                                     unit_mm * (double)at[2]});
}

/* The vertices that triangles have, in order; the triangles get their new numbers. */
static bool keep_used(struct objmesh *mesh, struct morphable *m, struct placing *p)
{
    uint32_t *number = calloc(mesh->nv, sizeof *number);

    p->nv = mesh->nv;
    p->kept = calloc(mesh->nv, sizeof *p->kept);
    if (number == NULL || p->kept == NULL) {
        free(number);
        return false;
    }
    for (uint32_t t = 0; t < mesh->nt; t++)
        for (int k = 0; k < 3; k++)
            number[mesh->corner[t][k]] = 1;
    for (uint32_t v = 0; v < mesh->nv; v++)
        if (number[v] != 0) {
            number[v] = m->nv;
            p->kept[m->nv++] = v;
        }
    for (uint32_t t = 0; t < mesh->nt; t++)
        for (int k = 0; k < 3; k++)
            mesh->corner[t][k] = number[mesh->corner[t][k]];
    free(number);
    m->corner = mesh->corner;
    m->nt = mesh->nt;
    mesh->corner = NULL;
    return true;
}

/* The unit by the mesh's height; false: there is none by which it is a head or a face. */
static bool find_unit(const struct objmesh *mesh, const struct morphable *m,
                      struct placing *p)
{
    static const double units[] = {1, 10, 1000};
    double low = INFINITY, high = -INFINITY;

    for (uint32_t i = 0; i < m->nv; i++) {
        const double y = (double)mesh->at[3 * (size_t)p->kept[i] + 1];

        low = fmin(low, y);
        high = fmax(high, y);
    }
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
        if (units[i] * (high - low) >= LOWEST_MM &&
            units[i] * (high - low) < HIGHEST_MM) {
            p->unit_mm = units[i];
            return true;
        }
    return false;
}

static void move_neutral(const struct objmesh *mesh, const struct placing *p,
                         struct morphable *m)
{
    for (uint32_t i = 0; i < m->nv; i++) {
        const struct dvec3 q =
            place(&p->pose, p->unit_mm, mesh->at + 3 * (size_t)p->kept[i]);
        float *to = m->neutral + 3 * (size_t)i;

        to[0] = (float)q.x;
        to[1] = (float)q.y;
        to[2] = (float)q.z;
    }
}

/* The foremost vertex near the plane of symmetry comes to the origin: the nose tip, unless the
 * chin is farther in front. */
static void place_roughly(const struct objmesh *mesh, struct morphable *m,
                          struct placing *p)
{
    const float *best = NULL;

    p->pose = (struct pose){{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    move_neutral(mesh, p, m);
    for (const float *at = m->neutral; at < m->neutral + 3 * (size_t)m->nv; at += 3)
        if (fabs((double)at[0]) < MIDDLE_MM && (best == NULL || at[2] > best[2]))
            best = at;
    if (best != NULL) {
        p->pose.t[1] = -(double)best[1];
        p->pose.t[2] = -(double)best[2];
    }
}

/* The height on the plane of symmetry, linear between the cells' middles; NAN off the grid. */
static double middle(const float h[GRID_N], double y)
{
    const double row = (y - GRID_BOTTOM) / GRID_MM - 0.5, whole = floor(row);
    double below, above;
    uint32_t i;

    if (!(whole >= 0 && whole < GRID_NY - 1))
        return (double)NAN;
    i = (uint32_t)whole * GRID_NX + GRID_NX / 2;
    below = ((double)h[i - 1] + (double)h[i]) / 2;
    above = ((double)h[i - 1 + GRID_NX] + (double)h[i + GRID_NX]) / 2;
    return below + (row - whole) * (above - below);
}

/* Append the motion that makes the heights upright and brings their nose tip to the origin; false:
 * they have no nose, or reach less far than they must. */
static bool upright(const float h[GRID_N], struct pose *pose)
{
    const double first = GRID_BOTTOM + GRID_MM / 2; /* the lowest row's middle */
    double best = -INFINITY, at = 0, a, b, c, top, bottom;

    for (double y = first; y < NOSE_MM; y += GRID_MM)
        if (y > -NOSE_MM && middle(h, y) > best) {
            best = middle(h, y);
            at = y;
        }
    a = middle(h, at - GRID_MM); /* a parabola through the three highest */
    b = middle(h, at);
    c = middle(h, at + GRID_MM);
    top = middle(h, at + UPRIGHT_MM);
    bottom = middle(h, at - UPRIGHT_MM);
    if (!(a < b && c < b) || !(b - (top + bottom) / 2 > STANDS_OUT_MM))
        return false;
    at += GRID_MM * 0.5 * (a - c) / (a + c - 2 * b);
    pose->t[1] -= at;
    pose->t[2] -= b;
    pose_move(pose, (struct dvec3){0, 0, 0},
              (const double[6]){-(top - bottom) / (2 * UPRIGHT_MM), 0, 0, 0, 0, 0});
    return true;
}

static bool symmetric(const float h[GRID_N])
{
    double square = 0;
    uint32_t n = 0;

    for (uint32_t i = 0; i < GRID_N; i++) {
        const double d = (double)h[i] - (double)h[grid_mirror(i)];

        if (isnan(d))
            continue;
        square += d * d;
        n++;
    }
    return n >= LEAST_SEEN && square <= n * UNLIKE_MM * UNLIKE_MM;
}

static bool place_neutral(const struct objmesh *mesh, struct morphable *m,
                          struct placing *p)
{
    float h[GRID_N];

    place_roughly(mesh, m, p);
    for (int i = 0; i < PLACINGS; i++) {
        move_neutral(mesh, p, m);
        morphable_heights(m, m->neutral, h);
        if (!upright(h, &p->pose))
            return false;
    }
    move_neutral(mesh, p, m);
    morphable_heights(m, m->neutral, h);
    return symmetric(h);
}

static enum status read_neutral(const struct folder *f, struct morphable *m,
                                struct placing *p, struct errinfo *e)
{
    struct objmesh mesh;
    const char *name = f->name[0], *wrong = NULL; /* there is one: check_folder() */
    enum status st;

    for (uint32_t i = 0; i < f->n; i++)
        name = role_of(f->name[i]) == NEUTRAL ? f->name[i] : name;
    if ((st = read_file(f, name, true, &mesh, e)) != ST_OK)
        return st;
    if (keep_used(&mesh, m, p)) {
        m->neutral = calloc(3 * (size_t)m->nv + 1, sizeof *m->neutral);
        if (m->neutral == NULL)
            st = errinfo_set(e, ST_ENOMEM, "out of memory");
        else if (!find_unit(&mesh, m, p))
            wrong = "neither in mm, cm nor m is it as high as a head or a face";
        else if (!place_neutral(&mesh, m, p))
            wrong = "not a face that looks along z, upright, symmetric to x = 0";
    } else {
        st = errinfo_set(e, ST_ENOMEM, "out of memory");
    }
    objmesh_free(&mesh);
    return wrong == NULL
               ? st
               : errinfo_set(e, ST_ENOTFACE, "%.160s/%.80s: %s", f->dir, name, wrong);
}

/* ---- the other files */

static enum status read_shape(const struct folder *f, const char *name,
                              const struct morphable *m, const struct placing *p,
                              float *out, struct errinfo *e)
{
    struct objmesh mesh;
    enum status st = read_file(f, name, false, &mesh, e);

    if (st == ST_OK && mesh.nv != p->nv)
        st = errinfo_set(e, ST_EINVAL,
                         "%.160s/%.80s: %u vertices, where the neutral face has %u",
                         f->dir, name, (unsigned)mesh.nv, (unsigned)p->nv);
    for (uint32_t i = 0; st == ST_OK && i < m->nv; i++) {
        const struct dvec3 q =
            place(&p->pose, p->unit_mm, mesh.at + 3 * (size_t)p->kept[i]);
        const float *from = m->neutral + 3 * (size_t)i;

        out[3 * (size_t)i] = (float)(q.x - (double)from[0]);
        out[3 * (size_t)i + 1] = (float)(q.y - (double)from[1]);
        out[3 * (size_t)i + 2] = (float)(q.z - (double)from[2]);
    }
    objmesh_free(&mesh);
    return st;
}

static void name_expression(const char *file, struct morphable_expression *out)
{
    /* Looking far aside moves little that is seen; nobody is scanned with an open mouth. */
    const bool half = begins(file, "eyeLook") || begins(file, "jawOpen");

    (void)snprintf(out->name, sizeof out->name, "%.*s",
                   (int)(strlen(file) < 60 ? strlen(file) - 4 : 60), file);
    out->share = half ? 0.5f : 1.0f;
}

/* Each expression of one side finds that of the other. */
static void find_mirrors(struct morphable *m)
{
    for (uint32_t i = 0; i < m->nexpression; i++) {
        char other[sizeof m->kind->name];
        const size_t len = strlen(m->kind[i].name);

        m->kind[i].mirror = i;
        memcpy(other, m->kind[i].name, sizeof other);
        if (len < 2 || other[len - 2] != '_')
            continue;
        other[len - 1] = other[len - 1] == 'L' ? 'R' : 'L';
        for (uint32_t k = 0; k < m->nexpression; k++)
            if (strcmp(m->kind[k].name, other) == 0)
                m->kind[i].mirror = k;
    }
}

static enum status read_shapes(const struct folder *f, struct morphable *m,
                               const struct placing *p, struct errinfo *e)
{
    const size_t each = 3 * (size_t)m->nv;
    const uint32_t ni = count(f, IDENTITY), ne = count(f, EXPRESSION);
    enum status st = ST_OK;

    if ((ni + (size_t)ne) * m->nv > MORPHABLE_VALUES)
        return errinfo_set(e, ST_ELIMIT, "%.160s: more than %d vertices in all", f->dir,
                           MORPHABLE_VALUES);
    m->identity = calloc(ni * each, sizeof *m->identity);
    m->expression = calloc(ne * each, sizeof *m->expression);
    m->kind = calloc(ne, sizeof *m->kind);
    if (m->identity == NULL || m->expression == NULL || m->kind == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    for (uint32_t i = 0; st == ST_OK && i < f->n; i++) {
        const enum role role = role_of(f->name[i]);

        if (role == IDENTITY) {
            st = read_shape(f, f->name[i], m, p, m->identity + m->nidentity * each, e);
            m->nidentity++;
        } else if (role == EXPRESSION) {
            st =
                read_shape(f, f->name[i], m, p, m->expression + m->nexpression * each, e);
            name_expression(f->name[i], &m->kind[m->nexpression++]);
        }
    }
    find_mirrors(m);
    return st;
}

enum status morphable_read(const char *dir, struct morphable **out, struct errinfo *e)
{
    struct placing p = {0};
    struct folder f;
    enum status st;

    if ((*out = calloc(1, sizeof **out)) == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    st = open_folder(dir, &f, e);
    if (st == ST_OK)
        st = read_neutral(&f, *out, &p, e);
    if (st == ST_OK)
        st = read_shapes(&f, *out, &p, e);
    close_folder(&f);
    free(p.kept);
    if (st != ST_OK) {
        morphable_free(*out);
        *out = NULL;
    }
    return st;
}

void morphable_free(struct morphable *m)
{
    if (m == NULL)
        return;
    free(m->neutral);
    free(m->identity);
    free(m->expression);
    free(m->corner);
    free(m->kind);
    free(m);
}

/* ---- random faces */

/* About a standard normal number: twelve uniform ones less 6.  By + - * alone, so that it is the
 * same everywhere; within 6 deviations. */
static double normal(uint64_t *random)
{
    int64_t sum = -(INT64_C(6) << 32);

    for (int i = 0; i < 6; i++) {
        const uint64_t x = rates_random(random);

        sum += (int64_t)(x >> 32) + (int64_t)(x & UINT32_MAX);
    }
    return (double)sum / 4294967296.0;
}

/* Uniform, 0 to below 1. */
static double uniform(uint64_t *random)
{
    return (double)(rates_random(random) >> 11) / 9007199254740992.0;
}

static void add(float *restrict at, float by, const float *restrict mode, size_t n)
{
    for (size_t i = 0; i < n; i++)
        at[i] += by * mode[i];
}

void morphable_person(const struct morphable *m, float deviation, uint64_t *random,
                      float *at)
{
    const size_t each = 3 * (size_t)m->nv;

    memcpy(at, m->neutral, each * sizeof *at);
    for (uint32_t k = 0; k < m->nidentity; k++)
        add(at, deviation * (float)normal(random), m->identity + k * each, each);
}

void morphable_express(const struct morphable *m, uint64_t *random, float *at)
{
    const size_t each = 3 * (size_t)m->nv;
    const uint32_t n = 2 + rates_below(random, 7);
    double much[MORPHABLE_MODES] = {0};

    for (uint32_t k = 0; k < n; k++) {
        const uint32_t i = rates_below(random, m->nexpression);
        const uint32_t other = m->kind[i].mirror;
        const double a = fabs(normal(random)) * 0.45, both = uniform(random);

        much[i] += a;
        if (other != i && both < 0.85)
            much[other] += a * (0.7 + 0.6 * uniform(random));
    }
    for (uint32_t i = 0; i < m->nexpression; i++) {
        const double a = much[i] + fabs(normal(random)) * 0.07;

        add(at, (float)fmin(a, 1.1) * m->kind[i].share, m->expression + i * each, each);
    }
}

void morphable_heights(const struct morphable *m, const float *at, float out[GRID_N])
{
    const struct render_mesh mesh = {
        .at = at, .corner = (const uint32_t(*)[3])m->corner, .nt = m->nt};

    render_heights(&mesh, out);
}
