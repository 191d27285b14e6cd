#include "settings.h"

#include <assert.h>
#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <ini.h>

#include "address.h"

#define LINE_MAX_BYTES 4000
#define NAME_MAX_BYTES 64
#define REPORT_MAX     (LINE_MAX_BYTES + 1000)
#define HELP_COLUMN    23 /* column of the text */
#define SECTION        "surfaced"
#define CREDENTIAL     "credential:"

/* Where systemd keeps the credentials of the service, for processes outside of it. */
#define CREDENTIALS_USUAL "/run/credentials/surfaced.service"

enum source { UNSET, DEFAULT, ENVIRONMENT, FLAG, IN_FILE };

struct settings_one {
    char *text; /* the value as text; NULL: unset */
    char *path; /* path of a credential; NULL: text is the path */
    enum source source;
    unsigned line; /* line in the file */
};

struct settings {
    const struct setting *table;
    size_t n;
    FILE *errors;
    unsigned problems;
    char *file; /* the configuration file; NULL: none was read */
    struct settings_one value[];
};

/* ---- problems */

static void env_name(const struct setting *row, char out[NAME_MAX_BYTES])
{
    int n = snprintf(out, NAME_MAX_BYTES, "SURFACED_%s", row->name);

    assert(n > 0 && n < NAME_MAX_BYTES);
    for (; *out != '\0'; out++)
        *out = *out == '-' ? '_' : (char)toupper((unsigned char)*out);
}

/* The stream is a terminal, and the line contains text from outside: control characters become '?'. */
void settings_wrong(struct settings *s, const char *fmt, ...)
{
    char text[2 * REPORT_MAX];
    va_list ap;

    va_start(ap, fmt);
    (void)vsnprintf(text, sizeof text, fmt, ap);
    va_end(ap);
    (void)fputs("surfaced: ", s->errors);
    for (const char *c = text; *c != '\0'; c++)
        (void)fputc(iscntrl((unsigned char)*c) ? '?' : *c, s->errors);
    (void)fputc('\n', s->errors);
    s->problems++;
}

/* A problem with a value: "--queue 0: ", "SURFACED_QUEUE=0: " or "FILE:3: queue = 0:
 * ". */
__attribute__((format(printf, 4, 5))) static void bad_value(struct settings *s,
                                                            const struct setting *row,
                                                            const struct settings_one *v,
                                                            const char *fmt, ...)
{
    const char *text = v->text != NULL ? v->text : "";
    char where[REPORT_MAX], name[NAME_MAX_BYTES], why[REPORT_MAX];
    va_list ap;

    if (v->source == IN_FILE) {
        (void)snprintf(where, sizeof where, "%s:%u: %s = %s: ", s->file, v->line,
                       row->name, text);
    } else if (v->source == ENVIRONMENT) {
        env_name(row, name);
        (void)snprintf(where, sizeof where, "%s=%s: ", name, text);
    } else {
        (void)snprintf(where, sizeof where, "--%s %s: ", row->name, text);
    }
    va_start(ap, fmt);
    (void)vsnprintf(why, sizeof why, fmt, ap);
    va_end(ap);
    settings_wrong(s, "%s%s", where, why);
}

__attribute__((format(printf, 3, 4))) static void
bad_line(struct settings *s, unsigned line, const char *fmt, ...)
{
    char why[REPORT_MAX];
    va_list ap;

    va_start(ap, fmt);
    (void)vsnprintf(why, sizeof why, fmt, ap);
    va_end(ap);
    settings_wrong(s, "%s:%u: %s", s->file, line, why);
}

static size_t row_of(const struct settings *s, const char *name)
{
    size_t i = 0;

    while (i < s->n && strcmp(s->table[i].name, name) != 0)
        i++;
    return i;
}

void settings_wrong_value(struct settings *s, const char *name, const char *why)
{
    const size_t i = row_of(s, name);

    assert(i < s->n);
    bad_value(s, &s->table[i], &s->value[i], "%s", why);
}

unsigned settings_problems(const struct settings *s)
{
    return s->problems;
}

/* ---- values */

/* Digits, for bytes with K, M or G after them. */
static bool read_number(const char *text, const struct setting *row, unsigned long *out)
{
    static const char unit[] = "KMG";
    const char *u;
    char *end;

    if (*text < '0' || *text > '9')
        return false;
    errno = 0;
    *out = strtoul(text, &end, 10);
    if (errno != 0)
        return false;
    if (row->kind == SETTING_BYTES && *end != '\0' && (u = strchr(unit, *end)) != NULL) {
        const unsigned shift = 10 * (unsigned)(u - unit + 1);

        if (*out > ULONG_MAX >> shift)
            return false;
        *out <<= shift;
        end++;
    }
    return *end == '\0' && *out >= row->min && *out <= row->max;
}

static bool read_choice(const char *text, const char *words, unsigned *out)
{
    const size_t len = strlen(text);

    if (strchr(text, '|') != NULL)
        return false;
    for (*out = 0; words != NULL; ++*out) {
        if (strncmp(words, text, len) == 0 && (words[len] == '|' || words[len] == '\0'))
            return true;
        if ((words = strchr(words, '|')) != NULL)
            words++;
    }
    return false;
}

/* Sets *out to the path that "credential:NAME" stands for, to be released by free(); NULL for any other text.
 * Returns the error, or NULL. */
static const char *find_credential(const char *text, char **out)
{
    const char *dir = getenv("CREDENTIALS_DIRECTORY"), *name;
    size_t size;

    if (dir == NULL || *dir == '\0')
        dir = CREDENTIALS_USUAL;
    *out = NULL;
    if (strncmp(text, CREDENTIAL, strlen(CREDENTIAL)) != 0)
        return NULL;
    name = text + strlen(CREDENTIAL);
    if (*name == '\0' || *name == '.' || strchr(name, '/') != NULL)
        return "not the name of a credential";
    size = strlen(dir) + 1 + strlen(name) + 1;
    if ((*out = malloc(size)) == NULL)
        return "out of memory";
    (void)snprintf(*out, size, "%s/%s", dir, name);
    return NULL;
}

/* Checks v->text, reports an error in it, and finds v->path. */
static bool check_value(struct settings *s, const struct setting *row,
                        struct settings_one *v)
{
    const char *why = NULL;
    struct sockaddr_storage ss;
    socklen_t len;
    unsigned long n;
    unsigned word;

    switch (row->kind) {
    case SETTING_TEXT:
    case SETTING_FILE:
    case SETTING_PATH:
        if (*v->text == '\0')
            why = "an empty value";
        else if (row->kind != SETTING_TEXT)
            why = find_credential(v->text, &v->path);
        break;
    case SETTING_ADDRESS:
        if (!address_read(v->text, &ss, &len))
            why = "not an address like 127.0.0.1:8787, [::1]:8787 or unix:/run/x/socket";
        break;
    case SETTING_BOOL:
        if (strcmp(v->text, "0") != 0 && strcmp(v->text, "1") != 0)
            why = "neither 0 nor 1";
        break;
    case SETTING_CHOICE:
        if (read_choice(v->text, row->arg, &word))
            break;
        bad_value(s, row, v, "not one of %s", row->arg);
        return false;
    case SETTING_NUMBER:
    case SETTING_BYTES:
        if (read_number(v->text, row, &n))
            break;
        bad_value(s, row, v, "not a number %sfrom %lu to %lu",
                  row->kind == SETTING_BYTES ? "of bytes " : "", row->min, row->max);
        return false;
    }
    for (const char *c = v->text; why == NULL && *c != '\0'; c++)
        if (iscntrl((unsigned char)*c))
            why = "a control character";
    if (why != NULL)
        bad_value(s, row, v, "%s", why);
    return why == NULL;
}

/* Check a value and keep it. */
static void take_value(struct settings *s, size_t i, enum source source, unsigned line,
                       const char *text)
{
    struct settings_one *v = &s->value[i], new = {strdup(text), NULL, source, line};

    if (new.text == NULL) {
        settings_wrong(s, "out of memory");
    } else if (!check_value(s, &s->table[i], &new)) {
        free(new.text);
        free(new.path);
    } else {
        free(v->text);
        free(v->path);
        *v = new;
    }
}

bool settings_new(const struct setting *table, size_t n, FILE *errors,
                  struct settings **out)
{
    struct settings *s = calloc(1, sizeof *s + n * sizeof s->value[0]);

    *out = s;
    if (s == NULL)
        return false;
    s->table = table;
    s->n = n;
    s->errors = errors;
    for (size_t i = 0; i < n; i++)
        if (table[i].fallback != NULL)
            take_value(s, i, DEFAULT, 0, table[i].fallback);
    if (s->problems > 0) {
        settings_free(s);
        *out = NULL;
    }
    return *out != NULL;
}

void settings_free(struct settings *s)
{
    if (s == NULL)
        return;
    for (size_t i = 0; i < s->n; i++) {
        free(s->value[i].text);
        free(s->value[i].path);
    }
    free(s->file);
    free(s);
}

void settings_flag(struct settings *s, size_t row, const char *text)
{
    take_value(s, row, FLAG, 0, text);
}

void settings_environment(struct settings *s)
{
    char name[NAME_MAX_BYTES];
    const char *text;

    for (size_t i = 0; i < s->n; i++) {
        env_name(&s->table[i], name);
        if ((text = getenv(name)) != NULL && *text != '\0')
            take_value(s, i, ENVIRONMENT, 0, text);
    }
}

/* ---- the file */

struct settings_reading {
    struct settings *s;
    FILE *in;
    unsigned line; /* the one that was read last */
    bool broken;   /* true: reading has ended, and the reason was reported */
};

/* As fgets() for inih, but a line that is no line of text ends the reading.  inih asks
 * for the next line only after it has called back for the one before: r->line is that
 * one's. */
static char *settings_read_line(char *buf, int size, void *stream)
{
    struct settings_reading *r = stream;
    int n = 0, c;

    if (r->broken)
        return NULL;
    r->line++;
    while ((c = getc(r->in)) != EOF && c != '\n' && c != '\0' && n < size - 2)
        buf[n++] = (char)c;
    if (c != EOF && c != '\n') {
        if (c == '\0')
            bad_line(r->s, r->line, "a zero byte: the file is not text");
        else
            bad_line(r->s, r->line, "a line of more than %d bytes", LINE_MAX_BYTES);
        r->broken = true;
        return NULL;
    }
    if (c == EOF && n == 0)
        return NULL;
    buf[n++] = '\n';
    buf[n] = '\0';
    return buf;
}

static int take_line(void *user, const char *section, const char *name, const char *value)
{
    struct settings_reading *r = user;
    struct settings *s = r->s;
    const size_t i = row_of(s, name);

    if (*section != '\0' && strcmp(section, SECTION) != 0)
        bad_line(s, r->line, "a section other than [" SECTION "]");
    else if (i == s->n)
        bad_line(s, r->line, "no such setting: %s", name);
    else if (s->value[i].source == IN_FILE)
        bad_line(s, r->line, "%s is given twice, first on line %u", s->table[i].name,
                 s->value[i].line);
    else
        take_value(s, i, IN_FILE, r->line, value);
    return 1;
}

void settings_read(struct settings *s, FILE *in, const char *name)
{
    struct settings_reading r = {.s = s, .in = in};
    int at;

    free(s->file);
    if ((s->file = strdup(name)) == NULL) {
        settings_wrong(s, "out of memory");
        return;
    }
    /* One line is one setting, and all of it: a path may have " ;" in it. */
    ini_allow_multiline = false;
    ini_allow_inline_comments = false;
    ini_max_line = LINE_MAX_BYTES + 2;
    at = ini_parse_stream(settings_read_line, &r, take_line, &r);
    if (ferror(in))
        settings_wrong(s, "%s: %s", name, strerror(errno));
    else if (at > 0)
        bad_line(s, (unsigned)at, "neither NAME = VALUE nor a comment");
}

void settings_file(struct settings *s, const char *path, bool may_miss)
{
    FILE *in = fopen(path, "re");

    if (in != NULL) {
        settings_read(s, in, path);
        (void)fclose(in);
    } else if (!may_miss || errno != ENOENT) {
        settings_wrong(s, "%s: %s", path, strerror(errno));
    }
}

/* ---- results */

static const char *path_of(const struct settings_one *v)
{
    return v->path != NULL ? v->path : v->text;
}

/* Why the folder of a file cannot take it; 0: it can. */
static int folder_error(const char *path)
{
    char *folder = strdup(path), *slash;
    int why = 0;

    if (folder == NULL)
        return ENOMEM;
    if ((slash = strrchr(folder, '/')) == NULL)
        (void)strcpy(folder, "."); /* no longer: a path is not empty */
    else
        slash[slash == folder] = '\0';
    if (access(folder, W_OK | X_OK) != 0)
        why = errno;
    free(folder);
    return why;
}

void settings_check_files(struct settings *s)
{
    for (size_t i = 0; i < s->n; i++) {
        const struct setting *row = &s->table[i];
        const char *path = path_of(&s->value[i]);
        int why = 0;

        if (path == NULL || strstr(path, "://") != NULL ||
            (row->kind != SETTING_FILE && row->kind != SETTING_PATH))
            continue;
        if (access(path, row->kind == SETTING_FILE ? R_OK : R_OK | W_OK) != 0)
            why = errno;
        if (row->kind == SETTING_PATH && (why == 0 || why == ENOENT))
            why = folder_error(path);
        if (why != 0)
            settings_wrong_value(s, row->name, strerror(why));
    }
}

void settings_fill(const struct settings *s, void *out)
{
    for (size_t i = 0; i < s->n; i++) {
        const struct setting *row = &s->table[i];
        const struct settings_one *v = &s->value[i];
        char *member = (char *)out + row->offset;
        const char *text = path_of(v);
        unsigned long n = 0;
        unsigned word = 0;

        if (text == NULL)
            continue;
        switch (row->kind) {
        case SETTING_TEXT:
        case SETTING_FILE:
        case SETTING_PATH:
        case SETTING_ADDRESS:
            memcpy(member, &text, sizeof text);
            break;
        case SETTING_BOOL:
            memcpy(member, &(bool){*text == '1'}, sizeof(bool));
            break;
        case SETTING_NUMBER:
            (void)read_number(text, row, &n);
            memcpy(member, &(unsigned){(unsigned)n}, sizeof(unsigned));
            break;
        case SETTING_BYTES:
            (void)read_number(text, row, &n);
            memcpy(member, &(size_t){n}, sizeof(size_t));
            break;
        case SETTING_CHOICE:
            (void)read_choice(text, row->arg, &word);
            memcpy(member, &word, sizeof word);
            break;
        }
    }
}

/* The source of a value, as settings_print() writes it. */
static void print_source(const struct settings *s, size_t row, FILE *out)
{
    const struct settings_one *v = &s->value[row];
    char name[NAME_MAX_BYTES];

    switch (v->source) {
    case UNSET:
        (void)fprintf(out, "# not set\n");
        break;
    case DEFAULT:
        (void)fprintf(out, "# default\n");
        break;
    case ENVIRONMENT:
        env_name(&s->table[row], name);
        (void)fprintf(out, "# %s\n", name);
        break;
    case FLAG:
        (void)fprintf(out, "# --%s\n", s->table[row].name);
        break;
    case IN_FILE:
        (void)fprintf(out, "# %s:%u\n", s->file, v->line);
        break;
    }
}

void settings_print(const struct settings *s, FILE *out)
{
    for (size_t i = 0; i < s->n; i++) {
        const char *name = s->table[i].name, *text = s->value[i].text;

        print_source(s, i, out);
        if (text == NULL)
            (void)fprintf(out, "#%s =\n", name);
        else
            (void)fprintf(out, "%s = %s\n", name, text);
    }
}

void settings_print_row(FILE *out, const char *name, const char *help,
                        const char *fallback)
{
    if (fprintf(out, "  %-*s", HELP_COLUMN - 3, name) > HELP_COLUMN - 1)
        (void)fprintf(out, "\n%*s", HELP_COLUMN - 1, "");
    (void)fputc(' ', out);
    for (; *help != '\0'; help++) {
        (void)fputc(*help, out);
        if (*help == '\n')
            (void)fprintf(out, "%*s", HELP_COLUMN, "");
    }
    if (fallback != NULL)
        (void)fprintf(out, " (%s)", fallback);
    (void)fputc('\n', out);
}

void settings_help(const struct setting *table, size_t n, FILE *out)
{
    char name[NAME_MAX_BYTES];

    for (const struct setting *row = table; row < table + n; row++) {
        (void)snprintf(name, sizeof name, "--%s%s%s", row->name,
                       row->arg != NULL ? " " : "", row->arg != NULL ? row->arg : "");
        settings_print_row(out, name, row->help, row->arg != NULL ? row->fallback : NULL);
    }
}
