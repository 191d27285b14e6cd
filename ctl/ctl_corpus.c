#include "ctl_corpus.h"

#include <stdio.h>

#include "corpus.h"
#include "json.h"

void ctl_corpus_tell(const struct corpus *k)
{
    char text[200];

    for (uint32_t i = 0; i < k->nleft; i++)
        (void)fprintf(stderr, "surfacectl: %s: %s\n", k->left[i].file, k->left[i].why);
    skipped_text(&k->skipped, text, sizeof text);
    if (text[0] != '\0')
        (void)fprintf(stderr, "surfacectl: not read: %s\n", text);
}

void ctl_corpus_left(struct json *o, const struct corpus *k)
{
    for (uint32_t i = 0; i < k->nleft; i++) {
        json_object(o, NULL);
        json_text(o, "file", k->left[i].file);
        json_text(o, "reason", k->left[i].why);
        json_close(o);
    }
}

void ctl_corpus_skipped(struct json *o, const struct corpus *k)
{
    char text[200];

    skipped_text(&k->skipped, text, sizeof text);
    json_text(o, "not_read", text[0] != '\0' ? text : NULL);
}
