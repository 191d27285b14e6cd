/* skipped.h -- what of a folder is not read, counted by the endings of the names, and in one
 * line of text. */
#ifndef LEARN_SKIPPED_H
#define LEARN_SKIPPED_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define SKIPPED_ENDINGS 8 /* told of by name; further ones are counted together */

struct skipped { /* all zero: nothing */
    uint32_t folders, files;
    uint32_t n[SKIPPED_ENDINGS]; /* of files, by ending */
    char ending[SKIPPED_ENDINGS][16];
};

/* skipped_add(s, name, folder): count it. */
void skipped_add(struct skipped *s, const char *name, bool folder);

/* skipped_text(s, out, size): "3 files (.stl 2, .csv 1), 1 folder"; "" where s is all zero.  Cut
 * off if it is longer. */
void skipped_text(const struct skipped *s, char *out, size_t size);

#endif
