#include "ctl_corpus.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "corpus.h"
#include "ctl.h"
#include "ctl_dir.h"
#include "ctl_sample.h"

void ctl_corpus_tell(const struct corpus *k)
{
    for (uint32_t i = 0; i < k->nleft; i++)
        (void)fprintf(stderr, "surfacectl: %s: %s\n", k->left[i].file, k->left[i].why);
}

void ctl_corpus_left(struct json *j, const struct corpus *k)
{
    for (uint32_t i = 0; i < k->nleft; i++) {
        json_object(j, NULL);
        json_text(j, "file", k->left[i].file);
        json_text(j, "reason", k->left[i].why);
        json_close(j);
    }
    json_close(j);
}

enum status ctl_corpus_not_read(struct ctl *c, const struct corpus *k, const char *source,
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
    enum status st = ctl_dir_not_read(c, path, source);

    for (uint32_t i = 0; st == ST_OK && i < k->nscan; i++)
        st = ctl_dir_not_read(c, path, k->scan[i].path);
    for (size_t i = 0; st == ST_OK && i < sizeof table / sizeof *table; i++) {
        (void)snprintf(name, sizeof name, "%.*s%s%s", len, source,
                       folder || slash != NULL ? "/" : "", table[i]);
        st = ctl_dir_not_read(c, path, name);
    }
    return st;
}

enum status ctl_corpus_face(const struct ctl *c, const struct corpus_scan *scan,
                            bool enrolment, struct face_work *w, struct face *out,
                            struct scan_found *found, enum status *code, char **refused,
                            struct errinfo *e)
{
    struct ctl mine = {.scans = c->scans};
    const enum status st = ctl_sample_read(&mine, scan->path, enrolment, w, out, found);

    if (st == ST_ENOMEM || st == ST_EIO || st == ST_ENOTFOUND)
        return errinfo_set(e, st, "%s", mine.e.msg);
    if (code != NULL)
        *code = st;
    if (st != ST_OK && (*refused = strdup(mine.e.msg)) == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    return ST_OK;
}
