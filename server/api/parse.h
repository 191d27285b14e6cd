/* parse.h -- the JSON that a request's body is: clouds, a subject to be made, what to
 * change of one.  What is wrong with it and where stands in e. */
#ifndef SERVER_PARSE_H
#define SERVER_PARSE_H
#include <stdbool.h>
#include <stddef.h>
#include "status.h"
#include "store.h"

struct cloudfile_options; /* cloudfile.h */
struct cloudpoints;       /* cloudpoints.h */
struct errinfo;           /* errinfo.h */

/* parse_clouds(text, len, o, a, b, e): {"a": cloud, "b": cloud}, as cloudfile_read() reads
 * one.  text[len] must be 0.  On failure both are empty. */
enum status parse_clouds(const char *text, size_t len, const struct cloudfile_options *o,
                         struct cloudpoints *a, struct cloudpoints *b, struct errinfo *e);

#define PARSE_TEXT_MAX 256

struct parse_token { /* to be made */
    char name[STORE_NAME_MAX + 1];
    unsigned scopes;
    int64_t end_ms; /* STORE_NEVER, or since 1970 */
};

/* parse_token(text, len, out, e): {"name", "scopes": [...]} and expires_at, which may be null (for
 * ever) or missing (the usual life).  parse_rotation(text, len, grace_s, e): {} or {"grace_s"}. */
enum status parse_token(const char *text, size_t len, struct parse_token *out,
                        struct errinfo *e);
enum status parse_rotation(const char *text, size_t len, int64_t *grace_s,
                           struct errinfo *e);

struct parse_change {
    struct store_subject_change what; /* points into the rest, which is not to be moved */
    char consent[PARSE_TEXT_MAX], purpose[PARSE_TEXT_MAX], expires[PARSE_TEXT_MAX];
    bool hold, disabled;
};

/* parse_newcomer(text, len, out, e): a subject to be made: its id as subject, and
 * consent, purpose and expires_at, which may miss or be null; the rest as below. */
enum status parse_newcomer(const char *text, size_t len, struct store_subject *out,
                           struct errinfo *e);

/* parse_change(text, len, out, e): a merge patch (RFC 7396) of a subject: consent,
 * purpose, expires_at (texts, or null for none), hold and disabled.  text as above.
 * Nothing else may be in it: who means to hold is not to find out later that "on_hold"
 * did nothing.  Returns ST_OK; ST_EINVAL; ST_ENOMEM. */
enum status parse_change(const char *text, size_t len, struct parse_change *out,
                         struct errinfo *e);

#endif
