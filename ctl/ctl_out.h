/* ctl_out.h -- what surfacectl prints: JSON with --json, else text that the commands
 * print themselves.  Each call that adds to the JSON (base/json.h) does nothing without
 * --json, so a command says everything once in either form. */
#ifndef CTL_OUT_H
#define CTL_OUT_H
#include <stdbool.h>
#include <stdio.h>

struct ctl_out;
struct json; /* json.h */

struct ctl_out *ctl_out_new(bool json); /* NULL: out of memory */
bool ctl_out_json(const struct ctl_out *o);
/* ctl_out_document(o): for who writes members of it (verify/describe.h); NULL: no JSON. */
struct json *ctl_out_document(struct ctl_out *o);
void ctl_out_object(struct ctl_out *o, const char *key);
void ctl_out_array(struct ctl_out *o, const char *key);
void ctl_out_close(struct ctl_out *o);
void ctl_out_text(struct ctl_out *o, const char *key, const char *value);
void ctl_out_flag(struct ctl_out *o, const char *key, bool value);
void ctl_out_number(struct ctl_out *o, const char *key, double value);
void ctl_out_extent(struct ctl_out *o, const char *key, double value);
void ctl_out_rate(struct ctl_out *o, const char *key, double value);
void ctl_out_direction(struct ctl_out *o, const char *key, const double value[3]);
void ctl_out_transform(struct ctl_out *o, const char *key, const double value[16]);

/* ctl_out_end(o, to): print the JSON, if there is any, and release o; NULL is allowed.
 * false: out of memory on the way, or the output cannot be written. */
bool ctl_out_end(struct ctl_out *o, FILE *to);

/* ctl_out_line(o, to): the same on one line, of an o with JSON, and not flushed. */
bool ctl_out_line(struct ctl_out *o, FILE *to);

#endif
