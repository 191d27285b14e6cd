/* unit.h -- the frame of a unit test.  Its cases and hooks register themselves, and main() in
 * unit.c runs the cases in the order of the file, or those whose names match its argument.
 *
 *     TEST(test_name)
 *     {
 *         assert_true(1 < 2);
 *     }
 *
 * BEFORE_ALL, AFTER_ALL, BEFORE_EACH and AFTER_EACH are written like TEST: a file has at most
 * one of each.  The header includes what cmocka.h and most tests need. */
#ifndef TESTS_UNIT_H
#define TESTS_UNIT_H
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

/* must(call), fails(call, code): Fail the test unless the call returns ST_OK, or this code.  Its
 * message is in the test's own `e`, a struct errinfo. */
#define must(call)                                                                       \
    do {                                                                                 \
        if ((call) != ST_OK)                                                             \
            fail_msg("%s", e.msg);                                                       \
    } while (0)
#define fails(call, code) assert_int_equal(call, code)

enum unit_hook {
    UNIT_BEFORE_ALL,
    UNIT_AFTER_ALL,
    UNIT_BEFORE_EACH,
    UNIT_AFTER_EACH,
    UNIT_HOOKS
};

/* Called before main(), by the macros and by fixtures of tests/lib, whose hooks run before those of
 * the test, and after them at the end. */
void unit_add_test(const char *name, void (*run)(void **));
void unit_add_hook(enum unit_hook which, void (*run)(void));

#define TEST(name)                                                                       \
    static void name(void **);                                                           \
    __attribute__((constructor)) static void name##_register(void)                       \
    {                                                                                    \
        unit_add_test(#name, name);                                                      \
    }                                                                                    \
    static void name(void **unit_state __attribute__((unused)))

#define UNIT_HOOK(which, name)                                                           \
    static void name(void);                                                              \
    __attribute__((constructor)) static void name##_register(void)                       \
    {                                                                                    \
        unit_add_hook(which, name);                                                      \
    }                                                                                    \
    static void name(void)

#define BEFORE_ALL(name)  UNIT_HOOK(UNIT_BEFORE_ALL, name)
#define AFTER_ALL(name)   UNIT_HOOK(UNIT_AFTER_ALL, name)
#define BEFORE_EACH(name) UNIT_HOOK(UNIT_BEFORE_EACH, name)
#define AFTER_EACH(name)  UNIT_HOOK(UNIT_AFTER_EACH, name)

#endif
