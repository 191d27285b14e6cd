/* store.h -- the template store: all that programs may ask of it.
 * A store may be used from any number of threads; each call is one transaction: it either takes
 * full effect or none, and is on the disk when it returns ST_OK (but see store_event()).  Other
 * processes may use the same database at the same time; each call sees what they have
 * committed.  Ids are checked by the callee (ST_EINVAL).
 * actor: the caller, for the events: a token's id, a program's name or "".
 * Every call returns a status and fills *e (may be NULL) on failure:
 * ST_EINVAL, ST_ENOTFOUND, ST_EEXISTS, ST_ECORRUPT (damaged row or file, not a database),
 * ST_EVERSION (database of another version), ST_EBUSY (locked by another process for longer
 * than 5 s), ST_EIO (disk full, not writable), ST_EDB, ST_ENOMEM. */
#ifndef DB_STORE_H
#define DB_STORE_H
#include "store_attempts.h"
#include "store_audit.h"
#include "store_calibration.h"
#include "store_capture.h"
#include "store_device.h"
#include "store_erase.h"
#include "store_open.h"
#include "store_subject.h"
#include "store_template.h"
#include "store_token.h"
#include "store_verification.h"

#endif
