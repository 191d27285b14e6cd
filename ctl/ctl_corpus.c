#include "ctl_corpus.h"

#include <stdio.h>

#include "corpus.h"
#include "ctl.h"

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
