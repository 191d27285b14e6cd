/* Scans as faces, alone and of a collection. */
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "cloudfile.h"
#include "corpus.h"
#include "lab.h"
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

enum status lab_scan_of(const struct lab *c, const struct corpus_scan *scan,
                        bool enrolment, struct surface_work *w, struct surface_face *out,
                        struct surface_found *found, enum status *code, char **refused,
                        struct errinfo *e)
{
    struct cloudpoints p;
    struct errinfo why = {.code = ST_OK};
    enum status st = lab_scan_parse(c, scan->path, &p, &why);

    if (st == ST_OK)
        st = lab_scan_build(c, scan->path, &p, enrolment, w, out, found, &why);
    cloudpoints_free(&p);
    if (st == ST_ENOMEM || st == ST_EIO || st == ST_ENOTFOUND)
        return errinfo_set(e, st, "%s", why.msg);
    if (code != NULL)
        *code = st;
    if (st != ST_OK && (*refused = strdup(why.msg)) == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
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
