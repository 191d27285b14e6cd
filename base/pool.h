/* pool.h -- items of work on all cores, with a progress bar and the time left on standard error if that
 * is a terminal. */
#ifndef BASE_POOL_H
#define BASE_POOL_H
#include <stddef.h>
#include <stdint.h>
#include "status.h"

struct errinfo;
struct surface_work;
struct surface_model; /* libsurface.h */

/* Works on item i, on any thread; w belongs to that thread.  Fills *e on failure. */
typedef enum status pool_item(void *arg, size_t i, struct surface_work *w,
                              struct errinfo *e);

/* pool_run(what, threads, m, n, item, arg, e): Works on items 0..n-1, in about that order.
 *   what     name in the progress bar
 *   threads  number of threads; 0: one a core
 *   m        model of the threads' surface_work; NULL: the shipped model
 * Returns ST_OK, or the first failure, after which no further item begins. */
enum status pool_run(const char *what, uint32_t threads, const struct surface_model *m,
                     size_t n, pool_item *item, void *arg, struct errinfo *e);

/* pool_threads(wanted): Returns the number of threads that pool_run() uses at most. */
uint32_t pool_threads(uint32_t wanted);

#endif
