/* Failed verifications of subjects: listed, forgotten. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "surfacectl.h"

static enum status list(struct surfacectl *c, struct store *s)
{
    struct store_attempts *a;
    size_t n;
    enum status st = store_attempts_list(s, &a, &n, &c->e);

    if (st != ST_OK)
        return st;
    surfacectl_out_array(c->out, "attempts");
    if (!c->json && n > 0)
        (void)printf("%-32s %8s  %s\n", "SUBJECT", "FAILURES", "LAST");
    for (size_t i = 0; i < n; i++) {
        surfacectl_out_object(c->out, NULL);
        surfacectl_out_text(c->out, "subject", a[i].subject);
        surfacectl_out_number(c->out, "failures", a[i].failures);
        surfacectl_out_text(c->out, "last", a[i].at);
        surfacectl_out_close(c->out);
        if (!c->json)
            (void)printf("%-32s %8u  %s\n", a[i].subject, a[i].failures, a[i].at);
    }
    surfacectl_out_close(c->out);
    if (!c->json && n == 0)
        (void)printf("no failed verifications\n");
    free(a);
    return ST_OK;
}

static enum status reset(struct surfacectl *c, struct store *s)
{
    enum status st = store_attempts_reset(s, SURFACECTL_ACTOR, c->args[1], &c->e);

    if (st != ST_OK)
        return st;
    surfacectl_out_text(c->out, "subject", c->args[1]);
    surfacectl_out_number(c->out, "failures", 0);
    if (!c->json)
        (void)printf("%s: no failed verifications any more\n", c->args[1]);
    return ST_OK;
}

int surfacectl_attempts(struct surfacectl *c)
{
    const bool one = strcmp(c->args[0], "reset") == 0;
    struct store *s = NULL;
    enum status st;

    if ((!one && strcmp(c->args[0], "list") != 0) || c->nargs != (one ? 2 : 1)) {
        (void)errinfo_set(&c->e, ST_EINVAL,
                          "it is 'attempts list' or 'attempts reset SUBJECT'");
        return EXIT_USAGE;
    }
    if ((st = surfacectl_open(c, one ? STORE_WRITE : STORE_READ, &s)) == ST_OK)
        st = one ? reset(c, s) : list(c, s);
    store_close(s);
    return st == ST_OK ? EXIT_FINE : surfacectl_fail(c, st);
}
