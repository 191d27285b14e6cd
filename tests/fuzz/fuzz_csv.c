/* Tables: for any bytes, every row has as many fields as the heading, and they are text; the
 * same bytes as a list without a heading. */
#define _GNU_SOURCE /* memfd_create */
#include "fuzz.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "csv.h"

static void read_table(const char *path, bool list, size_t size)
{
    struct errinfo e = {ST_OK, ""};
    struct csv *t;
    bool more = true;
    unsigned line = 0;
    enum status st = csv_open(path, list, &t, &e);

    require((st == ST_OK) == (t != NULL));
    require(list || st != ST_OK || csv_column(t, "file") < CSV_MAX_COLUMNS);
    while (st == ST_OK && (st = csv_next(t, &more, &e)) == ST_OK && more) {
        double x;

        require(csv_line(t) > line && csv_fields(t) >= 1);
        line = csv_line(t);
        for (int i = -1; i <= csv_fields(t); i++)
            require(strlen(csv_field(t, i)) <= size);
        require(csv_number(t, list ? 0 : csv_column(t, "yaw"), &x, &e) != ST_OK ||
                isfinite(x));
    }
    require(st == ST_OK || strncmp(e.msg, path, strlen(path)) == 0);
    csv_close(t);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const int fd = memfd_create("table", 0);
    char path[32];

    require(fd >= 0 && write(fd, data, size) == (ssize_t)size);
    (void)snprintf(path, sizeof path, "/proc/self/fd/%d", fd);
    read_table(path, false, size);
    read_table(path, true, size);
    (void)close(fd);
    return 0;
}
