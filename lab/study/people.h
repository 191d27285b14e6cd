/* people.h -- the people whom the studies verify: a template of each, and the points of a
 * further scan, turned and moved. */
#ifndef STUDY_PEOPLE_H
#define STUDY_PEOPLE_H
#include <stddef.h>
#include <stdint.h>
#include "face.h"
#include "vec.h"

#define PEOPLE_POINTS 3000 /* of a made-up scan, at most */

struct person {
    char name[32]; /* of the subject; cut off */
    struct surface_face template;
    struct dvec3 *probe; /* [n], mm */
    size_t n;
};

/* people_made_up(first, n, w, p): sim/facegen.h's subjects from first on, into p[n]. */
void people_made_up(uint64_t first, size_t n, struct surface_work *w, struct person *p);

/* people_scanned(dir, kind, most, w, p): those of a folder's scans, by name, of which there
 * are both SUBJECT_enroll.ply and SUBJECT_KIND.ply; returns how many. */
size_t people_scanned(const char *dir, const char *kind, size_t most,
                      struct surface_work *w, struct person *p);

/* people_points(dir, name, n): the points of a scan's file, free(); NULL: it is not there, or
 * cannot be read. */
struct dvec3 *people_points(const char *dir, const char *name, size_t *n);

/* people_relatives(dir, p, n, relative): relative[i]: the number of p[i]'s close relative, or i,
 * by the folder's subjects.csv, if there is one: its first column a subject, its last one
 * whose relative that is.  Returns how many pairs there are. */
size_t people_relatives(const char *dir, const struct person *p, size_t n,
                        size_t *relative);

void people_free(struct person *p, size_t n); /* not p itself */

#endif
