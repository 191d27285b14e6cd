/* crash.h -- for the crash tests: a folder as it may be found after a loss of power, and
 * what a database in it says.  A failure of the test's own ends the program. */
#ifndef TESTS_CRASH_H
#define TESTS_CRASH_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "crash_op.h"

struct brute_rng; /* brute.h */

#define CRASH_PATH 512

/* crash_join(out, dir, name): "DIR/NAME", which must fit. */
void crash_join(char out[CRASH_PATH], const char *dir, const char *name);

/* Folders of files, without folders in them.  crash_copy(): what is in `to` goes
 * first. */
void crash_copy(const char *from, const char *to);
void crash_remove(const char *dir);

/* ---- what is left of changes */

struct crash_log;

/* crash_log_new(dir): before a program changes the folder; crash_log_read(l, path): what
 * it has changed since, by the log that crash_shim.so has made of it. */
struct crash_log *crash_log_new(const char *dir);
void crash_log_read(struct crash_log *l, const char *path);
void crash_log_free(struct crash_log *l); /* NULL is allowed */

/* crash_log_n(l): how many changes.  crash_log_bytes(l, n): the log's length after n. */
size_t crash_log_n(const struct crash_log *l);
uint64_t crash_log_bytes(const struct crash_log *l, size_t n);

/* crash_log_state(l, n, some, rng, dir): the folder after the first n changes and a loss of power, in
 * dir.  What was not synced (fsync) is lost; or with some, some of it is there: any sectors of 512
 * bytes, and names in their order. */
void crash_log_state(const struct crash_log *l, size_t n, bool some,
                     struct brute_rng *rng, const char *dir);

/* ---- what is in a database */

#define CRASH_TEXT (128 << 10)

/* crash_look(dir, text): all that DIR/db has of subjects and tokens, without random ids;
 * it is opened with DIR/db.key, or what the store finds instead, and checked.  "none":
 * there is no database yet.  false: it cannot be opened, or something is wrong with it,
 * and text says what. */
bool crash_look(const char *dir, char text[CRASH_TEXT]);

struct crash_secret { /* bytes of a wrapped key, or of a face */
    unsigned char at[32];
};

/* crash_secrets(dir, out, max): those of DIR/db; returns how many.
 * crash_found(s, n, dir): how many of them are in the bytes of DIR/db and its logs. */
size_t crash_secrets(const char *dir, struct crash_secret *out, size_t max);
size_t crash_found(const struct crash_secret *s, size_t n, const char *dir);

#endif
