/* command.h -- the command lines of surfacectl and surfacelab: what an option is and what reads its
 * value, refusals that name the nearest option, exit codes, and how a program ends. */
#ifndef BASE_COMMAND_H
#define BASE_COMMAND_H
#include <getopt.h>
#include <stdbool.h>
#include <stddef.h>
#include "errinfo.h"

struct json; /* json.h */

/* As in <sysexits.h> where that has one. */
enum command_exit {
    EXIT_FINE = 0,
    EXIT_NO = 1,
    EXIT_INCONCLUSIVE = 2,
    EXIT_USAGE = 64,
    EXIT_DATA = 65,
    EXIT_NOINPUT = 66,
    EXIT_SOFTWARE = 70,
    EXIT_OSERR = 71,
    EXIT_IOERR = 74,
    EXIT_TEMPFAIL = 75,
    EXIT_NOPERM = 77
};

int command_exit(enum status st); /* of a command that failed with st */

/* command_end(program, out, usage, e, code): prints the error e if the code is one, also into the
 * JSON out (NULL: the result was text), with a stable word for it, "usage" if the command line was
 * wrong; then out, which is released.  Returns the exit code: EXIT_IOERR instead of a good one
 * where the output cannot be written. */
int command_end(const char *program, struct json *out, bool usage,
                const struct errinfo *e, int code);

/* ---- options */

struct command_option {
    const char *name; /* without the two hyphens; NULL ends a list */
    const char *arg;  /* what its value is called; NULL: it has none.  "mm|cm|m": one of
                         these; FILE, DIR, PATH: of the file system */
    const char *(*read)(const char *text, void *value); /* sets *value; NULL: done, else
                                                           what the option takes */
    void *value;      /* what it sets; NULL: in the program's struct, */
    const char *help; /* lines of up to 66 characters */
    size_t at;        /* there */
    char letter;      /* a short form, h or o, or 0 */
};

void command_print_option(const struct command_option *o); /* its lines of a help text */

/* Values: bool; const char *; uint32_t from 1 to 1,000,000; double: a score, a rate above 0 up to
 * 0.5.  command_number(text, low, high, to): a number from low to high, and nothing behind it. */
const char *command_flag(const char *text, void *value);
const char *command_text(const char *text, void *value);
const char *command_whole(const char *text, void *value);
const char *command_score(const char *text, void *value);
const char *command_rate(const char *text, void *value);
bool command_number(const char *text, double low, double high, double *to);

/* ---- what was typed */

#define COMMAND_OPTIONS 64 /* of different names, at most */

/* All zero but the program's name, before command_line_add(). */
struct command_line {
    const char *program;
    struct option option[COMMAND_OPTIONS + 1];
    int noption;
    bool given[COMMAND_OPTIONS];
    const char *value[COMMAND_OPTIONS];
};

/* command_line_add(l, o): an option of some command; every name counts once, since options may
 * stand before the command.
 * command_line_read(l, argc, argv, e): all options that were given; the words are behind optind
 * then.  False: an unknown one, one without its value or one given twice, as e says.
 * command_line_given(l, name): was it given?
 * command_line_take(l, k, o, command, to, e): reads the value of option k into its place, in `to`;
 * o: what the command makes of it, NULL: it does not take it.  False: a wrong one. */
void command_line_add(struct command_line *l, const struct command_option *o);
bool command_line_read(struct command_line *l, int argc, char **argv, struct errinfo *e);
bool command_line_given(const struct command_line *l, const char *name);
bool command_line_take(const struct command_line *l, int k,
                       const struct command_option *o, const char *command, void *to,
                       struct errinfo *e);

/* ---- for both programs
 *
 * command_grow(list, n, size): a list of n elements that this function has grown (NULL for the
 * first), with room for one more; NULL: out of memory, the list is unchanged.
 * command_clock_ms(): from any start; it does not jump. */
void *command_grow(void *list, size_t n, size_t size);
double command_clock_ms(void);

#endif
