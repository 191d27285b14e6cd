/* pool.h -- items of work on all cores, with the progress on standard error where that
 * is a terminal. */
#ifndef BASE_POOL_H
#define BASE_POOL_H
#include <stddef.h>
#include <stdint.h>
#include "status.h"

struct errinfo;
struct surface_work;
struct surface_model; /* libsurface.h */

/* Works on item i; on any thread, w is that thread's own.  Fills *e on failure. */
typedef enum status pool_item(void *arg, size_t i, struct surface_work *w,
                              struct errinfo *e);

/* pool_run(what, threads, m, n, item, arg, e): work on items 0..n-1, in about that
 * order, on this many threads (0: one a core).
 * what  for the progress
 * m     that the threads' face_work is made for; NULL: model_default
 * Stops at the first failure, and returns it. */
enum status pool_run(const char *what, uint32_t threads, const struct surface_model *m,
                     size_t n, pool_item *item, void *arg, struct errinfo *e);

/* pool_threads(wanted): the most threads that pool_run() uses. */
uint32_t pool_threads(uint32_t wanted);

#endif
