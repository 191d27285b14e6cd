/* parse.h -- request bodies of JSON.  The text of a body ends with a 0 byte.  Each function returns ST_OK, or an
 * error and fills *e: ST_EINVAL: malformed, or a member that is not named here; ST_ENOMEM. */
#ifndef SERVER_PARSE_H
#define SERVER_PARSE_H
#include <stdbool.h>
#include <stddef.h>
#include "status.h"
#include "store.h"

struct cloudfile_options; /* cloudfile.h */
struct cloudpoints;       /* cloudpoints.h */
struct errinfo;           /* errinfo.h */

/* parse_clouds(text, len, o, a, b, e): Reads {"a": cloud, "b": cloud}; each cloud as cloudfile_read() reads one.
 *   a, b  to be released by cloudpoints_free(); empty after a failure
 * Returns also the errors of cloudfile_read(). */
enum status parse_clouds(const char *text, size_t len, const struct cloudfile_options *o,
                         struct cloudpoints *a, struct cloudpoints *b, struct errinfo *e);

#define PARSE_TEXT_MAX 256 /* bytes of a text, with its NUL */

struct parse_token { /* a token to be made */
    char name[STORE_NAME_MAX + 1];
    unsigned scopes;
    char groups[GROUPS_SIZE]; /* "": not given */
    int64_t end_ms;           /* end of its validity, ms since 1970, or STORE_NEVER */
};

/* parse_token(text, len, out, e): Reads {"name", "scopes": [...], "groups": [...], "expires_at"}.  An expires_at of null means
 * never; a missing one means the default life. */
enum status parse_token(const char *text, size_t len, struct parse_token *out,
                        struct errinfo *e);

/* parse_rotation(text, len, grace_s, e): Reads {} or {"grace_s"}. */
enum status parse_rotation(const char *text, size_t len, int64_t *grace_s,
                           struct errinfo *e);

struct parse_change {
    struct store_subject_change what; /* points into the other members: do not move it */
    char consent[PARSE_TEXT_MAX], purpose[PARSE_TEXT_MAX], expires[PARSE_TEXT_MAX];
    char groups[GROUPS_SIZE];
    bool hold, disabled, identify;
};

/* parse_newcomer(text, len, out, e): Reads a subject to be made: its id as "subject", and consent, purpose,
 * expires_at, groups and identify, which may be missing or null. */
enum status parse_newcomer(const char *text, size_t len, struct store_subject *out,
                           struct errinfo *e);

/* parse_change(text, len, out, e): Reads a merge patch (RFC 7396) of a subject: consent, purpose and expires_at
 * (a text, or null for none), hold and disabled, groups (an array, or null for none), identify (null: true).  An unknown member is refused: a misspelt "on_hold" must not
 * be ignored. */
enum status parse_change(const char *text, size_t len, struct parse_change *out,
                         struct errinfo *e);

#endif
