/* settings.h -- settings by name: a table lists them; a file, the environment and the
 * command line give the values, and each wins over the one before.  Knows no setting
 * itself. Every value is checked when it is read, even if another wins over it; each
 * problem is one line on a stream, which says where the value came from. */
#ifndef BASE_SETTINGS_H
#define BASE_SETTINGS_H
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

enum setting_kind {                  /* the member that it fills */
                    SETTING_TEXT,    /* const char * */
                    SETTING_FILE,    /* const char *: a file that must be there */
                    SETTING_PATH,    /* const char *: a file that may be made */
                    SETTING_ADDRESS, /* const char *: what address_read() reads */
                    SETTING_NUMBER,  /* unsigned, within min..max */
                    SETTING_BYTES, /* size_t, within min..max; K, M, G after it: times 2^10, 2^20, 2^30 */
                    SETTING_BOOL, /* bool: 0 or 1; as a flag it takes no value and means 1 */
                    SETTING_CHOICE /* unsigned: the index of one of the words in arg, "a|b|c" */
};

/* A row of the table.  "max-body" is --max-body, SURFACED_MAX_BODY, and max-body = in the
 * file.  FILE and PATH: "credential:NAME" is $CREDENTIALS_DIRECTORY/NAME, where systemd's
 * LoadCredential= puts it. */
struct setting {
    const char *name;
    enum setting_kind kind;
    const char *fallback;   /* NULL: unset, the member stays as it is */
    size_t offset;          /* of the member in the structure to fill */
    unsigned long min, max; /* NUMBER, BYTES */
    const char *arg;        /* what stands for the value in the help; BOOL: NULL */
    const char *help;       /* its lines by '\n'; the fallback is added */
};

struct settings; /* opaque: the values so far, and where each came from */

/* settings_new(table, n, errors, out): table and errors are borrowed.  False: no memory,
 * and *out is NULL. */
bool settings_new(const struct setting *table, size_t n, FILE *errors,
                  struct settings **out);
void settings_free(struct settings *s); /* NULL is allowed */

/* settings_default(s, name, text): a fallback that the table cannot know.  Before
 * reading. */
void settings_default(struct settings *s, const char *name, const char *text);

/* settings_read(s, in, name): an INI file: "name = value", comments from # or ; at the
 * start of a line, no section or [surfaced]; a line has at most 4,000 bytes.  Wrong are:
 * a stream that cannot be read, a malformed line, an unknown name or section, a setting
 * given twice, a bad value.  name: of the file, for the reports.  Not from two threads at
 * once. */
void settings_read(struct settings *s, FILE *in, const char *name);

/* settings_file(s, path, may_miss): the same by its path; true: it need not be there. */
void settings_file(struct settings *s, const char *path, bool may_miss);

/* settings_environment(s): SURFACED_NAME of every row; an empty one counts as unset. */
void settings_environment(struct settings *s);

/* settings_flag(s, row, text): the value of a flag of the command line. */
void settings_flag(struct settings *s, size_t row, const char *text);

/* settings_wrong(s, fmt, ...): report a problem as the reading does. */
__attribute__((format(printf, 2, 3))) void settings_wrong(struct settings *s,
                                                          const char *fmt, ...);

/* settings_wrong_value(s, name, why): the same with the value of a setting: where it came
 * from is said before it. */
void settings_wrong_value(struct settings *s, const char *name, const char *why);

/* settings_check_files(s): report each FILE that cannot be read, and each PATH that
 * neither can be written nor made, but those that are URLs.  Opens nothing. */
void settings_check_files(struct settings *s);

/* settings_problems(s): how many were reported; 0: all is well. */
unsigned settings_problems(const struct settings *s);

/* settings_fill(s, out): the members of the structure by the values.  The strings live as
 * long as s.  Precondition: no problem was reported by the reading. */
void settings_fill(const struct settings *s, void *out);

/* settings_print(s, out): as a file that settings_file() reads, with where each value
 * came from; what is unset stands in a comment. */
void settings_print(const struct settings *s, FILE *out);

/* settings_help(table, n, out): a line or more for each row, as in --help. */
void settings_help(const struct setting *table, size_t n, FILE *out);

#endif
