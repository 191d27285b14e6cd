/* groups.h -- lists of groups: labels of subjects, to which a token may be bound.
 * A list is text: at most GROUPS_MAX labels, each [a-z0-9._-]{1,64}, ascending and distinct, separated by
 * commas; "": no label.
 * bound: the groups of a token; "": it is not bound, and every subject is its own. */
#ifndef BASE_GROUPS_H
#define BASE_GROUPS_H
#include <stdbool.h>
#include "status.h"

struct errinfo;

#define GROUPS_MAX   8                                 /* labels of a list */
#define GROUPS_LABEL 64                                /* bytes of a label */
#define GROUPS_SIZE  (GROUPS_MAX * (GROUPS_LABEL + 1)) /* bytes of a list, with its NUL */

/* groups_label(text): Returns true if text is one label. */
bool groups_label(const char *text);

/* groups_add(list, label, e): Adds a label, unless the list has it.  ST_EINVAL: it is no label, or the list is
 * full; the list is then unchanged. */
enum status groups_add(char list[GROUPS_SIZE], const char *label, struct errinfo *e);

/* groups_read(text, out, e): Reads labels in any order, separated by commas, into a list; "": none.
 * ST_EINVAL as groups_add(). */
enum status groups_read(const char *text, char out[GROUPS_SIZE], struct errinfo *e);

/* groups_valid(text): Returns true if text is a list. */
bool groups_valid(const char *text);

/* groups_next(list, label): Copies the first label of the list, and returns the text after it, for the next
 * call; NULL: there is no label. */
const char *groups_next(const char *list, char label[GROUPS_LABEL + 1]);

/* groups_meet(bound, list): Returns true if a subject of these groups is visible to the token: they have a label
 * in common, or the token is not bound. */
bool groups_meet(const char *bound, const char *list);

/* groups_within(bound, list): Returns true if the token may give this list: it has a label, and only labels of
 * the token; or the token is not bound. */
bool groups_within(const char *bound, const char *list);

/* groups_common(bound, list, out): Writes the labels of list that the token may know: those in both lists, or all
 * if it is not bound. */
void groups_common(const char *bound, const char *list, char out[GROUPS_SIZE]);

/* groups_replace(bound, list, with, out, e): Writes a subject's new groups: `with`, and the labels of list that
 * are not the token's, which it can neither see nor change.  ST_EINVAL: too many. */
enum status groups_replace(const char *bound, const char *list, const char *with,
                           char out[GROUPS_SIZE], struct errinfo *e);

#endif
