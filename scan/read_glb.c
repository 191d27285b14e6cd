#include "read.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "cloudlist.h"
#include "cloudtext.h"
#include "cloudvalue.h"
#include "errinfo.h"
#include "json.h"
#include "mem.h"
#include "status.h"

#define GLB_VALUES 100000 /* of JSON; 80 bytes each */

/* What may be read: as much as the file has, if a vertex takes VERTEX bytes and an index 1; and MORE,
 * but no more than TIMES its length, since numbers may be smaller and meshes shown several times. */
#define GLB_VERTEX 12
#define GLB_MORE   ((uint64_t)1 << 20)
#define GLB_TIMES  4

/* Arrays of numbers in the binary chunk of a GLB file, as its JSON
 * describes them (glTF 2.0, section 3.6). */

/* The values of an array of the document. */
struct accessor_items {
    const struct json_value **at; /* by mem_free() */
    size_t n;
};

struct accessor_file {
    struct accessor_items accessors, views, buffers;
    const unsigned char *bin;
    size_t len;
    struct errinfo *e;
};

struct accessor {
    const unsigned char *at;
    size_t n, stride;
    enum cloudvalue type;
    double scale; /* of a value */
};

/* accessor_items(document, name, out, e): of its member, an array of objects; none: no
 * items.  Returns ST_OK, ST_EINVAL, ST_ENOMEM. */
static enum status accessor_items(const struct json_value *document, const char *name,
                                  struct accessor_items *out, struct errinfo *e)
{
    const struct json_value *array = json_member(document, name);
    size_t n = 0;

    *out = (struct accessor_items){0};
    if (array == NULL)
        return ST_OK;
    if (!json_is_array(array))
        return errinfo_set(e, ST_EINVAL, "GLB: %s is not an array", name);
    if ((out->at = mem_array(json_count(array), sizeof *out->at)) == NULL)
        return errinfo_set(e, ST_ENOMEM, "no memory for the GLB file");
    for (const struct json_value *v = json_first(array); v != NULL; v = json_next(v))
        out->at[n++] = v;
    out->n = n;
    return ST_OK;
}

/* A member that is a count, or, if it is not there, otherwise.  False: something else. */
static bool count_or(const struct json_value *object, const char *name,
                     uint64_t otherwise, uint64_t *out)
{
    const struct json_value *v = json_member(object, name);

    *out = otherwise;
    return v == NULL || json_get_count(v, out);
}

/* Where a view of the chunk is, and how long. */
static enum status open_view(const struct accessor_file *f, uint64_t index,
                             uint64_t *offset, uint64_t *len, uint64_t *stride)
{
    const struct json_value *view;
    uint64_t buffer;

    if (index >= f->views.n)
        return errinfo_set(f->e, ST_EINVAL, "GLB: there is no bufferView %llu",
                           (unsigned long long)index);
    view = f->views.at[index];
    if (!count_or(view, "buffer", UINT64_MAX, &buffer) ||
        !count_or(view, "byteOffset", 0, offset) ||
        !count_or(view, "byteLength", UINT64_MAX, len) ||
        !count_or(view, "byteStride", 0, stride) || buffer >= f->buffers.n)
        return errinfo_set(f->e, ST_EINVAL, "GLB: bufferView %llu is malformed",
                           (unsigned long long)index);
    if (buffer != 0 || json_member(f->buffers.at[0], "uri") != NULL)
        return errinfo_set(f->e, ST_EVERSION,
                           "GLB: buffer %llu is not in the file, and nothing is opened: "
                           "export with all buffers in the GLB",
                           (unsigned long long)buffer);
    if (*offset > f->len || *len > f->len - *offset)
        return errinfo_set(f->e, ST_EINVAL,
                           "GLB: bufferView %llu is beyond the %zu bytes of data",
                           (unsigned long long)index, f->len);
    return ST_OK;
}

static bool set_type(uint64_t component, bool normalized, struct accessor *out)
{
    static const struct {
        uint64_t component;
        enum cloudvalue type;
        double most;
    } known[] = {{5120, CLOUDVALUE_I8, 127},    {5121, CLOUDVALUE_U8, 255},
                 {5122, CLOUDVALUE_I16, 32767}, {5123, CLOUDVALUE_U16, 65535},
                 {5125, CLOUDVALUE_U32, 1},     {5126, CLOUDVALUE_F32, 1}};

    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        if (known[i].component != component)
            continue;
        out->type = known[i].type;
        out->scale = normalized ? 1 / known[i].most : 1;
        return true;
    }
    return false;
}

/* accessor_open(f, index, type, out): an accessor of the type "VEC3" or "SCALAR", all of
 * which is in the chunk.
 * Returns ST_OK; ST_EINVAL; ST_EVERSION: sparse, or its data is elsewhere. */
static enum status accessor_open(const struct accessor_file *f, uint64_t index,
                                 const char *type, struct accessor *out)
{
    const struct json_value *a = index < f->accessors.n ? f->accessors.at[index] : NULL;
    const char *is = json_get_text(json_member(a, "type"));
    uint64_t component, n, from, view, offset, len, stride, size;
    bool normalized = false;
    enum status st;

    (void)json_get_flag(json_member(a, "normalized"), &normalized);
    if (is == NULL || strcmp(is, type) != 0 ||
        !count_or(a, "componentType", 0, &component) || !count_or(a, "count", 0, &n) ||
        !count_or(a, "byteOffset", 0, &from) ||
        !count_or(a, "bufferView", UINT64_MAX, &view) ||
        !set_type(component, normalized, out))
        return errinfo_set(f->e, ST_EINVAL, "GLB: accessor %llu is not a %s of numbers",
                           (unsigned long long)index, type);
    if (json_member(a, "sparse") != NULL || view == UINT64_MAX)
        return errinfo_set(f->e, ST_EVERSION,
                           "GLB: accessor %llu %s, which is not read: export without it",
                           (unsigned long long)index,
                           json_member(a, "sparse") != NULL ? "is sparse"
                                                            : "has no data");
    if ((st = open_view(f, view, &offset, &len, &stride)) != ST_OK)
        return st;
    size = cloudvalue_size[out->type] * (strcmp(type, "VEC3") == 0 ? 3U : 1U);
    if (stride == 0)
        stride = size;
    if (from > len || stride < size || stride > f->len || n > f->len ||
        (n > 0 && (len - from < size || (len - from - size) / stride < n - 1)))
        return errinfo_set(f->e, ST_EINVAL, "GLB: accessor %llu is beyond its bufferView",
                           (unsigned long long)index);
    out->at = f->bin + offset + from;
    out->n = (size_t)n;
    out->stride = (size_t)stride;
    return ST_OK;
}

/* accessor_get(a, i, k): component k of its element i. */
static double accessor_get(const struct accessor *a, size_t i, size_t k)
{
    return a->scale *
           cloudvalue_load(a->at + i * a->stride + k * cloudvalue_size[a->type], a->type,
                           cloudvalue_swap(false));
}

#define CHUNK_JSON 0x4E4F534AU
#define CHUNK_BIN  0x004E4942U

#define TRIANGLES 4 /* a primitive's mode */

/* A node that is still to be read. */
struct pending {
    uint64_t node;
    double above[16]; /* what moves its parent, row by row */
};

struct scene {
    struct json_value *doc;
    struct accessor_file file;
    struct accessor_items nodes, meshes;
    struct pending *stack; /* [nodes.n] */
    unsigned char *seen;   /* [nodes.n] */
    size_t depth;
    uint64_t work; /* bytes that may still be read (GLB_VERTEX) */
    struct cloudlist *list;
    struct errinfo *e;
};

/* ---- the file's parts */

static uint32_t word_at(const char *p)
{
    return (uint32_t)cloudvalue_load((const unsigned char *)p, CLOUDVALUE_U32,
                                     cloudvalue_swap(false));
}

/* The chunk at t->p, of a type; t moves behind it. */
static enum status take_chunk(struct cloudtext *t, uint32_t type, const char **data,
                              size_t *len)
{
    if (t->end - t->p < 8 || word_at(t->p + 4) != type)
        return cloudtext_fail(t, ST_EINVAL, "a chunk of JSON or BIN is expected here");
    *len = word_at(t->p);
    if (*len > (size_t)(t->end - t->p) - 8)
        return cloudtext_fail(t, ST_EINVAL, "the GLB file is cut off");
    *data = t->p + 8;
    t->p += 8 + *len;
    return ST_OK;
}

static enum status read_document(struct scene *s, const char *text, size_t len)
{
    struct errinfo e = {0};
    char *copy = malloc(len + 1);
    enum status st;

    if (copy == NULL)
        return errinfo_set(s->e, ST_ENOMEM, "no memory for the GLB file");
    memcpy(copy, text, len);
    copy[len] = '\0';
    while (len > 0 && copy[len - 1] == '\0')
        len--; /* some pad with it, though the format has blanks for that */
    st = json_read(copy, len, GLB_VALUES, &s->doc, &e);
    mem_free(copy);
    return st == ST_OK ? ST_OK : errinfo_set(s->e, st, "GLB: %.200s", e.msg);
}

static enum status open_file(struct cloudtext *t, struct scene *s)
{
    const char *text, *bin = NULL;
    size_t len;
    enum status st;

    t->line = 0;
    if (!read_glb_is(t) || t->end - t->p < 12)
        return cloudtext_fail(t, ST_EINVAL, "a GLB file begins with glTF, and 12 bytes");
    if (word_at(t->p + 4) != 2)
        return cloudtext_fail(t, ST_EVERSION, "glTF of version %lu, not 2",
                              (unsigned long)word_at(t->p + 4));
    if (word_at(t->p + 8) > (size_t)(t->end - t->p))
        return cloudtext_fail(t, ST_EINVAL, "the GLB file is cut off");
    t->end = t->p + word_at(t->p + 8);
    t->p = t->p + 12 <= t->end ? t->p + 12 : t->end;
    if ((st = take_chunk(t, CHUNK_JSON, &text, &len)) == ST_OK)
        st = read_document(s, text, len);
    if (st == ST_OK && t->p < t->end)
        st = take_chunk(t, CHUNK_BIN, &bin, &s->file.len);
    s->file.bin = (const unsigned char *)bin;
    return st;
}

/* Returns true if an array of names has this one. */
static bool lists(const struct json_value *names, const char *name)
{
    const struct json_value *v = json_first(names);

    while (v != NULL && (json_get_text(v) == NULL || strcmp(json_get_text(v), name) != 0))
        v = json_next(v);
    return v != NULL;
}

static bool has_extension(const struct json_value *object, const char *name)
{
    return json_member(json_member(object, "extensions"), name) != NULL;
}

/* Returns true if the file says anywhere that it has this extension. */
static bool declares(const struct scene *s, const char *name)
{
    for (size_t i = 0; i < s->file.views.n; i++)
        if (has_extension(s->file.views.at[i], name))
            return true;
    for (size_t i = 0; i < s->meshes.n; i++) {
        const struct json_value *p =
            json_first(json_member(s->meshes.at[i], "primitives"));

        for (; p != NULL; p = json_next(p))
            if (has_extension(p, name))
                return true;
    }
    return lists(json_member(s->doc, "extensionsUsed"), name);
}

/* Names the extension that compresses the geometry, if the file requires it or, if required is false,
 * has it. */
static enum status check_extensions(const struct scene *s, bool required)
{
    static const char *const known[] = {"KHR_draco_mesh_compression",
                                        "EXT_meshopt_compression",
                                        "KHR_meshopt_compression"};

    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (required ? lists(json_member(s->doc, "extensionsRequired"), known[i])
                     : declares(s, known[i]))
            return errinfo_set(s->e, ST_EVERSION,
                               "GLB: its mesh is compressed by %s, which is not read: "
                               "export without compression",
                               known[i]);
    return ST_OK;
}

static enum status open_scene(struct scene *s)
{
    struct accessor_file *f = &s->file;
    enum status st;

    f->e = s->e;
    if ((st = check_extensions(s, true)) != ST_OK ||
        (st = accessor_items(s->doc, "accessors", &f->accessors, s->e)) != ST_OK ||
        (st = accessor_items(s->doc, "bufferViews", &f->views, s->e)) != ST_OK ||
        (st = accessor_items(s->doc, "buffers", &f->buffers, s->e)) != ST_OK ||
        (st = accessor_items(s->doc, "meshes", &s->meshes, s->e)) != ST_OK ||
        (st = accessor_items(s->doc, "nodes", &s->nodes, s->e)) != ST_OK)
        return st;
    s->stack = mem_array(s->nodes.n, sizeof *s->stack);
    s->seen = mem_array(s->nodes.n, 1);
    if (s->stack == NULL || s->seen == NULL)
        return errinfo_set(s->e, ST_ENOMEM, "no memory for the GLB file");
    memset(s->seen, 0, s->nodes.n);
    s->work = f->len + GLB_MORE;
    if (s->work > GLB_TIMES * (uint64_t)f->len)
        s->work = GLB_TIMES * (uint64_t)f->len;
    return ST_OK;
}

static void close_scene(struct scene *s)
{
    json_free(s->doc);
    mem_free(s->file.accessors.at);
    mem_free(s->file.views.at);
    mem_free(s->file.buffers.at);
    mem_free(s->meshes.at);
    mem_free(s->nodes.at);
    mem_free(s->stack);
    mem_free(s->seen);
}

/* ---- transforms */

/* n numbers of an array; absent: out stays as it is. */
static bool numbers(const struct json_value *array, size_t n, double *out)
{
    const struct json_value *v = json_first(array);

    if (array == NULL)
        return true;
    if (!json_is_array(array) || json_count(array) != n)
        return false;
    for (size_t i = 0; i < n; i++, v = json_next(v))
        if (!json_get_number(v, &out[i]))
            return false;
    return true;
}

/* A node's own, row by row: its matrix, or translation after rotation after scale. */
static bool transform_of(const struct json_value *node, double out[16])
{
    double m[16] = {1, 0, 0, 0, 0, 1, 0, 0,
                    0, 0, 1, 0, 0, 0, 0, 1}; /* column by column */
    double t[3] = {0, 0, 0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1};

    if (!numbers(json_member(node, "matrix"), 16, m) ||
        !numbers(json_member(node, "translation"), 3, t) ||
        !numbers(json_member(node, "rotation"), 4, q) ||
        !numbers(json_member(node, "scale"), 3, s))
        return false;
    if (json_member(node, "matrix") == NULL) {
        const double x = q[0], y = q[1], z = q[2], w = q[3];
        const double r[9] = {
            1 - 2 * (y * y + z * z), 2 * (x * y - z * w),     2 * (x * z + y * w),
            2 * (x * y + z * w),     1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
            2 * (x * z - y * w),     2 * (y * z + x * w),     1 - 2 * (x * x + y * y)};

        for (int i = 0; i < 9; i++)
            m[4 * (i % 3) + i / 3] = r[i] * s[i % 3];
        for (int i = 0; i < 3; i++)
            m[12 + i] = t[i];
    }
    for (int i = 0; i < 16; i++)
        out[i] = m[4 * (i % 4) + i / 4];
    return true;
}

/* Does it turn right into left?  Then the corners of a face change their order. */
static bool mirrors(const double m[16])
{
    const struct dvec3 x = {m[0], m[4], m[8]}, y = {m[1], m[5], m[9]},
                       z = {m[2], m[6], m[10]};

    return vec_dot(vec_cross(x, y), z) < 0;
}

/* ---- meshes */

static enum status spend(struct scene *s, uint64_t n)
{
    if (n > s->work)
        return errinfo_set(
            s->e, ST_ELIMIT,
            "GLB: more vertices and indices than a file of this length has");
    s->work -= n;
    return ST_OK;
}

static enum status add_vertices(struct scene *s, const struct accessor *a,
                                const double m[16])
{
    enum status st = spend(s, (uint64_t)a->n * GLB_VERTEX);

    for (size_t i = 0; i < a->n && st == ST_OK; i++) {
        const struct dvec3 p = {accessor_get(a, i, 0), accessor_get(a, i, 1),
                                accessor_get(a, i, 2)};

        st = cloudlist_add(s->list, vec_transform(m, p));
    }
    return st;
}

/* The triangles of n vertices, of which the first has the number `base`. */
static enum status add_faces(struct scene *s, const struct json_value *primitive,
                             uint64_t base, size_t n, bool mirrored)
{
    const struct json_value *indices = json_member(primitive, "indices");
    struct accessor a = {.n = n};
    uint64_t which;
    enum status st = ST_OK;

    if (indices != NULL)
        st = json_get_count(indices, &which)
                 ? accessor_open(&s->file, which, "SCALAR", &a)
                 : errinfo_set(s->e, ST_EINVAL,
                               "GLB: the indices of a primitive are not an "
                               "accessor");
    if (st == ST_OK)
        st = spend(s, a.n);
    for (size_t i = 0; i + 2 < a.n && st == ST_OK; i += 3) {
        uint64_t corner[3];

        for (size_t k = 0; k < 3; k++) {
            const size_t at = i + (mirrored ? 2 - k : k);
            const double v = indices != NULL ? accessor_get(&a, at, 0) : (double)at;

            if (!(v >= 0 && v < (double)n))
                return errinfo_set(s->e, ST_EINVAL,
                                   "GLB: index %zu of a mesh is beyond its %zu vertices",
                                   at, n);
            corner[k] = base + (uint64_t)v;
        }
        st = cloudlist_face(s->list, corner);
    }
    return st;
}

/* The primitives of a mesh; several that share their vertices have them once. */
static enum status read_mesh(struct scene *s, uint64_t index, const double m[16])
{
    const struct json_value *p;
    uint64_t base = 0, last = UINT64_MAX, position, mode;
    struct accessor a = {.n = 0};
    enum status st = ST_OK;

    if (index >= s->meshes.n)
        return errinfo_set(s->e, ST_EINVAL, "GLB: there is no mesh %llu",
                           (unsigned long long)index);
    p = json_first(json_member(s->meshes.at[index], "primitives"));
    for (; p != NULL && st == ST_OK; p = json_next(p)) {
        const struct json_value *v =
            json_member(json_member(p, "attributes"), "POSITION");

        if (!json_get_count(v, &position))
            continue; /* nothing to be seen of it */
        if (position != last) {
            base = s->list->out.read;
            last = position;
            st = accessor_open(&s->file, position, "VEC3", &a);
            if (st == ST_OK)
                st = add_vertices(s, &a, m);
        }
        if (!json_get_count(json_member(p, "mode"), &mode))
            mode = TRIANGLES;
        if (st == ST_OK && mode == TRIANGLES)
            st = add_faces(s, p, base, a.n, mirrors(m));
    }
    return st;
}

/* ---- nodes */

/* The nodes of a list are read next; each belongs to one only, so the stack has room. */
static enum status push(struct scene *s, const struct json_value *list,
                        const double above[16])
{
    for (const struct json_value *v = json_first(list); v != NULL; v = json_next(v)) {
        struct pending *p = &s->stack[s->depth];
        uint64_t node;

        if (!json_get_count(v, &node) || node >= s->nodes.n || s->seen[node])
            return errinfo_set(s->e, ST_EINVAL,
                               "GLB: the nodes of the scene do not make a tree");
        s->seen[node] = 1;
        p->node = node;
        memcpy(p->above, above, sizeof p->above);
        s->depth++;
    }
    return ST_OK;
}

static enum status read_nodes(struct scene *s)
{
    enum status st = ST_OK;

    while (s->depth > 0 && st == ST_OK) {
        const struct pending p = s->stack[--s->depth];
        const struct json_value *node = s->nodes.at[p.node];
        double own[16], m[16];
        uint64_t mesh;

        if (!transform_of(node, own))
            return errinfo_set(s->e, ST_EINVAL,
                               "GLB: the transform of node %llu is malformed",
                               (unsigned long long)p.node);
        vec_after(p.above, own, m);
        if (json_get_count(json_member(node, "mesh"), &mesh))
            st = read_mesh(s, mesh, m);
        if (st == ST_OK)
            st = push(s, json_member(node, "children"), m);
    }
    return st;
}

/* The nodes that are no other's children are read next, as if they were of a scene. */
static void push_roots(struct scene *s, const double above[16])
{
    for (size_t i = 0; i < s->nodes.n; i++) {
        const struct json_value *v = json_first(json_member(s->nodes.at[i], "children"));
        uint64_t child;

        for (; v != NULL; v = json_next(v))
            if (json_get_count(v, &child) && child < s->nodes.n)
                s->seen[child] = 1;
    }
    for (size_t i = 0; i < s->nodes.n; i++)
        if (s->seen[i] == 0) {
            s->stack[s->depth].node = i;
            memcpy(s->stack[s->depth++].above, above, sizeof s->stack->above);
        }
    memset(s->seen, 0, s->nodes.n);
    for (size_t i = 0; i < s->depth; i++)
        s->seen[s->stack[i].node] = 1;
}

/* The scene that is shown first; a file without scenes is one. */
static enum status read_scene(struct scene *s)
{
    static const double none[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    const struct json_value *v = json_first(json_member(s->doc, "scenes"));
    uint64_t which = 0;
    enum status st = ST_OK;

    if (v == NULL)
        push_roots(s, none);
    (void)json_get_count(json_member(s->doc, "scene"), &which);
    while (v != NULL && which-- > 0)
        v = json_next(v);
    if (v != NULL)
        st = push(s, json_member(v, "nodes"), none);
    for (size_t i = 0; st == ST_OK && s->nodes.n == 0 && i < s->meshes.n; i++)
        st = read_mesh(s, i, none);
    return st == ST_OK ? read_nodes(s) : st;
}

bool read_glb_is(const struct cloudtext *t)
{
    return t->end - t->p >= 4 && memcmp(t->p, "glTF", 4) == 0;
}

enum status read_glb_parse(struct cloudtext *t, const struct cloudfile_options *o,
                           struct cloudlist *list)
{
    (void)o;
    struct scene s = {.list = list, .e = list->e};
    enum status st = open_file(t, &s);

    if (st == ST_OK)
        st = open_scene(&s);
    if (st == ST_OK && (st = read_scene(&s)) == ST_EVERSION)
        (void)check_extensions(&s, false);
    list->out.usual_mm = 1000; /* glTF is in metres */
    if (st == ST_OK && list->out.read == 0)
        st = errinfo_set(s.e, ST_EINVAL,
                         "GLB: no node of the scene has a mesh with points");
    close_scene(&s);
    return st;
}
