#include "ctl_corpus.h"

#include <stdio.h>

#include "corpus.h"
#include "ctl_out.h"

void ctl_corpus_tell(const struct corpus *k)
{
    char text[200];

    for (uint32_t i = 0; i < k->nleft; i++)
        (void)fprintf(stderr, "surfacectl: %s: %s\n", k->left[i].file, k->left[i].why);
    skipped_text(&k->skipped, text, sizeof text);
    if (text[0] != '\0')
        (void)fprintf(stderr, "surfacectl: not read: %s\n", text);
}

void ctl_corpus_left(struct ctl_out *o, const struct corpus *k)
{
    for (uint32_t i = 0; i < k->nleft; i++) {
        ctl_out_object(o, NULL);
        ctl_out_text(o, "file", k->left[i].file);
        ctl_out_text(o, "reason", k->left[i].why);
        ctl_out_close(o);
    }
}

void ctl_corpus_skipped(struct ctl_out *o, const struct corpus *k)
{
    char text[200];

    skipped_text(&k->skipped, text, sizeof text);
    ctl_out_text(o, "not_read", text[0] != '\0' ? text : NULL);
}
