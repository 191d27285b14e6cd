/* flags.h -- the command line of the daemon. */
#ifndef SERVER_FLAGS_H
#define SERVER_FLAGS_H
#include <stdio.h>

struct options; /* options.h */

enum flags_outcome { FLAGS_RUN, FLAGS_CHECK, FLAGS_DONE, FLAGS_BAD };

/* flags_read(argc, argv, errors, out): the settings by the command line and what it
 * leaves to the file and the environment.  Writes no file.  Release out with
 * options_free() whatever it returns:
 * FLAGS_RUN; FLAGS_CHECK for --check-config when no problem was found up to here;
 * FLAGS_DONE when what --help, --version or --print-config asks for was printed to
 * stdout; FLAGS_BAD with a line on errors for each problem. */
enum flags_outcome flags_read(int argc, char **argv, FILE *errors, struct options *out);

#endif
