/* cloudtext.h -- a cursor over the text of a scanner's file: words, numbers, lines, and errors with their place.
 * Any text is safe.  For cloudfile.c and the readers of each format. */
#ifndef SCAN_CLOUDTEXT_H
#define SCAN_CLOUDTEXT_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "status.h"

struct errinfo; /* errinfo.h */

struct cloudtext {
    const char *start, *p, *end;
    uint32_t line;     /* line of p, from 1; 0: not counted (binary) */
    bool continued;    /* a backslash before a line end joins two lines (OBJ) */
    struct errinfo *e; /* may be NULL */
};

/* cloudtext_fail(t, st, fmt, ...): Fills *t->e with a message that begins with the place of t->p, "line 3: " or
 * "byte 80: ".  Returns st. */
__attribute__((format(printf, 3, 4))) enum status
cloudtext_fail(struct cloudtext *t, enum status st, const char *fmt, ...);

/* cloudtext_blank(t): Skips blanks and tabs. */
void cloudtext_blank(struct cloudtext *t);

/* cloudtext_eol(t): Returns true if the line or the text ends here. */
bool cloudtext_eol(const struct cloudtext *t);

/* cloudtext_newline(t): Skips one line end (LF, CR LF or CR), if there is one. */
void cloudtext_newline(struct cloudtext *t);

/* cloudtext_skip(t): Skips the rest of the line and its end. */
void cloudtext_skip(struct cloudtext *t);

/* cloudtext_find(t): Skips blanks and line ends.  Returns false at the text's end. */
bool cloudtext_find(struct cloudtext *t);

/* cloudtext_word(t, len): Skips blanks, then reads a word, up to a blank or the line's end.  *len is 0 at the
 * line's end. */
const char *cloudtext_word(struct cloudtext *t, size_t *len);

/* cloudtext_is(word, len, what): Returns true if the word is this one. */
bool cloudtext_is(const char *word, size_t len, const char *what);

/* cloudtext_like(word, len, what): Returns true if the word is this one, in small or capital letters. */
bool cloudtext_like(const char *word, size_t len, const char *what);

/* cloudtext_number(t, out): Reads a number, after blanks; a blank, a comma, a semicolon or the
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

/* cloudtext_count(word, len, out): Reads a word of 1 to 18 digits.  Returns false if it is none. */
bool cloudtext_count(const char *word, size_t len, uint64_t *out);

/* cloudtext_comment(t): Returns true if a comment (#, % or //) begins here.  t is not at the text's end. */
bool cloudtext_comment(const struct cloudtext *t);

/* cloudtext_is_letter(c): Returns true for a letter of ASCII or an underscore. */
bool cloudtext_is_letter(char c);

/* cloudtext_plain(t): Checks that everything from p on is text.  A Ctrl-Z (0x1A) at its end is taken
 * off.  Returns ST_OK; ST_EINVAL at the first control character other than tab, line feed, form feed
 * and carriage return. */
enum status cloudtext_plain(struct cloudtext *t);

#endif
