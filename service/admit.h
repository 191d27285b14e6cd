/* admit.h -- may a subject be verified, and may samples of it be enrolled?  Who is disabled
 * or has expired may not, until somebody who manages subjects says otherwise. */
#ifndef VERIFY_ADMIT_H
#define VERIFY_ADMIT_H

struct errinfo;       /* errinfo.h */
struct store_subject; /* store.h */

enum admit { ADMIT_YES, ADMIT_DISABLED, ADMIT_EXPIRED };

/* admit_subject(one, e): one as store_subject_get() read it.  Unless it may, *e is set:
 * ST_EDENIED, with what to do. */
enum admit admit_subject(const struct store_subject *one, struct errinfo *e);

#endif
