/* ctl_enroll_folder.h -- enrolling a folder or a table of scans (corpus.h): on all cores;
 * done again, it goes on where it was. */
#ifndef CTL_ENROLL_FOLDER_H
#define CTL_ENROLL_FOLDER_H
#include <stdbool.h>
#include "status.h"

struct ctl; /* ctl.h */

/* ctl_enroll_folder(c, kind, force): the collection c->args[0]; of one kind of scans, or all
 * (NULL).  Fills c->e on failure. */
enum status ctl_enroll_folder(struct ctl *c, const char *kind, bool force);

#endif
