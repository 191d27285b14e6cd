/* corpus_read.h -- a corpus from a folder of scans or from a manifest.
 *
 * A folder of scans (by the endings of their names: cloudformat.h; no subfolders), named
 * SUBJECT_KIND.ply: the subject is what comes before the first underscore, the kind the
 * rest; neither may be empty.  Whatever else is in the folder is listed with the reason why
 * it is left out; names that begin with a dot are not looked at.  Or a manifest, a CSV file
 * (csv.h); a folder's manifest is index.csv.
 * Its columns, in any order:
 *   file                  the scan, relative to the manifest's folder
 *   subject, or else id   whose it is
 *   kind                  what it is, any word; optional
 *   population            non-mated pairs are of one population; optional
 * Other columns are ignored.  A file subjects.csv beside it is optional too: columns id and,
 * both optional, population and relative_of (a close relative's id).
 *
 * Of each subject one scan is enrolled: the first of kind `enroll`, or else the first one
 * (a folder's by name, a manifest's as they stand there).  All others are probes. */
#ifndef SCAN_CORPUS_READ_H
#define SCAN_CORPUS_READ_H
#include "errinfo.h"

struct corpus; /* corpus.h */

/* corpus_read(path, out, e): the scans of a folder or of a manifest.
 * out  new object, released by corpus_free(); NULL on error
 * Names are valid UTF-8 without control characters.  Every file is there and readable.
 * Returns ST_OK; ST_ENOTFOUND, ST_EIO a file or the folder; ST_EINVAL no scans, a malformed
 * table or name, a scan listed twice, a subject in two populations; ST_ELIMIT; ST_ENOMEM.
 * Messages say file, line and column. */
enum status corpus_read(const char *path, struct corpus **out, struct errinfo *e);

#endif
