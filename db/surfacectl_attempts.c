/* Failed verifications of subjects: listed, forgotten. */
#include <stdio.h>
#include <stdlib.h>

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
    enum status st = store_attempts_reset(s, SURFACECTL_ACTOR, c->args[0], &c->e);

    if (st != ST_OK)
        return st;
    surfacectl_out_text(c->out, "subject", c->args[0]);
    surfacectl_out_number(c->out, "failures", 0);
    if (!c->json)
        (void)printf("%s: no failed verifications any more\n", c->args[0]);
    return ST_OK;
}

static int run(struct surfacectl *c, enum store_mode mode,
               enum status (*what)(struct surfacectl *, struct store *))
{
    struct store *s = NULL;
    enum status st = surfacectl_open(c, mode, &s);

    if (st == ST_OK)
        st = what(c, s);
    store_close(s);
    return st == ST_OK ? EXIT_FINE : surfacectl_fail(c, st);
}

int surfacectl_attempts_list(struct surfacectl *c)
{
    return run(c, STORE_READ, list);
}

int surfacectl_attempts_reset(struct surfacectl *c)
{
    return run(c, STORE_WRITE, reset);
}
