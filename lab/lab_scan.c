/* Scans as faces, alone and of a collection. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "cloudfile.h"
#include "corpus.h"
#include "lab.h"
#include "outfile.h"
#include "readfile.h"

#define MAX_FILE ((size_t)256 << 20)

enum status lab_scan_parse(const struct lab *c, const char *path, struct cloudpoints *out,
                           struct errinfo *e)
{
    const struct cloudfile_options o = {.max_points = CLOUDFILE_POINTS,
                                        .max_bytes = MAX_FILE,
                                        .unit_mm = c->unit_mm,
                                        .camera = c->camera};
    struct errinfo why = {.msg = "out of memory"};
    unsigned char *bytes;
    size_t len;
    enum status st = readfile_all(path, MAX_FILE, &bytes, &len, e);

    *out = (struct cloudpoints){0};
    if (st == ST_OK && (st = cloudfile_read(bytes, len, &o, out, &why)) != ST_OK)
        (void)errinfo_set(e, st, "%.100s: %s", path, why.msg);
    free(bytes);
    return st;
}

enum status lab_scan_build(const struct lab *c, const char *path, struct cloudpoints *p,
                           bool enrolment, struct surface_work *w,
                           struct surface_face *out, struct surface_found *found,
                           struct errinfo *e)
{
    const struct scan_options o = {.axes = p->axes_given ? SCAN_AXES_SCANNER : c->axes,
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

void lab_scan_left(struct json *j, const struct corpus *k)
{
    for (uint32_t i = 0; i < k->nleft; i++) {
        json_object(j, NULL);
        json_text(j, "file", k->left[i].file);
        json_text(j, "reason", k->left[i].why);
        json_close(j);
    }
    json_close(j);
}

void lab_scan_print_left(const struct corpus *k)
{
    for (uint32_t i = 0; i < k->nleft; i++)
        (void)fprintf(stderr, "surfacelab: %s: %s\n", k->left[i].file, k->left[i].why);
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
