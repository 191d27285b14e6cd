/* newfile.h -- a file that is there whole or not at all: it is written as PATH.part,
 * readable by its owner alone, and gets its name when it is on the disk. */
#ifndef BASE_NEWFILE_H
#define BASE_NEWFILE_H
#include <stddef.h>
#include <stdio.h>
#include "status.h"

struct errinfo;

struct newfile {
    int fd;     /* of the part; -1: there is none */
    int dir;    /* that the names are relative to */
    char *path; /* NULL: there is none */
    char *part;
};

#define NEWFILE_NONE                                                                     \
    {                                                                                    \
        -1, -1, NULL, NULL                                                               \
    }

/* newfile_open(path, n, e): a new and empty PATH.part; what a process of this user that was
 * killed has left is removed.  ST_EBUSY: another process writes it; ST_EDENIED: it may not be
 * made, or something else has that name: a link, another user's file, one that others may
 * read; ST_EIO, ST_ENOMEM.
 * After ST_OK newfile_close() must follow.
 * newfile_open_at(dir, name, n, e): in an open folder, which is borrowed until then. */
enum status newfile_open(const char *path, struct newfile *n, struct errinfo *e);
enum status newfile_open_at(int dir, const char *name, struct newfile *n,
                            struct errinfo *e);

/* newfile_put(n, data, len, e): len bytes more.  ST_EIO. */
enum status newfile_put(struct newfile *n, const void *data, size_t len,
                        struct errinfo *e);

/* newfile_fill(n, write, arg, e): what write(to, arg, e) prints; it need not check for
 * write errors.  Returns its status; ST_EIO where not everything could be written. */
typedef enum status newfile_writer(FILE *to, const void *arg, struct errinfo *e);
enum status newfile_fill(struct newfile *n, newfile_writer *write, const void *arg,
                         struct errinfo *e);

/* newfile_commit(n, e): sync the part and give it its name; a file of that name is
 * replaced.  ST_EIO, also where the part was removed or replaced in the meantime.
 * newfile_keep(n, e): the same, but ST_EEXISTS where there is a file of that name. */
enum status newfile_commit(struct newfile *n, struct errinfo *e);
enum status newfile_keep(struct newfile *n, struct errinfo *e);

/* newfile_close(n): release n; a part that was not committed or kept is removed. */
void newfile_close(struct newfile *n);

/* newfile_sync_directory(path): sync the folder of a file, so that its name is on the
 * disk.
 * newfile_open_directory(path): the open folder of a file.  Both: -1 and errno on
 * failure. */
int newfile_sync_directory(const char *path);
int newfile_open_directory(const char *path);

#endif
