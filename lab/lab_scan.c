/* Scans as faces, alone and of a collection. */
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "cloudfile.h"
#include "corpus.h"
#include "frames.h"
#include "lab.h"
#include "mem.h"
#include "outfile.h"

enum status lab_scan_parse(const struct lab *c, const char *path, struct cloudpoints *out,
                           struct errinfo *e)
{
    return cloudfile_read_path(path, c->unit_mm, &c->camera, out, e);
}

enum status lab_scan_build(const struct lab *c, const char *path, struct cloudpoints *p,
                           bool enrolment, struct surface_work *w,
                           struct surface_face *out, struct surface_found *found,
                           struct errinfo *e)
{
    const struct scan_options o = {.axes = p->axes_given || c->frontal ? SCAN_AXES_SCANNER
                                                                       : SCAN_AXES_AUTO,
                                   .enrolment = enrolment};
    const size_t n = p->n;
    enum status st;

    out->quality = (struct surface_quality){0};
    st = scan_build(p, &o, w, out, NULL, found);
    return st == ST_OK ? st
                       : errinfo_set(e, st, "%.100s: %zu points: %s", path, n,
                                     status_message(st));
}

enum status lab_scan_read(struct lab *c, const char *path, struct surface_face *out,
                          struct surface_found *found)
{
    struct cloudpoints p;
    enum status st = lab_scan_parse(c, path, &p, &c->e);

    if (st == ST_OK)
        st = lab_scan_build(c, path, &p, false, c->work, out, found, &c->e);
    cloudpoints_free(&p);
    return st;
}

/* The fused face of a session's frames; those that cannot be read count as not there. */
static enum status build_session(const struct lab *c, const struct corpus_scan *scan,
                                 struct frames *f, struct surface_face *out,
                                 struct surface_found *found, struct errinfo *e)
{
    enum status st = ST_OK;

    for (uint32_t k = 0; st == ST_OK && k <= scan->nframe; k++) {
        struct cloudpoints p;

        st = lab_scan_parse(c, k == 0 ? scan->path : scan->frame[k - 1], &p, e);
        if (st == ST_OK) {
            f->how.axes = p.axes_given || c->frontal ? SCAN_AXES_SCANNER : SCAN_AXES_AUTO;
            st = frames_add(f, &p, NULL);
        } else if (st != ST_ENOMEM && st != ST_EIO && st != ST_ENOTFOUND) {
            st = ST_OK;
        }
        cloudpoints_free(&p);
    }
    if (st == ST_OK && f->n == 0)
        return e->code;
    if (st == ST_OK)
        st = frames_fuse(f, out, found);
    return st == ST_OK ? st
                       : errinfo_set(e, st, "%.100s and %u more frames: %s", scan->path,
                                     scan->nframe, status_message(st));
}

static enum status read_session(const struct lab *c, const struct corpus_scan *scan,
                                bool enrolment, struct surface_work *w,
                                struct surface_face *out, struct surface_found *found,
                                struct errinfo *e)
{
    struct frames *f = mem_array(1, sizeof *f);
    enum status st;

    if (f == NULL)
        return errinfo_memory(e);
    memset(f, 0, sizeof *f);
    f->w = w;
    f->how = (struct scan_options){.enrolment = enrolment, .frame = true};
    st = build_session(c, scan, f, out, found, e);
    frames_free(f);
    mem_free(f);
    return st;
}

enum status lab_scan_of(const struct lab *c, const struct corpus_scan *scan,
                        bool enrolment, struct surface_work *w, struct surface_face *out,
                        struct surface_found *found, enum status *code, char **refused,
                        struct errinfo *e)
{
    struct cloudpoints p = {.at = NULL};
    struct errinfo why = {.code = ST_OK};
    enum status st;

    if (scan->nframe > 0)
        st = read_session(c, scan, enrolment, w, out, found, &why);
    else if ((st = lab_scan_parse(c, scan->path, &p, &why)) == ST_OK)
        st = lab_scan_build(c, scan->path, &p, enrolment, w, out, found, &why);
    cloudpoints_free(&p);
    if (st == ST_ENOMEM || st == ST_EIO || st == ST_ENOTFOUND)
        return errinfo_set(e, st, "%s", why.msg);
    if (code != NULL)
        *code = st;
    if (st != ST_OK && (*refused = strdup(why.msg)) == NULL)
        return errinfo_memory(e);
    return ST_OK;
}

enum status lab_scan_not_read(struct lab *c, const struct corpus *k, const char *source,
                              const char *path)
{
    static const char *const table[] = {"index.csv", "subjects.csv"};
    const char *const slash = strrchr(source, '/');
    struct stat info;
    const bool folder = stat(source, &info) == 0 && S_ISDIR(info.st_mode);
    const int len = folder          ? (int)strlen(source)
                    : slash != NULL ? (int)(slash - source)
                                    : 0;
    char name[PATH_MAX];
    enum status st = outfile_not_read(path, source, &c->e);

    for (uint32_t i = 0; st == ST_OK && i < k->nscan; i++)
        st = outfile_not_read(path, k->scan[i].path, &c->e);
    for (size_t i = 0; st == ST_OK && i < sizeof table / sizeof *table; i++) {
        (void)snprintf(name, sizeof name, "%.*s%s%s", len, source,
                       folder || slash != NULL ? "/" : "", table[i]);
        st = outfile_not_read(path, name, &c->e);
    }
    return st;
}
