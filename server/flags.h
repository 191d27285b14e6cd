/* flags.h -- the command line of the daemon. */
#ifndef SERVER_FLAGS_H
#define SERVER_FLAGS_H
#include <stdio.h>

struct options; /* options.h */

enum flags_outcome { FLAGS_RUN, FLAGS_CHECK, FLAGS_DONE, FLAGS_BAD };

/* flags_read(argc, argv, errors, out): Reads the settings from the command line, then from the environment and the
 * file.  Writes no file.  The caller releases out by options_free() in all cases.
 * FLAGS_RUN    the daemon is to run
 * FLAGS_CHECK  --check-config: no problem was found so far
 * FLAGS_DONE   --help, --version or --print-config: the text was printed to stdout
 * FLAGS_BAD    errors has a line for each problem */
enum flags_outcome flags_read(int argc, char **argv, FILE *errors, struct options *out);

#endif
