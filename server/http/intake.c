#include "intake.h"

#include <sys/statvfs.h>

#include "app.h"
#include "errmap.h"
#include "request.h"

#define FULL_S 60 /* Retry-After, s, if the disk is full: the operator must make room */

bool intake_full(const char *db, size_t reserve, unsigned long long *left)
{
    struct statvfs fs;
    unsigned long long bytes;

    if (statvfs(db, &fs) != 0)
        return false; /* the database then reports the error */
    bytes = (unsigned long long)fs.f_bavail * fs.f_frsize;
    if (left != NULL)
        *left = bytes;
    return bytes < reserve;
}

bool intake_admit(struct request *r)
{
    const struct app *app = r->app;
    unsigned long long left;

    if (!intake_full(app->db, app->disk_reserve, &left))
        return true;
    request_problem(r, ERRMAP_STORAGE_FULL,
                    "%llu MB are free on the database's disk, and disk-reserve "
                    "keeps %zu MB for verifications: free some space",
                    left >> 20, app->disk_reserve >> 20);
    r->response.retry_after = FULL_S;
    return false;
}
