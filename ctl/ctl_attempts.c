/* Failed verifications of subjects: listed, forgotten. */
#include <stdio.h>
#include <stdlib.h>

#include "ctl.h"

static enum status list(struct ctl *c, struct store *s)
{
    struct store_attempts *a;
    size_t n;
    enum status st = store_attempts_list(s, &a, &n, &c->e);

    if (st != ST_OK)
        return st;
    ctl_out_array(c->out, "attempts");
    if (!c->json && n > 0)
        (void)printf("%-32s %8s  %s\n", "SUBJECT", "FAILURES", "LAST");
    for (size_t i = 0; i < n; i++) {
        ctl_out_object(c->out, NULL);
        ctl_out_text(c->out, "subject", a[i].subject);
        ctl_out_number(c->out, "failures", a[i].failures);
        ctl_out_text(c->out, "last", a[i].at);
        ctl_out_close(c->out);
        if (!c->json)
            (void)printf("%-32s %8u  %s\n", a[i].subject, a[i].failures, a[i].at);
    }
    ctl_out_close(c->out);
    if (!c->json && n == 0)
        (void)printf("no failed verifications\n");
    free(a);
    return ST_OK;
}

static enum status reset(struct ctl *c, struct store *s)
{
    enum status st = store_attempts_reset(s, CTL_ACTOR, c->args[0], &c->e);

    if (st != ST_OK)
        return st;
    ctl_out_text(c->out, "subject", c->args[0]);
    ctl_out_number(c->out, "failures", 0);
    if (!c->json)
        (void)printf("%s: no failed verifications any more\n", c->args[0]);
    return ST_OK;
}

static int run(struct ctl *c, enum store_mode mode,
               enum status (*what)(struct ctl *, struct store *))
{
    struct store *s = NULL;
    enum status st = ctl_open(c, mode, &s);

    if (st == ST_OK)
        st = what(c, s);
    store_close(s);
    return st == ST_OK ? EXIT_FINE : ctl_fail(c, st);
}

int ctl_attempts_list(struct ctl *c)
{
    return run(c, STORE_READ, list);
}

int ctl_attempts_reset(struct ctl *c)
{
    return run(c, STORE_WRITE, reset);
}
