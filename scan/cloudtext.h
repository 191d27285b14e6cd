/* cloudtext.h -- a cursor over the text of a scanner's file: words, numbers, lines, and
 * errors with their place.  Any text is safe.  For cloudfile.c and the
 * readers of each format. */
#ifndef SCAN_CLOUDTEXT_H
#define SCAN_CLOUDTEXT_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "status.h"

struct errinfo; /* errinfo.h */

struct cloudtext {
    const char *start, *p, *end;
    uint32_t line;     /* of p, from 1; 0: not counted (binary) */
    bool continued;    /* a backslash before a line end joins two lines (OBJ) */
    struct errinfo *e; /* may be NULL */
};

/* cloudtext_fail(t, st, fmt, ...): fill *t->e, "line 3: ..." or "byte 80: ..." of t->p;
 * returns st. */
__attribute__((format(printf, 3, 4))) enum status
cloudtext_fail(struct cloudtext *t, enum status st, const char *fmt, ...);

/* cloudtext_blank(t): skip blanks and tabs. */
void cloudtext_blank(struct cloudtext *t);

/* cloudtext_eol(t): does the line, or the text, end here? */
bool cloudtext_eol(const struct cloudtext *t);

/* cloudtext_newline(t): skip one line end (LF, CR LF or CR), if there is one. */
void cloudtext_newline(struct cloudtext *t);

/* cloudtext_skip(t): skip the rest of the line and its end. */
void cloudtext_skip(struct cloudtext *t);

/* cloudtext_find(t): skip blanks and line ends; false at the text's end. */
bool cloudtext_find(struct cloudtext *t);

/* cloudtext_word(t, len): skip blanks, then read a word, up to a blank or the line's end;
 * *len is 0 at the line's end. */
const char *cloudtext_word(struct cloudtext *t, size_t *len);
bool cloudtext_is(const char *word, size_t len, const char *what);
bool cloudtext_like(const char *word, size_t len, const char *what); /* in any case */

/* cloudtext_number(t, out): read a number, after blanks; a blank, a comma, a semicolon or the
 * line's end must follow it.  NaN and infinity, as programs write them ("nan", "-inf",
 * "1.#QNAN"), and numbers too large for a double, give a value that is not finite.
 * Returns ST_OK, ST_EINVAL (no number). */
enum status cloudtext_number(struct cloudtext *t, double *out);

/* cloudtext_pass(t): Passes over the next word of the line.  Returns ST_OK; ST_EINVAL: there is none. */
enum status cloudtext_pass(struct cloudtext *t);

/* cloudtext_row_end(t): Returns ST_OK if nothing but blanks is left on the line; else ST_EINVAL. */
enum status cloudtext_row_end(struct cloudtext *t);

/* cloudtext_cut_off(t, n, row): Returns ST_EINVAL: the data ends in the point `row`, counted from 0, of the n
 * that the header promises. */
enum status cloudtext_cut_off(struct cloudtext *t, uint64_t n, uint64_t row);

/* cloudtext_count(word, len, out): a word of 1 to 18 digits. */
bool cloudtext_count(const char *word, size_t len, uint64_t *out);

/* cloudtext_comment(t): does a comment (#, % or //) begin here?  Not at the text's end. */
bool cloudtext_comment(const struct cloudtext *t);
bool cloudtext_is_letter(char c); /* or an underscore */

/* cloudtext_plain(t): Checks that everything from p on is text.  A Ctrl-Z (0x1A) at its end is taken
 * off.  Returns ST_OK; ST_EINVAL at the first control character other than tab, line feed, form feed
 * and carriage return. */
enum status cloudtext_plain(struct cloudtext *t);

#endif
