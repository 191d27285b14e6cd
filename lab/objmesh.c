#include "objmesh.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cloudtext.h"

#define FARTHEST 1e6 /* of a coordinate, in the file's unit */

struct reading {
    struct objmesh *out;
    size_t vertex_room, triangle_room;
    bool (*takes)(const char *material);
    bool taken; /* the present material is */
};

static enum status no_memory(struct cloudtext *t)
{
    return cloudtext_fail(t, ST_ENOMEM, "out of memory");
}

/* Room for one more of n objects; false: no memory. */
static bool grow(void **list, uint32_t n, size_t *room, size_t size)
{
    const size_t more = *room > 0 ? 2 * *room : 1024;
    void *larger;

    if (n < *room)
        return true;
    if ((larger = realloc(*list, more * size)) == NULL)
        return false;
    *list = larger;
    *room = more;
    return true;
}

static enum status vertex(struct reading *r, struct cloudtext *t)
{
    struct objmesh *const m = r->out;
    void *at = m->at;

    if (m->nv == OBJMESH_MAX)
        return cloudtext_fail(t, ST_ELIMIT, "more than %d vertices", OBJMESH_MAX);
    if (!grow(&at, m->nv, &r->vertex_room, 3 * sizeof *m->at))
        return no_memory(t);
    m->at = at;
    for (int i = 0; i < 3; i++) {
        double v;
        const enum status st = cloudtext_number(t, &v);

        if (st != ST_OK)
            return st;
        if (!(fabs(v) < FARTHEST))
            return cloudtext_fail(t, ST_ENOTFINITE,
                                  "a coordinate is not a number, or too large");
        m->at[3 * (size_t)m->nv + (size_t)i] = (float)v;
    }
    m->nv++;
    return ST_OK;
}

/* The vertex that a corner names, as 7, 7/1 or 7//2; from 1. */
static enum status corner(const struct reading *r, struct cloudtext *t, const char *word,
                          size_t len, uint32_t *out)
{
    const char *slash = memchr(word, '/', len);
    uint64_t k;

    if (!cloudtext_count(word, slash != NULL ? (size_t)(slash - word) : len, &k) ||
        k == 0 || k > r->out->nv)
        return cloudtext_fail(t, ST_EINVAL,
                              "a face's corner is not an earlier vertex: \"%.*s\"",
                              len < 30 ? (int)len : 30, word);
    *out = (uint32_t)k - 1;
    return ST_OK;
}

static enum status add_triangle(struct reading *r, struct cloudtext *t,
                                const uint32_t c[3])
{
    struct objmesh *const m = r->out;
    void *at = m->corner;

    if (m->nt == OBJMESH_MAX)
        return cloudtext_fail(t, ST_ELIMIT, "more than %d triangles", OBJMESH_MAX);
    if (!grow(&at, m->nt, &r->triangle_room, sizeof *m->corner))
        return no_memory(t);
    m->corner = at;
    memcpy(m->corner[m->nt++], c, sizeof *m->corner);
    return ST_OK;
}

static enum status face(struct reading *r, struct cloudtext *t)
{
    uint32_t c[3];
    enum status st = ST_OK;

    for (unsigned n = 0; st == ST_OK; n++) {
        size_t len;
        const char *word = cloudtext_word(t, &len);

        if (len == 0)
            return n >= 3
                       ? ST_OK
                       : cloudtext_fail(t, ST_EINVAL, "a face of fewer than 3 corners");
        st = corner(r, t, word, len, &c[n < 3 ? n : 2]);
        if (st == ST_OK && n >= 2) {
            st = add_triangle(r, t, c);
            c[1] = c[2];
        }
    }
    return st;
}

static void material(struct reading *r, struct cloudtext *t)
{
    char name[128];
    size_t len;
    const char *word = cloudtext_word(t, &len);

    (void)snprintf(name, sizeof name, "%.*s", len < sizeof name ? (int)len : 0, word);
    r->taken = r->takes(name);
}

static enum status line(struct reading *r, struct cloudtext *t)
{
    size_t len;
    const char *word = cloudtext_word(t, &len);

    if (cloudtext_is(word, len, "v"))
        return vertex(r, t);
    if (r->takes == NULL)
        return ST_OK;
    if (cloudtext_is(word, len, "usemtl"))
        material(r, t);
    return r->taken && cloudtext_is(word, len, "f") ? face(r, t) : ST_OK;
}

enum status objmesh_parse(FILE *in, bool (*takes)(const char *material),
                          struct objmesh *out, struct errinfo *e)
{
    struct reading r = {.out = out, .takes = takes, .taken = takes != NULL && takes("")};
    struct cloudtext t = {.line = 0, .e = e};
    char *text = NULL;
    size_t room = 0;
    ssize_t n;
    enum status st = ST_OK;

    memset(out, 0, sizeof *out);
    while (st == ST_OK && (n = getline(&text, &room, in)) >= 0) {
        t.start = t.p = text;
        t.end = text + n;
        t.line++;
        st = line(&r, &t);
    }
    if (st == ST_OK && ferror(in))
        st = errinfo_set(e, ST_EIO, "it cannot be read to its end");
    else if (st == ST_OK && out->nv == 0)
        st = errinfo_set(e, ST_EINVAL, "no vertices: it is not an OBJ file");
    free(text);
    if (st != ST_OK)
        objmesh_free(out);
    return st;
}

static enum status open_file(const char *path, FILE **in, struct errinfo *e)
{
    /* Without O_NONBLOCK, open() waits on a pipe until another process writes to it. */
    const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    struct stat about;

    if (fd < 0 || fstat(fd, &about) != 0 || (*in = fdopen(fd, "r")) == NULL) {
        const int why = errno;

        if (fd >= 0)
            (void)close(fd);
        return errinfo_set(e, why == ENOENT ? ST_ENOTFOUND : ST_EIO, "%s", strerror(why));
    }
    if (!S_ISREG(about.st_mode))
        return errinfo_set(e, ST_EINVAL, "not a regular file");
    if (about.st_size > OBJMESH_MAX_BYTES)
        return errinfo_set(e, ST_ELIMIT, "larger than %d MB", OBJMESH_MAX_BYTES >> 20);
    return ST_OK;
}

enum status objmesh_read(const char *path, bool (*takes)(const char *material),
                         struct objmesh *out, struct errinfo *e)
{
    struct errinfo why = {.msg = ""};
    FILE *in = NULL;
    enum status st = open_file(path, &in, &why);

    memset(out, 0, sizeof *out);
    if (st == ST_OK)
        st = objmesh_parse(in, takes, out, &why);
    if (in != NULL)
        (void)fclose(in);
    return st == ST_OK ? ST_OK : errinfo_set(e, st, "%.160s: %s", path, why.msg);
}

void objmesh_free(struct objmesh *m)
{
    free(m->at);
    free(m->corner);
    memset(m, 0, sizeof *m);
}
