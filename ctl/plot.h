/* plot.h -- pictures by gnuplot, for surfacectl: started directly, never through a shell.
 * The script comes on its standard input with the data in it, the picture leaves on its
 * standard output ("set terminal pngcairo", and no "set output"): gnuplot opens no file,
 * and no file's name needs quoting. */
#ifndef CTL_PLOT_H
#define CTL_PLOT_H
#include <stdio.h>
#include "errinfo.h"

/* plot_run(out, script, arg, e): let gnuplot draw what script(to, arg) writes.
 * out     an open file descriptor that takes the picture; stays open
 * script  need not look at write errors
 * Returns ST_OK; ST_ENOTFOUND gnuplot is not installed; ST_EINVAL gnuplot refused the script
 * (e has its last line of complaint); ST_EIO it could not be started or ended by a signal.
 * On failure out may have been written to.  For a program with one thread: SIGPIPE is
 * ignored meanwhile. */
enum status plot_run(int out, void (*script)(FILE *to, const void *arg), const void *arg,
                     struct errinfo *e);

#endif
