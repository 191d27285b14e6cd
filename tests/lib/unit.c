#include "unit.h"

#define UNIT_TESTS 64

static struct CMUnitTest tests[UNIT_TESTS];
static size_t n;
static void (*hook[UNIT_HOOKS][2])(void); /* of a fixture, then of the test */

static int before(enum unit_hook which)
{
    for (int i = 0; i < 2; i++)
        if (hook[which][i] != NULL)
            hook[which][i]();
    return 0;
}

static int after(enum unit_hook which)
{
    for (int i = 1; i >= 0; i--)
        if (hook[which][i] != NULL)
            hook[which][i]();
    return 0;
}

static int before_all(void **state)
{
    (void)state;
    return before(UNIT_BEFORE_ALL);
}

static int after_all(void **state)
{
    (void)state;
    return after(UNIT_AFTER_ALL);
}

static int before_each(void **state)
{
    (void)state;
    return before(UNIT_BEFORE_EACH);
}

static int after_each(void **state)
{
    (void)state;
    return after(UNIT_AFTER_EACH);
}

void unit_add_test(const char *name, void (*run)(void **))
{
    if (n == UNIT_TESTS)
        abort();
    tests[n++] = (struct CMUnitTest){name, run, before_each, after_each, NULL};
}

void unit_add_hook(enum unit_hook which, void (*run)(void))
{
    const int i = hook[which][0] != NULL;

    if (hook[which][i] != NULL)
        abort();
    hook[which][i] = run;
}

int main(int argc, char **argv)
{
    if (argc > 1)
        cmocka_set_test_filter(argv[1]);
    return _cmocka_run_group_tests(argv[0], tests, n, before_all, after_all);
}
