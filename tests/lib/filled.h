/* filled.h -- a database of tempdb.h with some of everything, and all that a store tells of it. */
#ifndef TESTS_FILLED_H
#define TESTS_FILLED_H
#include <stddef.h>

struct store;

#define FILLED_TEXT 16384

struct filled {
    char gate[65], door[65];       /* secrets of two tokens that are good */
    char gate_id[33], door_id[33]; /* and their ids */
};

/* filled_fresh(f): tempdb_fresh(), filled: alice has two templates, is on hold and expires; bob has
 * one and a failed attempt, carol none and is disabled; tokens, two devices, two calibrations, a
 * nonce that was used, accesses.
 * filled_look(s, out): a line each of subjects, templates and their faces' digests, tokens, devices,
 * calibrations, attempts, nonces, whatever the keys are; of the file at tempdb_path, which s has open.
 * filled_hashes(out): the hashes of both logs, of the file at tempdb_path. */
struct store *filled_fresh(struct filled *f);
void filled_look(struct store *s, char out[FILLED_TEXT]);
void filled_hashes(char out[FILLED_TEXT]);

#endif
