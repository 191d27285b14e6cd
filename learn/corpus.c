#include "corpus.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The kinds that there are, for a message. */
static void list_kinds(const struct corpus *c, char *text, size_t room)
{
    size_t n = 0;

    for (uint32_t i = 0; i < c->nkind && n < room; i++)
        n += (size_t)snprintf(text + n, room - n, "%s%s", i > 0 ? ", " : "",
                              c->kind[i][0] != '\0' ? c->kind[i] : "\"\"");
    if (n >= room)
        memcpy(text + room - 4, "...", 4);
}

enum status corpus_enroll(struct corpus *c, const char *kind, struct errinfo *e)
{
    char kinds[160];
    uint32_t k = 0;

    while (k < c->nkind && strcmp(c->kind[k], kind) != 0)
        k++;
    if (k == c->nkind) {
        list_kinds(c, kinds, sizeof kinds);
        return errinfo_set(e, ST_EINVAL, "no scan is of the kind %.60s: there are %s",
                           kind, kinds);
    }
    for (uint32_t i = 0; i < c->nsubject; i++)
        c->subject[i].enrolled = CORPUS_NONE;
    for (uint32_t i = 0; i < c->nscan; i++) {
        uint32_t *enrolled = &c->subject[c->scan[i].subject].enrolled;

        c->scan[i].enrolled = *enrolled == CORPUS_NONE && c->scan[i].kind == k;
        if (c->scan[i].enrolled)
            *enrolled = i;
    }
    return ST_OK;
}

void corpus_free(struct corpus *c)
{
    if (c == NULL)
        return;
    for (uint32_t i = 0; i < c->nscan; i++) {
        free(c->scan[i].file);
        free(c->scan[i].path);
    }
    for (uint32_t i = 0; i < c->nnamed; i++)
        free(c->subject[i].id);
    for (uint32_t i = 0; i < c->nleft; i++)
        free(c->left[i].file);
    for (uint32_t i = 0; i < c->nkind; i++)
        free(c->kind[i]);
    for (uint32_t i = 0; i < c->npopulation; i++)
        free(c->population[i]);
    free(c->left);
    free(c->listed);
    free(c->scan);
    free(c->subject);
    free(c->kind);
    free(c->population);
    free(c);
}

enum corpus_pair corpus_pair(const struct corpus *c, uint32_t a, uint32_t b)
{
    const struct corpus_subject *x = &c->subject[a], *y = &c->subject[b];

    if (a == b)
        return CORPUS_GENUINE;
    if (x->population != y->population)
        return CORPUS_FOREIGN;
    if (x->relative_of == b || y->relative_of == a ||
        (x->relative_of != CORPUS_NONE && x->relative_of == y->relative_of))
        return CORPUS_RELATIVE;
    return CORPUS_IMPOSTOR;
}
