#include "lab.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "outfile.h"

enum status lab_usage(struct lab *c, const char *fmt, ...)
{
    va_list args;

    c->code = EXIT_USAGE;
    c->e.code = ST_EINVAL;
    va_start(args, fmt);
    (void)vsnprintf(c->e.msg, sizeof c->e.msg, fmt, args);
    va_end(args);
    return ST_EINVAL;
}

void lab_say(const struct lab *c, const char *fmt, ...)
{
    va_list args;

    if (c->json)
        return;
    va_start(args, fmt);
    (void)vfprintf(c->piped ? stderr : stdout, fmt, args);
    va_end(args);
}

const char *lab_decision(enum surface_decision d)
{
    return d == SURFACE_MATCH      ? "match"
           : d == SURFACE_NO_MATCH ? "no_match"
                                   : "inconclusive";
}

/* ---- files */

enum status lab_may_write(struct lab *c, const char *path)
{
    enum status st = outfile_not_read(path, c->model_path, &c->e);

    if (strcmp(path, "-") == 0)
        return lab_usage(c,
                         "%s cannot write to standard output: name a file (./- is one)",
                         c->command);
    for (int i = 0; st == ST_OK && i < c->nargs; i++)
        st = outfile_not_read(path, c->args[i], &c->e);
    return st == ST_OK ? outfile_may(path, c->force, &c->e) : st;
}

enum status lab_may_pipe(struct lab *c)
{
    if (strcmp(c->out, "-") != 0)
        return lab_may_write(c, c->out);
    if (c->json)
        return lab_usage(c,
                         "--out - and --json both write to standard output: name a file");
    c->piped = true;
    return ST_OK;
}

enum status lab_write(struct lab *c, const char *path, newfile_writer *write,
                      const void *arg)
{
    return outfile_write(c->piped ? NULL : path, c->force, write, arg, &c->e);
}
