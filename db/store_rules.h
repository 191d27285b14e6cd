/* store_rules.h -- what may be stored, ids and times. */
#ifndef DB_STORE_RULES_H
#define DB_STORE_RULES_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "status.h"
#include "utc.h"

struct errinfo;

struct store_act { /* who changes something, and when */
    const char *actor;
    int64_t ms; /* since 1970, UTC */
    char at[UTC_TEXT];
};

/* Is it a subject's id, is it one of a template or a token? */
bool store_subject_valid(const char *subject);
bool store_id_valid(const char *id);

/* min to max characters, all of set. */
bool store_rules_consist(const char *text, const char *set, size_t min, size_t max);

/* min to max characters of printable ASCII. */
bool store_rules_printable(const char *text, size_t min, size_t max);

/* ST_OK, or ST_EINVAL with the rule as text; what: "template", "token". */
enum status store_rules_subject(const char *subject, struct errinfo *e);
enum status store_rules_id(const char *id, const char *what, struct errinfo *e);

enum status store_rules_event(const char *kind, const char *subject,
                              const char *template_id, const char *outcome,
                              struct errinfo *e);

/* The 16 bytes of a template's or a token's id; zeros where it is none. */
void store_rules_raw(const char *id, unsigned char out[16]);

/* 2 * bytes random hexadecimal digits and a NUL; at most 32 bytes. */
void store_rules_random(char *out, size_t bytes);

/* store_rules_now(ms, e): utc_now(), or ST_EINTERNAL. */
enum status store_rules_now(int64_t *ms, struct errinfo *e);

/* store_rules_past(at, ms): has the time come?  "": never; what is no time: yes. */
bool store_rules_past(const char *at, int64_t ms);

/* store_rules_recent(at, ms): is `at` a time in the minute before ms?  One in the future is
 * from before the clock was set back, and is not recent. */
bool store_rules_recent(const char *at, int64_t ms);

/* store_rules_act(by, actor, e): actor, if it is one, does something now. */
enum status store_rules_act(struct store_act *by, const char *actor, struct errinfo *e);

/* store_rules_room(subject, templates, e): may a template be added to so many of the subject?
 * ST_EFULL. */
enum status store_rules_room(const char *subject, uint32_t templates, struct errinfo *e);

#endif
