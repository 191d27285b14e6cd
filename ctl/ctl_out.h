/* ctl_out.h -- what surfacectl prints: JSON with --json, else text that the commands
 * print themselves.  Each call that adds to the JSON does nothing without --json, so a
 * command says everything once in either form. */
#ifndef DB_SURFACECTL_OUT_H
#define DB_SURFACECTL_OUT_H
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

struct ctl_out;

/* An object is begun with the first field; key is NULL for the elements of an array. */
struct ctl_out *ctl_out_new(bool json); /* NULL: out of memory */
bool ctl_out_json(const struct ctl_out *o);
void ctl_out_object(struct ctl_out *o, const char *key);
void ctl_out_array(struct ctl_out *o, const char *key);
void ctl_out_close(struct ctl_out *o); /* the object or array begun last */
void ctl_out_text(struct ctl_out *o, const char *key, const char *value);
void ctl_out_number(struct ctl_out *o, const char *key, double value);
void ctl_out_flag(struct ctl_out *o, const char *key, bool value);

/* ctl_out_end(o, to): print the JSON, if there is any, and release o; NULL is allowed.
 * false: out of memory on the way, or the output cannot be written. */
bool ctl_out_end(struct ctl_out *o, FILE *to);

/* ctl_out_line(o, to): the same on one line, of an o with JSON, and not flushed. */
bool ctl_out_line(struct ctl_out *o, FILE *to);

/* ctl_out_parse(text): an object that was printed so, released by
 * ctl_out_drop(); NULL: it is none, or no memory.
 * ctl_out_take_text(o, key, out, size), ctl_out_take_count(o, key, out): a text
 * of up to size - 1 bytes, a whole number up to 2^53; false: there is no such member. */
struct ctl_out *ctl_out_parse(const char *text);
bool ctl_out_take_text(const struct ctl_out *o, const char *key, char *out, size_t size);
bool ctl_out_take_count(const struct ctl_out *o, const char *key, uint64_t *out);

/* ctl_out_enter(o, key): what is taken from now on is of that object or array, until
 * ctl_out_close(); false: there is none, and nothing is entered.
 * ctl_out_count(o): its members.
 * ctl_out_take_item(o, i, out, size): of an array the text in place i. */
bool ctl_out_enter(struct ctl_out *o, const char *key);
size_t ctl_out_count(const struct ctl_out *o);
bool ctl_out_take_item(const struct ctl_out *o, size_t i, char *out, size_t size);
void ctl_out_drop(struct ctl_out *o); /* NULL is allowed */

#endif
