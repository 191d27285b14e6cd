/* ident.h -- the ids that clients and operators give and get. */
#ifndef BASE_IDENT_H
#define BASE_IDENT_H
#include <stdbool.h>
#include <stddef.h>
#include "status.h"

struct errinfo;

#define IDENT_SUBJECT 128 /* greatest length of a subject's id: A-Z a-z 0-9 . _ - @ : */
#define IDENT_ID                                                                         \
    32 /* length of the id of a template, token or device: 128 random bits in hex */

/* ident_subject_valid(subject): Returns true for a subject's id, and false also for "." and "..". */
bool ident_subject_valid(const char *subject);

/* ident_id_valid(id): Returns true for the id of a template, a token or a device. */
bool ident_id_valid(const char *id);

/* ident_subject(subject, e): Returns ST_OK for a subject's id; else ST_EINVAL, and states the rule in *e. */
enum status ident_subject(const char *subject, struct errinfo *e);

/* ident_id(id, what, e): Returns ST_OK for an id of the second kind; else ST_EINVAL, and states the rule in *e.
 *   what    name of the object in the message, "template" */
enum status ident_id(const char *id, const char *what, struct errinfo *e);

/* ident_consists(text, set, min, max): Returns true for a text of min to max characters, all of set. */
bool ident_consists(const char *text, const char *set, size_t min, size_t max);

/* ident_printable(text, min, max): Returns true for a text of min to max characters of printable ASCII. */
bool ident_printable(const char *text, size_t min, size_t max);

#endif
