/* ident.h -- the ids that clients and operators give and get. */
#ifndef BASE_IDENT_H
#define BASE_IDENT_H
#include <stdbool.h>
#include <stddef.h>
#include "status.h"

struct errinfo;

#define IDENT_SUBJECT 128 /* bytes of a subject's id, at most: A-Z a-z 0-9 . _ - @ : */
#define IDENT_ID      32 /* of a template's, token's or device's: 128 random bits in hex */

/* Is it a subject's id, but "." or ".."; is it an id of the second kind? */
bool ident_subject_valid(const char *subject);
bool ident_id_valid(const char *id);

/* The same: ST_OK, or ST_EINVAL with the rule as text; what: "template", "token". */
enum status ident_subject(const char *subject, struct errinfo *e);
enum status ident_id(const char *id, const char *what, struct errinfo *e);

/* min to max characters, all of set; min to max characters of printable ASCII. */
bool ident_consists(const char *text, const char *set, size_t min, size_t max);
bool ident_printable(const char *text, size_t min, size_t max);

#endif
