/* gallery.h -- the people who may be found by a search, in memory: those with templates of this engine who are
 * neither disabled nor expired and have not opted out.
 * A gallery follows the change log: gallery_follow() makes it as new as a transaction of the store.  The caller
 * still reads each subject found in that transaction before it names somebody: what a gallery says of who
 * may be found is a hint.
 * Any number of threads.  Descriptors are biometric: they are wiped when their subject is gone. */
#ifndef SERVICE_GALLERY_H
#define SERVICE_GALLERY_H
#include <stddef.h>
#include <stdint.h>
#include "errinfo.h"
#include "libsurface.h"
#include "status.h"
#include "store_people.h"

struct gallery;

/* gallery_new(most): Creates an empty gallery.
 *   most  limit of its memory, bytes
 * Returns NULL: out of memory. */
struct gallery *gallery_new(size_t most);

/* gallery_free(g): Wipes and frees g; NULL is allowed. */
void gallery_free(struct gallery *g);

enum gallery_phase {
    GALLERY_LOADING, /* no gallery_follow() has succeeded yet */
    GALLERY_READY,
    GALLERY_FULL /* the descriptors need more memory than allowed: it stays empty */
};

/* gallery_phase(g): Returns the present phase. */
enum gallery_phase gallery_phase(const struct gallery *g);

/* gallery_follow(g, p, e): Makes g as new as p, or newer.  The first call reads all templates, later ones those of the
 * subjects that have changed since.
 * Cost: about 10 us a template at first.
 * Returns ST_OK; ST_ELIMIT: they would take more memory than g may have; ST_ENOMEM; or as store_people_all(). */
enum status gallery_follow(struct gallery *g, struct store_people *p, struct errinfo *e);

struct gallery_state {
    uint64_t subjects, templates; /* numbers of those in the gallery */
    size_t bytes;                 /* its memory */
};

/* gallery_state(g): Returns the state after the last gallery_follow(), without waiting. */
struct gallery_state gallery_state(struct gallery *g);

struct gallery_search {
    const struct surface_face *probe;
    const char *
        bound; /* groups of the token (groups.h): only their subjects are searched; "": all */
    const char *group; /* group that is searched; "": any */
    double floor;      /* least score of the first stage */
    size_t most;       /* most subjects wanted, 1 or more */
};

struct gallery_found {
    uint64_t searched; /* number of subjects searched */
    uint64_t skipped;  /* templates of these groups that could not be searched */
    size_t n;          /* number of subjects found, up to `most` */
    unsigned char (*uid)[STORE_UID]; /* their uids [n], the most alike first; owned */
};

/* gallery_count(g, bound, group, out, e): Sets searched and skipped of out to those of a search by a token bound to
 * these groups (struct gallery_search).
 * Returns ST_OK; ST_ENOMEM. */
enum status gallery_count(struct gallery *g, const char *bound, const char *group,
                          struct gallery_found *out, struct errinfo *e);

/* gallery_find(g, w, what, out, e): Finds the subjects most like a probe, by their best template each.
 *   out  to be released by gallery_found_free(), also after a failure
 * Cost: as surface_search().
 * Returns ST_OK; ST_EINVAL: too little of the probe is known; ST_ENOMEM. */
enum status gallery_find(struct gallery *g, struct surface_work *w,
                         const struct gallery_search *what, struct gallery_found *out,
                         struct errinfo *e);

/* gallery_found_free(f): Releases f->uid. */
void gallery_found_free(struct gallery_found *f);

#endif
