#include "report_html.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "report_text.h"

static const char head[] =
    "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
    "<title>Evaluation of face comparison</title>\n<style>\n"
    "body { font: 16px/1.5 sans-serif; max-width: 60em; margin: 2em auto; padding: 0 1em;\n"
    "    color: #222; background: #fff }\n"
    "table { border-collapse: collapse; margin: 1em 0 }\n"
    "th, td { border: 1px solid #ccc; padding: .25em .6em; text-align: left }\n"
    "th { background: #f2f2f2 }\n"
    "img { max-width: 100% }\n"
    "</style>\n</head>\n<body>\n";

/* What a line is; a block is of lines of one kind. */
enum kind { NOTHING, TEXT, ROWS, ITEMS };

static const char *const open_tag[] = {"", "<p>", "<table>\n", "<ul>\n"};
static const char *const close_tag[] = {"", "</p>\n", "</table>\n", "</ul>\n"};

/* s[0..n-1] without Markdown's backslashes, in HTML. */
static void text(FILE *to, const char *s, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        if (s[i] == '\\' && i + 1 < n)
            i++;
        if (s[i] == '&')
            (void)fputs("&amp;", to);
        else if (s[i] == '<')
            (void)fputs("&lt;", to);
        else if (s[i] == '>')
            (void)fputs("&gt;", to);
        else
            (void)fputc(s[i], to);
    }
}

/* The cell that begins at s: its length without the spaces round it; *next the next one, or
 * NULL. */
static size_t cell(const char **s, const char **next)
{
    size_t n = 0;

    while (**s == ' ')
        ++*s;
    while ((*s)[n] != '\0' && (*s)[n] != '|')
        n += (*s)[n] == '\\' && (*s)[n + 1] != '\0' ? 2 : 1;
    *next = (*s)[n] == '|' && (*s)[n + 1] != '\0' ? *s + n + 1 : NULL;
    while (n > 0 && (*s)[n - 1] == ' ')
        n--;
    return n;
}

/* A row of a table; the one above a line of |---| is its head, left out where it is empty. */
static void row(FILE *to, const char *line, bool is_head)
{
    const char *tag = is_head ? "th" : "td";

    if (strncmp(line, "|---", 4) == 0 || (is_head && strspn(line, "| ") == strlen(line)))
        return;
    (void)fprintf(to, "<tr>");
    for (const char *s = line + 1, *next; s != NULL; s = next) {
        const size_t n = cell(&s, &next);

        (void)fprintf(to, "<%s>", tag);
        text(to, s, n);
        (void)fprintf(to, "</%s>", tag);
    }
    (void)fprintf(to, "</tr>\n");
}

static enum status base64(FILE *to, FILE *from)
{
    static const char digit[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    unsigned char in[3];
    size_t n;

    while ((n = fread(in, 1, sizeof in, from)) > 0) {
        const unsigned a = in[0], b = n > 1 ? in[1] : 0, c = n > 2 ? in[2] : 0;
        const char out[4] = {digit[a >> 2], digit[(a & 3) << 4 | b >> 4],
                             n > 1 ? digit[(b & 15) << 2 | c >> 6] : '=',
                             n > 2 ? digit[c & 63] : '='};

        (void)fwrite(out, 1, sizeof out, to);
    }
    return ferror(from) ? ST_EIO : ST_OK;
}

/* ![TITLE](FILE), with the SVG of that name in the page. */
static enum status picture(FILE *to, const char *line, int dir, struct errinfo *e)
{
    char title[64], name[64];
    int fd;
    FILE *from;
    enum status st;

    if (sscanf(line, "![%63[^]]](%63[^)])", title, name) != 2)
        return errinfo_set(e, ST_EINTERNAL, "report.html: a picture without a name");
    fd = openat(dir, name, O_RDONLY | O_CLOEXEC);
    if (fd < 0 || (from = fdopen(fd, "r")) == NULL) {
        st = errinfo_set(e, ST_EIO, "%s: %s", name, strerror(errno));
        if (fd >= 0)
            (void)close(fd);
        return st;
    }
    (void)fprintf(to, "<p><img alt=\"%s\" src=\"data:image/svg+xml;base64,", title);
    st = base64(to, from);
    (void)fclose(from);
    (void)fprintf(to, "\"></p>\n");
    return st == ST_OK ? ST_OK : errinfo_set(e, st, "%s cannot be read", name);
}

static enum kind kind_of(const char *line)
{
    if (line[0] == '|')
        return ROWS;
    if (strncmp(line, "- ", 2) == 0)
        return ITEMS;
    return line[0] == '\0' || line[0] == '#' || line[0] == '!' ? NOTHING : TEXT;
}

/* A line at a time; markdown is cut into lines. */
static enum status convert(FILE *to, char *markdown, int dir, struct errinfo *e)
{
    enum kind block = NOTHING;
    enum status st = ST_OK;

    for (char *line = markdown, *next; st == ST_OK && line != NULL; line = next) {
        enum kind kind;
        const bool first = block == NOTHING;

        if ((next = strchr(line, '\n')) != NULL)
            *next++ = '\0';
        kind = kind_of(line);
        if (kind != block) {
            (void)fputs(close_tag[block], to);
            (void)fputs(open_tag[kind], to);
        }
        block = kind;
        if (kind == ROWS) {
            row(to, line, first);
        } else if (kind == ITEMS) {
            (void)fprintf(to, "<li>");
            text(to, line + 2, strlen(line + 2));
            (void)fprintf(to, "</li>\n");
        } else if (kind == TEXT) {
            text(to, line, strlen(line));
            (void)fputc('\n', to);
        } else if (line[0] == '#') {
            const size_t level = strspn(line, "#");

            (void)fprintf(to, "<h%zu>", level);
            text(to, line + level + 1, strlen(line + level + 1));
            (void)fprintf(to, "</h%zu>\n", level);
        } else if (line[0] == '!') {
            st = picture(to, line, dir, e);
        }
    }
    (void)fputs(close_tag[block], to);
    return st;
}

enum status report_html(FILE *to, const void *arg, struct errinfo *e)
{
    const struct report_html *p = arg;
    char *markdown = NULL;
    size_t size;
    FILE *text_to = open_memstream(&markdown, &size);
    enum status st = ST_ENOMEM;

    if (text_to != NULL) {
        st = report_text(text_to, p->r, e);
        if (fclose(text_to) != 0)
            st = ST_ENOMEM;
    }
    if (st == ST_OK) {
        (void)fputs(head, to);
        st = convert(to, markdown, p->dir, e);
        (void)fputs("</body>\n</html>\n", to);
    } else {
        (void)errinfo_set(e, st, "report.html: %s", status_message(st));
    }
    free(markdown);
    return st;
}
