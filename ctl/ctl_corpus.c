#include "ctl_corpus.h"

#include <stdio.h>
#include <string.h>

#include "corpus.h"
#include "ctl.h"
#include "ctl_sample.h"

void ctl_corpus_tell(const struct corpus *k)
{
    char text[200];

    for (uint32_t i = 0; i < k->nleft; i++)
        (void)fprintf(stderr, "surfacectl: %s: %s\n", k->left[i].file, k->left[i].why);
    skipped_text(&k->skipped, text, sizeof text);
    if (text[0] != '\0')
        (void)fprintf(stderr, "surfacectl: not read: %s\n", text);
}

void ctl_corpus_left(struct json *j, const struct corpus *k)
{
    char text[200];

    for (uint32_t i = 0; i < k->nleft; i++) {
        json_object(j, NULL);
        json_text(j, "file", k->left[i].file);
        json_text(j, "reason", k->left[i].why);
        json_close(j);
    }
    json_close(j);
    skipped_text(&k->skipped, text, sizeof text);
    json_text(j, "not_read", text[0] != '\0' ? text : NULL);
}

enum status ctl_corpus_face(const struct ctl *c, const char *path, struct face_work *w,
                            struct face *out, char **refused, struct errinfo *e)
{
    struct ctl mine = {.scans = c->scans};
    const enum status st = ctl_sample_read(&mine, path, false, w, out);

    if (st == ST_ENOMEM || st == ST_EIO || st == ST_ENOTFOUND)
        return errinfo_set(e, st, "%s", mine.e.msg);
    if (st != ST_OK && (*refused = strdup(mine.e.msg)) == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    return ST_OK;
}
