/* Who has the database open.  Every process that does holds a lock on one byte of PATH-shm as
 * long as it does (SQLite's unix VFS, "dead man's switch"): asking for it changes nothing. */
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "store_sqlite.h"

#define LOCK_AT 128

bool store_sqlite_in_use(const char *path, int64_t *pid)
{
    struct flock lock = {
        .l_type = F_WRLCK, .l_whence = SEEK_SET, .l_start = LOCK_AT, .l_len = 1};
    const size_t n = strlen(path) + sizeof "-shm";
    char *name = malloc(n);
    bool used = false;
    int fd;

    *pid = 0;
    if (name == NULL)
        return false;
    (void)snprintf(name, n, "%s-shm", path);
    if ((fd = open(name, O_RDONLY | O_CLOEXEC)) >= 0) {
        used = fcntl(fd, F_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
        if (used && lock.l_pid > 0)
            *pid = lock.l_pid;
        (void)close(fd);
    }
    free(name);
    return used;
}
