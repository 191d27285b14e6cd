/* newfile.h -- a file that is there whole or not at all: it is written as PATH.part,
 * readable by its owner alone, and gets its name when it is on the disk.
 *
 * A rename has three outcomes.  ST_OK: done, and on the disk.  ST_EUNSYNCED: done, but the folder
 * could not be flushed, so that a loss of power may undo it: the caller removes nothing, neither the
 * new file nor what it stands for.  Any other status: not done. */
#ifndef BASE_NEWFILE_H
#define BASE_NEWFILE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include "status.h"

struct errinfo;

struct newfile {
    int fd;     /* descriptor of the part; -1: there is no part */
    int folder; /* descriptor of the file's folder, to flush the rename; -1: not open */
    char *path; /* name of the file; NULL: no file */
    char *part; /* name of the part */
};

#define NEWFILE_NONE                                                                     \
    {                                                                                    \
        -1, -1, NULL, NULL                                                               \
    }

/* newfile_open(path, n, e): Creates an empty PATH.part and opens the folder.  Removes a part that a
 * killed process of this user left.  After ST_OK the caller calls newfile_close() or newfile_leave().
 * ST_EBUSY: another process writes the part.  ST_EDENIED: the part may not be created, the folder may
 * not be opened, or the part's name is taken by a link, by another user's file, or by one that others
 * may read.  ST_EIO, ST_ENOMEM. */
enum status newfile_open(const char *path, struct newfile *n, struct errinfo *e);

/* newfile_put(n, data, len, e): Appends len bytes.  ST_EIO. */
enum status newfile_put(struct newfile *n, const void *data, size_t len,
                        struct errinfo *e);

/* newfile_fill(n, write, arg, e): Appends the output of write(to, arg, e), which need not check for
 * write errors.  Returns the status of write; ST_EIO: not everything could be written. */
typedef enum status newfile_writer(FILE *to, const void *arg, struct errinfo *e);
enum status newfile_fill(struct newfile *n, newfile_writer *write, const void *arg,
                         struct errinfo *e);

/* newfile_like(fd, path): Gives an open file the owner and group of the file at path, and its bits for
 * reading by the group, as far as this process may: root that replaces another user's file leaves it to
 * that user.  Does nothing if there is no file at path. */
void newfile_like(int fd, const char *path);

/* newfile_sync(n, e): Flushes the part's bytes to the disk.  ST_EIO, also if the part was removed or
 * replaced meanwhile. */
enum status newfile_sync(const struct newfile *n, struct errinfo *e);

/* newfile_commit(n, e): Flushes the part and gives it its name; replaces a file of that name.
 * ST_EUNSYNCED as above.  Not done: ST_EIO, ST_EDENIED. */
enum status newfile_commit(struct newfile *n, struct errinfo *e);

/* newfile_keep(n, e): Like newfile_commit(), but does not replace a file.  ST_EEXISTS: there is a file
 * of that name. */
enum status newfile_keep(struct newfile *n, struct errinfo *e);

/* newfile_close(n): Releases n, and removes a part that has not got its name. */
void newfile_close(struct newfile *n);

/* newfile_leave(n): Releases n, and leaves the part on the disk. */
void newfile_leave(struct newfile *n);

/* newfile_rename(from, to, e): Renames a file within its folder, on the disk; replaces nothing.
 * ST_EEXISTS: there is a file `to`.  ST_EUNSYNCED as above.  Not done: ST_EIO. */
enum status newfile_rename(const char *from, const char *to, struct errinfo *e);

/* newfile_beside(path, suffix, out, e): Sets *out to the name, with suffix appended, of the file that path
 * leads to through symbolic links; that need not exist.  *out is released by free().  ST_EIO: a link
 * cannot be read; ST_ENOMEM. */
enum status newfile_beside(const char *path, const char *suffix, char **out,
                           struct errinfo *e);

/* newfile_missing(path): Returns true if there is certainly no file at path, and false if there is one
 * or that cannot be found out. */
bool newfile_missing(const char *path);

/* newfile_open_directory(path): Returns the open folder of a file; -1 and errno on failure. */
int newfile_open_directory(const char *path);

/* newfile_sync_directory(folder): Flushes the names in an open folder.  Returns false and sets errno
 * if that fails. */
bool newfile_sync_directory(int folder);

#endif
