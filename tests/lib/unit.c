#include "unit.h"

#define UNIT_TESTS 64

static struct CMUnitTest tests[UNIT_TESTS];
static size_t n;
static void (*hook[UNIT_HOOKS])(void);

static int run_hook(enum unit_hook which)
{
    if (hook[which] != NULL)
        hook[which]();
    return 0;
}

static int before_all(void **state)
{
    (void)state;
    return run_hook(UNIT_BEFORE_ALL);
}

static int after_all(void **state)
{
    (void)state;
    return run_hook(UNIT_AFTER_ALL);
}

static int before_each(void **state)
{
    (void)state;
    return run_hook(UNIT_BEFORE_EACH);
}

static int after_each(void **state)
{
    (void)state;
    return run_hook(UNIT_AFTER_EACH);
}

void unit_add_test(const char *name, void (*run)(void **))
{
    if (n == UNIT_TESTS)
        abort();
    tests[n++] = (struct CMUnitTest){name, run, before_each, after_each, NULL};
}

void unit_add_hook(enum unit_hook which, void (*run)(void))
{
    if (hook[which] != NULL)
        abort();
    hook[which] = run;
}

int main(int argc, char **argv)
{
    if (argc > 1)
        cmocka_set_test_filter(argv[1]);
    return _cmocka_run_group_tests(argv[0], tests, n, before_all, after_all);
}
