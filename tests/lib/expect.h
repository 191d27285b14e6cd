/* expect.h -- for cmocka tests of calls that return a status and say why: what each of them includes,
 * and two words.  They take the test's own `e`, the struct errinfo that the call writes. */
#ifndef TESTS_EXPECT_H
#define TESTS_EXPECT_H
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "errinfo.h"

/* must(call): it returns ST_OK; else its message is printed.
 * fails(call, code): it returns this code. */
#define must(call)                                                                       \
    do {                                                                                 \
        if ((call) != ST_OK)                                                             \
            fail_msg("%s", e.msg);                                                       \
    } while (0)
#define fails(call, code) assert_int_equal(call, code)

#endif
