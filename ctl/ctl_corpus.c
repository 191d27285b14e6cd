#include "ctl_corpus.h"

#include <stdio.h>
#include <string.h>

#include "corpus.h"
#include "ctl.h"
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
