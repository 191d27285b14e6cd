#include "read.h"

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "cloudlist.h"
#include "cloudtext.h"
#include "cloudvalue.h"
#include "errinfo.h"
#include "mem.h"
#include "status.h"
#include "vec.h"

/* Makes one point of vertices that are equal, for formats that repeat a
 * vertex in each triangle. */

struct weld {
    struct cloudlist *list;
    /* [mask + 1] a hash table: indices of list->out.at plus 1, 0: empty */
    uint32_t *slot;
    size_t mask;
};

#define PROBES 32 /* the table is at most half full, and chains in it are short */

/* weld_open(w, list, most): for at most `most` vertices.  Returns ST_OK, ST_ENOMEM.
 * weld_add(w, p, place): p is added to the list, unless an equal point is there; *place
 * is its number in the file (cloudlist_face()).  As cloudlist_add().  O(1) for every input:
 * in a table filled on purpose an equal point may be overlooked. */
static enum status weld_open(struct weld *w, struct cloudlist *list, size_t most)
{
    size_t n = 1024;

    /* Of a closed mesh a vertex is in six triangles, of a mesh with a border in fewer. */
    while (n < most && n < 2 * list->max)
        n *= 2;
    *w = (struct weld){.list = list, .mask = n - 1};
    if ((w->slot = mem_array(n, sizeof *w->slot)) == NULL)
        return errinfo_set(list->e, ST_ENOMEM, "no memory for the vertices");
    memset(w->slot, 0, n * sizeof *w->slot);
    return ST_OK;
}

static void weld_close(struct weld *w)
{
    mem_free(w->slot);
    w->slot = NULL;
}

static uint64_t mix(uint64_t h, double v)
{
    uint64_t bits;

    v += 0.0; /* one zero */
    memcpy(&bits, &v, sizeof bits);
    bits ^= bits >> 32; /* of a float's value the lower bits are all zero */
    h = (h ^ bits) * UINT64_C(0xBF58476D1CE4E5B9); /* of splitmix64 */
    return h ^ (h >> 32);
}

static enum status weld_add(struct weld *w, struct dvec3 p, uint64_t *place)
{
    const struct cloudpoints *out = &w->list->out;
    const uint64_t h = mix(mix(mix(0, p.x), p.y), p.z);
    uint32_t *slot = NULL;
    enum status st;

    for (size_t i = 0; i < PROBES; i++) {
        slot = &w->slot[(h + i) & w->mask];
        if (*slot == 0)
            break;
        if (out->at[*slot - 1].x == p.x && out->at[*slot - 1].y == p.y &&
            out->at[*slot - 1].z == p.z) {
            *place = out->index != NULL ? out->index[*slot - 1] : *slot - 1;
            return ST_OK;
        }
    }
    if ((st = cloudlist_add(w->list, p)) != ST_OK)
        return st;
    *place = out->read - 1;
    if (*slot == 0 && w->list->kept)
        *slot = (uint32_t)out->n;
    return ST_OK;
}

/* A binary file: 80 bytes of anything, a count, and as many triangles: normal, corners,
 * two bytes.  All little-endian. */
#define HEAD     84
#define TRIANGLE 50

static uint64_t count_of(const struct cloudtext *t)
{
    return (uint64_t)cloudvalue_load((const unsigned char *)t->p + 80, CLOUDVALUE_U32,
                                     cloudvalue_swap(false));
}

/* Some of them begin with the word solid as well: the length decides. */
static bool is_binary(const struct cloudtext *t)
{
    const uint64_t len = (uint64_t)(t->end - t->p);

    return len >= HEAD && len == HEAD + TRIANGLE * count_of(t);
}

static bool is_solid(const struct cloudtext *t)
{
    struct cloudtext at = *t;
    size_t len;
    const char *word = cloudtext_word(&at, &len);

    return cloudtext_like(word, len, "solid");
}

bool read_stl_is(const struct cloudtext *t)
{
    return is_binary(t) || is_solid(t);
}

/* ---- binary */

static enum status read_triangle(struct weld *weld, const unsigned char *p)
{
    const bool swap = cloudvalue_swap(false);
    uint64_t corner[3];

    p += 12; /* the normal is not needed: the corners' order says it */
    for (int i = 0; i < 3; i++) {
        double v[3];
        enum status st;

        for (int k = 0; k < 3; k++, p += 4)
            v[k] = cloudvalue_load(p, CLOUDVALUE_F32, swap);
        if ((st = weld_add(weld, (struct dvec3){v[0], v[1], v[2]}, &corner[i])) != ST_OK)
            return st;
    }
    return cloudlist_face(weld->list, corner);
}

static enum status read_binary(struct cloudtext *t, struct cloudlist *list)
{
    const uint64_t len = (uint64_t)(t->end - t->p);
    struct weld weld;
    uint64_t n;
    enum status st;

    t->line = 0;
    if (len < HEAD)
        return cloudtext_fail(t, ST_EINVAL,
                              "neither the word solid nor the %d bytes that begin a "
                              "binary STL file",
                              HEAD);
    n = count_of(t);
    if (len != HEAD + TRIANGLE * n)
        return cloudtext_fail(
            t, ST_EINVAL, "%llu triangles take %llu bytes, the STL file has %llu",
            (unsigned long long)n, (unsigned long long)(HEAD + TRIANGLE * n),
            (unsigned long long)len);
    st = weld_open(&weld, list, 3 * (size_t)n);
    for (t->p += HEAD; st == ST_OK && t->p < t->end; t->p += TRIANGLE)
        st = read_triangle(&weld, (const unsigned char *)t->p);
    weld_close(&weld);
    return st;
}

/* ---- text */

/* What stands in a file, and what may come after it. */
enum place { OUTSIDE, IN_SOLID, IN_FACET, IN_LOOP };

struct read_stl_reading {
    struct cloudtext *t;
    struct weld weld;
    enum place place;
    int corners; /* of the facet, up to now */
    uint64_t corner[3];
};

static enum status read_vertex(struct read_stl_reading *r)
{
    double v[3];
    enum status st;

    if (r->corners == 3)
        return cloudtext_fail(r->t, ST_EINVAL, "a facet with more than three vertices");
    for (int i = 0; i < 3; i++)
        if ((st = cloudtext_number(r->t, &v[i])) != ST_OK)
            return st;
    return weld_add(&r->weld, (struct dvec3){v[0], v[1], v[2]}, &r->corner[r->corners++]);
}

static enum status end_loop(struct read_stl_reading *r)
{
    if (r->corners != 3)
        return cloudtext_fail(r->t, ST_EINVAL, "a facet with fewer than three vertices");
    r->corners = 0;
    return cloudlist_face(r->weld.list, r->corner);
}

/* A line by its first word; the rest is skipped. */
static enum status read_stl_read_line(struct read_stl_reading *r)
{
    static const struct {
        const char *word;
        enum place in, then;
        enum status (*read)(struct read_stl_reading *r);
    } line[] = {{"solid", OUTSIDE, IN_SOLID, NULL},
                {"facet", IN_SOLID, IN_FACET, NULL},
                {"outer", IN_FACET, IN_LOOP, NULL},
                {"vertex", IN_LOOP, IN_LOOP, read_vertex},
                {"endloop", IN_LOOP, IN_FACET, end_loop},
                {"endfacet", IN_FACET, IN_SOLID, NULL},
                {"endsolid", IN_SOLID, OUTSIDE, NULL}};
    size_t len;
    const char *word = cloudtext_word(r->t, &len);

    if (len == 0)
        return ST_OK;
    for (size_t i = 0; i < sizeof line / sizeof *line; i++) {
        if (r->place != line[i].in || !cloudtext_like(word, len, line[i].word))
            continue;
        r->place = line[i].then;
        return line[i].read != NULL ? line[i].read(r) : ST_OK;
    }
    r->t->p = word;
    return cloudtext_fail(r->t, ST_EINVAL, "malformed STL file");
}

static enum status read_text(struct cloudtext *t, struct cloudlist *list)
{
    struct read_stl_reading r = {.t = t};
    enum status st = cloudtext_plain(t);

    if (st == ST_OK) /* a vertex takes a line of 13 bytes or more */
        st = weld_open(&r.weld, list, (size_t)(t->end - t->p) / 13 + 1);
    while (st == ST_OK && t->p < t->end) {
        st = read_stl_read_line(&r);
        if (st == ST_OK)
            cloudtext_skip(t);
    }
    weld_close(&r.weld);
    if (st == ST_OK && r.place != OUTSIDE)
        return cloudtext_fail(t, ST_EINVAL, "the STL file ends within a solid");
    return st;
}

enum status read_stl_parse(struct cloudtext *t, const struct cloudfile_options *o,
                           struct cloudlist *list)
{
    (void)o;
    return !is_binary(t) && is_solid(t) ? read_text(t, list) : read_binary(t, list);
}
