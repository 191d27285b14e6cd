/* surfacectl_out.h -- what surfacectl prints: JSON with --json, else text that the commands
 * print themselves.  Each call that adds to the JSON does nothing without --json, so a
 * command says everything once in either form. */
#ifndef DB_SURFACECTL_OUT_H
#define DB_SURFACECTL_OUT_H
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

struct surfacectl_out;

/* An object is begun with the first field; key is NULL for the elements of an array. */
struct surfacectl_out *surfacectl_out_new(bool json); /* NULL: out of memory */
bool surfacectl_out_json(const struct surfacectl_out *o);
void surfacectl_out_object(struct surfacectl_out *o, const char *key);
void surfacectl_out_array(struct surfacectl_out *o, const char *key);
void surfacectl_out_close(struct surfacectl_out *o); /* the object or array begun last */
void surfacectl_out_text(struct surfacectl_out *o, const char *key, const char *value);
void surfacectl_out_number(struct surfacectl_out *o, const char *key, double value);
void surfacectl_out_flag(struct surfacectl_out *o, const char *key, bool value);

/* surfacectl_out_end(o, to): print the JSON, if there is any, and release o; NULL is allowed.
 * false: out of memory on the way, or the output cannot be written. */
bool surfacectl_out_end(struct surfacectl_out *o, FILE *to);

/* surfacectl_out_line(o, to): the same on one line, of an o with JSON, and not flushed. */
bool surfacectl_out_line(struct surfacectl_out *o, FILE *to);

/* surfacectl_out_parse(text): an object that was printed so, released by
 * surfacectl_out_drop(); NULL: it is none, or no memory.
 * surfacectl_out_take_text(o, key, out, size), surfacectl_out_take_count(o, key, out): a text
 * of up to size - 1 bytes, a whole number up to 2^53; false: there is no such member. */
struct surfacectl_out *surfacectl_out_parse(const char *text);
bool surfacectl_out_take_text(const struct surfacectl_out *o, const char *key, char *out,
                              size_t size);
bool surfacectl_out_take_count(const struct surfacectl_out *o, const char *key,
                               uint64_t *out);

/* surfacectl_out_enter(o, key): what is taken from now on is of that object or array, until
 * surfacectl_out_close(); false: there is none, and nothing is entered.
 * surfacectl_out_count(o): its members.
 * surfacectl_out_take_item(o, i, out, size): of an array the text in place i. */
bool surfacectl_out_enter(struct surfacectl_out *o, const char *key);
size_t surfacectl_out_count(const struct surfacectl_out *o);
bool surfacectl_out_take_item(const struct surfacectl_out *o, size_t i, char *out,
                              size_t size);
void surfacectl_out_drop(struct surfacectl_out *o); /* NULL is allowed */

#endif
