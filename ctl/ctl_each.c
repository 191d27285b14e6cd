#include "ctl_each.h"

#include <stdlib.h>

#define PAGE 1000 /* subjects read at a time */

enum status ctl_each_subject(struct store *s,
                             enum status (*visit)(void *arg,
                                                  const struct store_subject *one,
                                                  struct errinfo *e),
                             void *arg, struct errinfo *e)
{
    struct store_subject *page;
    int64_t after = 0;
    size_t n = 1;
    enum status st = ST_OK;

    while (st == ST_OK && n > 0) {
        if ((st = store_subject_list(s, after, PAGE, &page, &n, e)) != ST_OK)
            break;
        for (size_t i = 0; i < n && st == ST_OK; i++) {
            after = page[i].key;
            if ((st = visit(arg, &page[i], e)) == ST_ENOTFOUND)
                st = ST_OK;
        }
        free(page);
    }
    return st;
}
