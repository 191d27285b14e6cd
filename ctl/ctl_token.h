/* ctl_token.h -- tokens by their names, for commands whose user should not need ids. */
#ifndef CTL_TOKEN_H
#define CTL_TOKEN_H
#include <stdbool.h>

#include "rows_types.h"

struct ctl; /* ctl.h */

#define CTL_TOKEN_LABEL (STORE_NAME_MAX + 12)

/* ctl_token_find(c, name, revoked, id): Finds a token by its id or by its name, in the open database.
 *   revoked  also look at revoked tokens
 *   id       receives the token's id; name itself if it has the form of an id
 * Returns ST_OK, or an error with c->e set: ST_ENOTFOUND; ST_EINVAL if several tokens have this name. */
enum status ctl_token_find(struct ctl *c, const char *name, bool revoked,
                           char id[STORE_ID_LEN + 1]);

/* ctl_token_label(out, name, id): Writes the name and, as names can be doubled or look like a program's, the
 * beginning of the id: "door (2cd7ecd3)".  Without a name writes the id. */
void ctl_token_label(char out[CTL_TOKEN_LABEL], const char *name, const char *id);

#endif
