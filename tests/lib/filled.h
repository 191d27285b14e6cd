/* filled.h -- a database of tempdb.h with rows in every table, and its contents as text. */
#ifndef TESTS_FILLED_H
#define TESTS_FILLED_H
#include <stddef.h>

struct store;

#define FILLED_TEXT 16384

struct filled {
    char gate[65], door[65];       /* secrets of two valid tokens */
    char gate_id[33], door_id[33]; /* ids of these tokens */
};

/* filled_fresh(f): Returns tempdb_fresh(), filled: alice has two templates, is on hold and expires; bob
 * has one and a failed attempt; carol has none and is disabled; there are tokens, two devices, two
 * calibrations, a used nonce and accesses. */
struct store *filled_fresh(struct filled *f);

/* filled_look(s, out): Writes a line for each subject, template with the digest of its face, token,
 * device, calibration, attempt and nonce of the file at tempdb_path, which s has open; independent
 * of the keys. */
void filled_look(struct store *s, char out[FILLED_TEXT]);

/* filled_hashes(out): Writes the hashes of both logs of the file at tempdb_path. */
void filled_hashes(char out[FILLED_TEXT]);

#endif
