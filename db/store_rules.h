/* store_rules.h -- times, random ids, and how much there may be. */
#ifndef DB_STORE_RULES_H
#define DB_STORE_RULES_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "status.h"

struct errinfo;

/* 2 * bytes random hexadecimal digits and a NUL; at most 32 bytes. */
void store_rules_random(char *out, size_t bytes);

/* store_rules_now(ms, e): utc_now(), or ST_EINTERNAL. */
enum status store_rules_now(int64_t *ms, struct errinfo *e);

/* store_rules_past(at, ms): has the time come?  "": never; what is no time: yes. */
bool store_rules_past(const char *at, int64_t ms);

/* store_rules_recent(at, ms): is `at` a time in the minute before ms?  One in the future is
 * from before the clock was set back, and is not recent. */
bool store_rules_recent(const char *at, int64_t ms);

/* store_rules_room(subject, templates, e): may a template be added to so many of the subject?
 * ST_EFULL. */
enum status store_rules_room(const char *subject, size_t templates, struct errinfo *e);

#endif
