/* Tables: for any bytes, every row has as many fields as the heading, and they are text; the
 * same bytes as a list without a heading. */
#include "fuzz.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "csv.h"

static void read_list(const uint8_t *data, size_t size)
{
    struct errinfo e = {ST_OK, ""};
    struct csv *t;
    bool more = true;
    unsigned line = 0;
    enum status st = csv_read(data, size, "t.csv", true, &t, &e);

    while (st == ST_OK && (st = csv_next(t, &more, &e)) == ST_OK && more) {
        if (csv_line(t) <= line || csv_fields(t) < 1)
            abort();
        line = csv_line(t);
        for (int i = 0; i <= csv_fields(t); i++)
            if (strlen(csv_field(t, i)) > size)
                abort();
    }
    if (st != ST_OK && strncmp(e.msg, "t.csv", 5) != 0)
        abort();
    csv_close(t);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct errinfo e = {ST_OK, ""};
    struct csv *t;
    bool more = true;
    enum status st = csv_read(data, size, "t.csv", false, &t, &e);

    if ((st == ST_OK) != (t != NULL))
        abort();
    if (st == ST_OK && csv_column(t, "file") >= CSV_MAX_COLUMNS)
        abort();
    while (st == ST_OK && (st = csv_next(t, &more, &e)) == ST_OK && more) {
        const int column = csv_column(t, "yaw");
        double x;

        if (strlen(csv_field(t, csv_column(t, "file"))) > size)
            abort();
        if (csv_number(t, column, &x, &e) == ST_OK && !isfinite(x))
            abort();
    }
    if (st != ST_OK && strncmp(e.msg, "t.csv", 5) != 0)
        abort();
    csv_close(t);
    read_list(data, size);
    return 0;
}
