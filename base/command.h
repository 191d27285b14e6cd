/* command.h -- the command lines of surfacectl and surfacelab: options and their values, refusals, exit
 * codes, and the end of a program. */
#ifndef BASE_COMMAND_H
#define BASE_COMMAND_H
#include <getopt.h>
#include <stdbool.h>
#include <stddef.h>
#include "errinfo.h"

struct json; /* json.h */

/* The values are those of <sysexits.h>, if it has one. */
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

/* command_exit(st): Returns the exit code of a command that failed with st. */
int command_exit(enum status st);

/* command_end(program, out, usage, e, code): Ends the output of a program.  If code is an error, prints e, and
 * adds it to the JSON out with a stable word.  Then prints out.
 *   out     released; NULL: the result was text
 *   usage   true: the command line is wrong, and the word is "usage"
 * Returns the exit code: code, or EXIT_IOERR if code is no error and the output cannot be written. */
int command_end(const char *program, struct json *out, bool usage,
                const struct errinfo *e, int code);

/* ---- options */

struct command_option {
    const char *name; /* name without hyphens; NULL ends a list */
    const char *
        arg; /* name of the value in help texts; NULL: no value.  "mm|cm|m": one of these words.
                         FILE, DIR, PATH: a path */
    /* Sets *value by the text.  Returns NULL, or the values that the option takes. */
    const char *(*read)(const char *text, void *value);
    void *value; /* variable that is set; NULL: the member `at` of the program's struct */
    const char *help; /* lines of up to 66 characters */
    size_t at;        /* offset of the member that is set if value is NULL */
    char letter;      /* short form, h or o; 0: none */
};

/* command_print_option(o): Prints the option's lines of a help text. */
void command_print_option(const struct command_option *o);

/* command_flag(text, value): Sets the bool at value. */
const char *command_flag(const char *text, void *value);

/* command_text(text, value): Sets the const char * at value. */
const char *command_text(const char *text, void *value);

/* command_whole(text, value): Reads a number from 1 to 1,000,000 into the uint32_t at value. */
const char *command_whole(const char *text, void *value);

/* command_score(text, value): Reads a score into the double at value. */
const char *command_score(const char *text, void *value);

/* command_rate(text, value): Reads a rate above 0 and up to 0.5 into the double at value. */
const char *command_rate(const char *text, void *value);

/* command_number(text, low, high, to): Reads a number from low to high.  Returns false if text is anything
 * else. */
bool command_number(const char *text, double low, double high, double *to);

/* ---- the command line */

#define COMMAND_OPTIONS 64 /* greatest number of different names */

struct command_line {
    const char *program; /* the other members are 0 at first */
    struct option option[COMMAND_OPTIONS + 1];
    int noption;
    bool given[COMMAND_OPTIONS];
    const char *value[COMMAND_OPTIONS];
};

/* command_line_add(l, o): Adds an option of some command, unless there is one of this name: options may stand
 * before the command. */
void command_line_add(struct command_line *l, const struct command_option *o);

/* command_line_read(l, argc, argv, e): Reads all options; the words begin at argv[optind] then.
 * Returns false, and fills *e, if an option is unknown, lacks its value or is given twice. */
bool command_line_read(struct command_line *l, int argc, char **argv, struct errinfo *e);

/* command_line_given(l, name): Returns true if the option was given. */
bool command_line_given(const struct command_line *l, const char *name);

/* command_line_take(l, k, o, command, to, e): Reads the value of option k into its variable, or into its
 * member of the struct at `to`.
 *   o       row of the option in the command; NULL: the command does not take it
 * Returns false, and fills *e, if the command does not take the option, or its value is wrong. */
bool command_line_take(const struct command_line *l, int k,
                       const struct command_option *o, const char *command, void *to,
                       struct errinfo *e);

/* ---- for both programs */

/* command_grow(list, n, size): Makes room for one more element in a list of n elements of that size.
 *   list    from this function; NULL for the first element
 * Returns the list; NULL if out of memory: the list is unchanged. */
void *command_grow(void *list, size_t n, size_t size);

/* command_clock_ms(): Returns the time since an arbitrary start, ms.  It never goes back. */
double command_clock_ms(void);

#endif
