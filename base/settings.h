/* settings.h -- settings by name.  A table lists them; a file, the environment and the command line give
 * the values, and each overrides the one before.  This module knows no setting itself.  It checks every
 * value that it reads, even if another one overrides it.  Each problem is one line on a stream, which names
 * the source of the value. */
#ifndef BASE_SETTINGS_H
#define BASE_SETTINGS_H
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

enum setting_kind {               /* type of the member that the setting fills */
                    SETTING_TEXT, /* const char * */
                    SETTING_FILE, /* const char *: path of a file that must exist */
                    SETTING_PATH, /* const char *: path of a file that may be created */
                    SETTING_ADDRESS, /* const char *: an address for address_read() */
                    SETTING_NUMBER,  /* unsigned, within min..max */
                    SETTING_BYTES, /* size_t, within min..max; suffix K, M, G: times 2^10, 2^20, 2^30 */
                    SETTING_BOOL, /* bool: 0 or 1; a flag without a value sets 1 */
                    SETTING_CHOICE /* unsigned: index of one of the words in arg, "a|b|c" */
};

/* A row of the table.  The setting "max-body" is the flag --max-body, the variable SURFACED_MAX_BODY, and
 * max-body = in the file.  FILE and PATH: "credential:NAME" is the file NAME in $CREDENTIALS_DIRECTORY, into
 * which systemd puts it (LoadCredential=). */
struct setting {
    const char *name;
    enum setting_kind kind;
    const char *fallback; /* default value; NULL: unset, and the member is not changed */
    size_t offset;        /* offset of the member in the structure that is filled */
    unsigned long min, max; /* range of NUMBER and BYTES */
    const char *arg;        /* name of the value in the help text; BOOL: NULL */
    const char *help;       /* lines of the help text; the default is appended */
};

struct settings; /* opaque: the values so far, and their sources */

/* settings_new(table, n, errors, out): Begins with the defaults of the table.
 *   table, errors  borrowed until settings_free()
 *   errors         receives a line for each problem
 *   out            to be released by settings_free(); on failure: NULL
 * Returns false if out of memory. */
bool settings_new(const struct setting *table, size_t n, FILE *errors,
                  struct settings **out);

/* settings_free(s): Releases s with its values; NULL is allowed. */
void settings_free(struct settings *s);

/* settings_read(s, in, name): Reads an INI file: "name = value", comments from # or ; at the start of a line,
 * no section or [surfaced], lines of at most 4,000 bytes.  Reports a read error, a malformed line, an unknown
 * name or section, a setting that is given twice, and a bad value.
 *   name    name of the file in the reports
 * Threads: one at a time. */
void settings_read(struct settings *s, FILE *in, const char *name);

/* settings_file(s, path, may_miss): Opens the file and reads it by settings_read().
 *   may_miss  true: does not report that the file is missing */
void settings_file(struct settings *s, const char *path, bool may_miss);

/* settings_environment(s): Reads the variable SURFACED_NAME of every row; an empty variable is unset. */
void settings_environment(struct settings *s);

/* settings_flag(s, row, text): Takes the value of a flag of the command line. */
void settings_flag(struct settings *s, size_t row, const char *text);

/* settings_wrong(s, fmt, ...): Reports a problem. */
__attribute__((format(printf, 2, 3))) void settings_wrong(struct settings *s,
                                                          const char *fmt, ...);

/* settings_wrong_value(s, name, why): Reports a problem with the value of a setting, preceded by the value
 * and its source. */
void settings_wrong_value(struct settings *s, const char *name, const char *why);

/* settings_check_files(s): Reports each FILE that cannot be read, and each PATH that can be neither written
 * nor created.  Skips URLs.  Opens no file. */
void settings_check_files(struct settings *s);

/* settings_problems(s): Returns the number of problems that were reported. */
unsigned settings_problems(const struct settings *s);

/* settings_fill(s, out): Sets the members of the structure to the values.  The strings belong to s.  The
 * caller has made sure that no problem was reported. */
void settings_fill(const struct settings *s, void *out);

/* settings_print(s, out): Prints a file that settings_file() reads, with the source of each value in a
 * comment.  An unset setting is a comment. */
void settings_print(const struct settings *s, FILE *out);

/* settings_print_row(out, name, help, fallback): Prints the lines of an option in a help text.
 *   fallback  its default; NULL: none */
void settings_print_row(FILE *out, const char *name, const char *help,
                        const char *fallback);

/* settings_help(table, n, out): Prints the help text of each row. */
void settings_help(const struct setting *table, size_t n, FILE *out);

#endif
