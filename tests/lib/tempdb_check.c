#include "tempdb_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "errinfo.h"

static void print_report(void *arg, const char *line)
{
    unsigned *lines = arg;

    print_message("  reported: %s\n", line);
    (*lines)++;
}

struct admin_check tempdb_check(struct store *s)
{
    struct admin_check found;
    struct errinfo e;
    unsigned lines = 0;

    if (admin_check(s, true, print_report, &lines, &found, &e) != ST_OK)
        fail_msg("%s", e.msg);
    assert_int_equal(lines, found.problems);
    return found;
}
