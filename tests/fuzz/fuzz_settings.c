/* Configuration files.  Each problem is one line; and the printed settings, whether or not
 * there were problems, are a file without problems that gives the same settings. */
#include "fuzz.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "settings.h"

struct all {
    const char *text, *file, *address;
    unsigned number, choice;
    size_t bytes;
    bool yes;
};

static const struct setting table[] = {
    {"text", SETTING_TEXT, NULL, offsetof(struct all, text), 0, 0, "TEXT", ""},
    {"file", SETTING_FILE, NULL, offsetof(struct all, file), 0, 0, "FILE", ""},
    {"listen", SETTING_ADDRESS, NULL, offsetof(struct all, address), 0, 0, "ADDR", ""},
    {"number", SETTING_NUMBER, "4", offsetof(struct all, number), 1, 256, "N", ""},
    {"max-body", SETTING_BYTES, "64M", offsetof(struct all, bytes), 1, 1UL << 30, "N",
     ""},
    {"yes", SETTING_BOOL, "0", offsetof(struct all, yes), 0, 0, NULL, ""},
    {"log", SETTING_CHOICE, "logfmt", offsetof(struct all, choice), 0, 0, "logfmt|json",
     ""},
};
#define ROWS (sizeof table / sizeof table[0])

struct memory {
    FILE *stream;
    char *text;
    size_t len;
};

static void open_memory(struct memory *m)
{
    if ((m->stream = open_memstream(&m->text, &m->len)) == NULL)
        abort();
}

static void close_memory(struct memory *m)
{
    if (fclose(m->stream) != 0)
        abort();
}

/* Reads the data and prints the settings; returns the number of problems. */
static unsigned read_and_print(const void *data, size_t size, struct all *out,
                               struct memory *printed)
{
    struct memory errors;
    struct settings *s;
    unsigned problems, lines = 0;
    FILE *in;

    open_memory(&errors);
    if (!settings_new(table, ROWS, errors.stream, &s) || (in = tmpfile()) == NULL ||
        fwrite(data, 1, size, in) != size)
        abort();
    rewind(in);
    settings_read(s, in, "fuzz.conf");
    (void)fclose(in);
    problems = settings_problems(s);
    close_memory(&errors);
    for (size_t i = 0; i < errors.len; i++)
        lines += errors.text[i] == '\n';
    if (lines != problems || strlen(errors.text) != errors.len)
        abort();
    settings_fill(s, out);
    if (out->number < 1 || out->number > 256 || out->bytes < 1 ||
        out->bytes > 1UL << 30 || out->choice > 1)
        abort();
    out->text = out->file = out->address = NULL; /* of s */
    open_memory(printed);
    settings_print(s, printed->stream);
    close_memory(printed);
    settings_free(s);
    free(errors.text);
    return problems;
}

/* Removes the comments, which name the source of each setting. */
static char *without_comments(char *text)
{
    char *to = text;

    for (char *line = text, *end; *line != '\0'; line = end) {
        end = strchr(line, '\n') + 1;
        if (*line != '#') {
            memmove(to, line, (size_t)(end - line));
            to += end - line;
        }
    }
    *to = '\0';
    return text;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct all first = {0}, again = {0};
    struct memory one, two;

    if (size == 0)
        return 0;
    (void)read_and_print(data, size, &first, &one);
    if (read_and_print(one.text, one.len, &again, &two) != 0)
        abort();
    if (first.number != again.number || first.bytes != again.bytes ||
        first.yes != again.yes || first.choice != again.choice ||
        strcmp(without_comments(one.text), without_comments(two.text)) != 0)
        abort();
    free(one.text);
    free(two.text);
    return 0;
}
