/* corpus_read.h -- a corpus from a folder of scans or from a manifest.
 *
 * A folder: scans (by the endings of their names: cloudformat.h; no subfolders) named SUBJECT_KIND.ply.  The
 * part before the first underscore is the subject, the rest the kind; neither is empty.  All other files of
 * the folder are listed with the reason why they are left out; names that begin with a dot are ignored.
 * A manifest: a CSV file (csv.h); a folder's manifest is index.csv.  Its columns, in any order:
 *   file                  the scan, relative to the manifest's folder
 *   subject, or else id   the subject's id
 *   kind                  any word; optional
 *   population            non-mated pairs are of one population; optional
 * Other columns are ignored.  A file subjects.csv in the same folder is optional too, with the columns id and,
 * both optional, population and relative_of (a close relative's id).
 *
 * One scan of each subject is enrolled: the first of kind `enroll`, or else the first one, by name or in
 * the manifest's order.  All others are probes. */
#ifndef SCAN_CORPUS_READ_H
#define SCAN_CORPUS_READ_H
#include "errinfo.h"

struct corpus; /* corpus.h */

/* corpus_read(path, out, e): Reads the list of scans of a folder or a manifest.  All its files exist and are
 * readable; its names are valid UTF-8 without control characters.
 *   out  a new object, to be released by corpus_free(); NULL on failure
 * Messages name file, line and column.
 * Returns ST_OK; ST_ENOTFOUND, ST_EIO: a file or the folder; ST_EINVAL: no scans, a malformed table or name, a
 * scan listed twice, a subject in two populations; ST_ELIMIT; ST_ENOMEM. */
enum status corpus_read(const char *path, struct corpus **out, struct errinfo *e);

#endif
