/* crash_op.h -- what crash_shim.c writes down of a program that it is loaded into: every
 * change that the program makes to one folder and its files, in the order in which they were
 * made.  The log is a sequence of struct crash_op, each followed by len bytes for CRASH_WRITE.
 * Environment: CRASH_DIR the folder (absolute, without links); CRASH_LOG where the log goes;
 * CRASH_AT=N the program is killed (SIGKILL) as it begins its N-th change, CRASH_TORN=1: where
 * that is a write, after the first half of it. */
#ifndef TESTS_CRASH_OP_H
#define TESTS_CRASH_OP_H
#include <stdint.h>

#define CRASH_NAME 64

enum crash_kind {
    CRASH_CREATE,   /* name, file: an empty file */
    CRASH_WRITE,    /* file, at, len */
    CRASH_TRUNCATE, /* file, at: its new size */
    CRASH_SYNC,     /* file */
    CRASH_SYNC_DIR,
    CRASH_RENAME, /* name, to */
    CRASH_LINK,   /* name, to */
    CRASH_UNLINK  /* name */
};

struct crash_op {
    uint32_t kind, len;
    uint64_t file; /* its inode: another's after it is gone */
    uint64_t at;
    char name[CRASH_NAME], to[CRASH_NAME];
};

#endif
