#include "command.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "json.h"
#include "outfile.h"
#include "settings.h"

#define LONG 256 /* what getopt_long() returns for the first option */

/* ---- the end */

int command_exit(enum status st)
{
    static const int code[ST_COUNT] = {
        [ST_ENOMEM] = EXIT_OSERR,       [ST_ENOTFOUND] = EXIT_NOINPUT,
        [ST_EDENIED] = EXIT_NOPERM,     [ST_ETOKEN] = EXIT_NOPERM,
        [ST_EREFUSED] = EXIT_NOPERM,    [ST_EHELD] = EXIT_NOPERM,
        [ST_EBUSY] = EXIT_TEMPFAIL,     [ST_EIO] = EXIT_IOERR,
        [ST_EUNSYNCED] = EXIT_IOERR,    [ST_EDB] = EXIT_SOFTWARE,
        [ST_EINTERNAL] = EXIT_SOFTWARE,
    };

    return code[st] != 0 ? code[st] : EXIT_DATA;
}

/* As the HTTP interface has it. */
static const char *word_of(enum status st)
{
    static const char *const word[ST_COUNT] = {[ST_ENOMEM] = "out_of_memory",
                                               [ST_ESIZE] = "file_too_large",
                                               [ST_ECORRUPT] = "damaged",
                                               [ST_EVERSION] = "other_version",
                                               [ST_ENOTFOUND] = "not_found",
                                               [ST_EEXISTS] = "exists",
                                               [ST_EMISMATCH] = "sample_mismatch",
                                               [ST_EREPLAYED] = "replayed",
                                               [ST_EDENIED] = "forbidden",
                                               [ST_ETOKEN] = "unauthorized",
                                               [ST_EREFUSED] = "database_refused",
                                               [ST_EHELD] = "on_hold",
                                               [ST_EBUSY] = "busy",
                                               [ST_EIO] = "storage",
                                               [ST_EUNSYNCED] = "not_flushed",
                                               [ST_EDB] = "internal",
                                               [ST_EINTERNAL] = "internal"};

    return word[st] != NULL ? word[st] : status_refusal(st);
}

int command_end(const char *program, struct json *out, bool usage,
                const struct errinfo *e, int code)
{
    bool written = true;

    if (code > EXIT_INCONCLUSIVE) {
        (void)fflush(stdout);
        (void)fprintf(stderr, "%s: %s\n", program, e->msg);
        json_object(out, "error");
        json_text(out, "code", usage ? "usage" : word_of(e->code));
        json_text(out, "detail", e->msg);
        json_number(out, "exit", code);
        json_close(out);
    }
    if (out != NULL) {
        char *text = json_pretty(out);

        written = text != NULL && puts(text) >= 0;
        free(text);
    }
    if (outfile_flush(stdout) && written)
        return code;
    (void)fprintf(stderr, "%s: the output cannot be written\n", program);
    return code > EXIT_INCONCLUSIVE ? code : EXIT_IOERR;
}

/* ---- options */

void command_print_option(const struct command_option *o)
{
    char name[64], letter[] = "-?, ";

    letter[1] = o->letter;
    (void)snprintf(name, sizeof name, "%s--%s%s%s", o->letter != 0 ? letter : "", o->name,
                   o->arg != NULL ? " " : "", o->arg != NULL ? o->arg : "");
    settings_print_row(stdout, name, o->help, NULL);
}

const char *command_flag(const char *text, void *value)
{
    (void)text;
    *(bool *)value = true;
    return NULL;
}

const char *command_text(const char *text, void *value)
{
    *(const char **)value = text;
    return NULL;
}

bool command_number(const char *text, double low, double high, double *to)
{
    char *end;

    *to = strtod(text, &end);
    return end != text && *end == '\0' && *to >= low && *to <= high;
}

const char *command_whole(const char *text, void *value)
{
    double x;

    if (!command_number(text, 1, 1e6, &x) || x != floor(x))
        return "1 to 1000000";
    *(uint32_t *)value = (uint32_t)x;
    return NULL;
}

const char *command_score(const char *text, void *value)
{
    return command_number(text, -9999.99, 9999.99, value)
               ? NULL
               : "a score between -10000 and 10000";
}

const char *command_rate(const char *text, void *value)
{
    return command_number(text, 1e-300, 0.5, value) ? NULL
                                                    : "a rate above 0 and at most 0.5";
}

/* ---- the command line */

void command_line_add(struct command_line *l, const struct command_option *o)
{
    int k = 0;

    while (k < l->noption && strcmp(l->option[k].name, o->name) != 0)
        k++;
    if (k == l->noption && k < COMMAND_OPTIONS)
        l->option[l->noption++] =
            (struct option){o->name, o->arg != NULL ? required_argument : no_argument,
                            NULL, o->letter != 0 ? o->letter : LONG + k};
}

static bool no_option(const struct command_line *l, const char *word, struct errinfo *e)
{
    (void)errinfo_set(e, ST_EINVAL,
                      "there is no option %.60s (%s --help; put -- before an argument "
                      "that begins with a hyphen)",
                      word, l->program);
    return false;
}

static bool wrong(const struct command_line *l, const char *what, const char *which,
                  struct errinfo *e)
{
    (void)errinfo_set(e, ST_EINVAL, "%s %.80s (%s --help)", what, which, l->program);
    return false;
}

bool command_line_read(struct command_line *l, int argc, char **argv, struct errinfo *e)
{
    char letter[] = "-?"; /* the unknown one of several letters */
    int got;

    opterr = 0;
    while ((got = getopt_long_only(argc, argv, ":ho:", l->option, NULL)) != -1) {
        int k = 0;

        letter[1] = (char)optopt;
        if (got == '?')
            return no_option(l, optopt > 0 && optopt < LONG ? letter : argv[optind - 1],
                             e);
        if (got == ':')
            return wrong(l, "value missing:", argv[optind - 1], e);
        while (l->option[k].val != got)
            k++;
        if (l->given[k])
            return wrong(l, "given twice:", l->option[k].name, e);
        l->given[k] = true;
        l->value[k] = optarg;
    }
    return true;
}

bool command_line_given(const struct command_line *l, const char *name)
{
    for (int k = 0; k < l->noption; k++)
        if (l->given[k] && strcmp(l->option[k].name, name) == 0)
            return true;
    return false;
}

bool command_line_take(const struct command_line *l, int k,
                       const struct command_option *o, const char *command, void *to,
                       struct errinfo *e)
{
    const char *wanted;

    if (o == NULL)
        (void)errinfo_set(e, ST_EINVAL, "%s does not take --%s (%s %s --help)", command,
                          l->option[k].name, l->program, command);
    else if ((wanted = o->read(l->value[k],
                               o->value != NULL ? o->value : (char *)to + o->at)) != NULL)
        (void)errinfo_set(e, ST_EINVAL, "--%s takes %s, not '%.80s'", o->name, wanted,
                          l->value[k]);
    else
        return true;
    return false;
}

/* ---- for both programs */

void *command_grow(void *list, size_t n, size_t size)
{
    return (n & (n - 1)) != 0 ? list : realloc(list, (n > 0 ? 2 * n : 1) * size);
}

double command_clock_ms(void)
{
    struct timespec t;

    (void)clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}
