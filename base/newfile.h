/* newfile.h -- a file that is there whole or not at all: it is written as PATH.part, readable
 * by its owner alone, and gets its name when it is on the disk. */
#ifndef DB_NEWFILE_H
#define DB_NEWFILE_H
#include "status.h"

struct errinfo;

struct newfile {
    int fd;     /* of the part; -1: there is none */
    char *path; /* NULL: there is none */
    char *part;
};

#define NEWFILE_NONE                                                                     \
    {                                                                                    \
        -1, NULL, NULL                                                                   \
    }

/* newfile_open(path, n, e): an empty PATH.part; what a process that was killed has left is
 * overwritten.  ST_EBUSY: another process writes it; ST_EIO, ST_ENOMEM.  After ST_OK
 * newfile_close() must follow. */
enum status newfile_open(const char *path, struct newfile *n, struct errinfo *e);

/* newfile_commit(n, e): bring it to the disk and give it its name; a file of that name is
 * replaced.  newfile_keep(n, e): ST_EEXISTS where there is one. */
enum status newfile_commit(struct newfile *n, struct errinfo *e);
enum status newfile_keep(struct newfile *n, struct errinfo *e);

/* newfile_close(n): the part is removed, where it has not got its name. */
void newfile_close(struct newfile *n);

/* newfile_sync_directory(path): the name of a new file is on the disk.  0, or -1 and errno.
 * newfile_open_directory(path): the folder of a file; or -1 and errno. */
int newfile_sync_directory(const char *path);
int newfile_open_directory(const char *path);

#endif
