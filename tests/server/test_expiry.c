/* Tokens that will end within a month: each is told of at the start and then once a day, however
 * often they are looked at. */
#include <unistd.h>

#include "app.h"
#include "errinfo.h"
#include "expiry.h"
#include "metrics.h"
#include "store.h"
#include "tempdb.h"
#include "unit.h"

#define DAY_MS (86400.0 * 1e3)

static struct app app;
static struct errinfo e;

/* How many lines a look leaves in the log, and how many of them name the token. */
static int look(struct expiry *x, const char *name, int *named)
{
    FILE *log = tmpfile();
    const int saved = dup(STDERR_FILENO);
    char line[1000], wanted[100];
    int n = 0;

    assert_non_null(log);
    assert_true(saved >= 0 && dup2(fileno(log), STDERR_FILENO) >= 0);
    expiry_look(x, &app);
    assert_true(dup2(saved, STDERR_FILENO) >= 0);
    (void)close(saved);
    rewind(log);
    (void)snprintf(wanted, sizeof wanted, " name=%s ", name);
    for (*named = 0; fgets(line, sizeof line, log) != NULL; n++)
        *named += strstr(line, wanted) != NULL;
    (void)fclose(log);
    return n;
}

static void create(const char *name, int64_t life_s)
{
    struct store_token t;
    char secret[65];

    assert_int_equal(store_token_create(app.store, "test", name, STORE_SCOPE_VERIFY, "",
                                        tempdb_in(life_s), secret, &t, &e),
                     ST_OK);
}

TEST(test_daily)
{
    struct expiry x = {0};
    int named;

    app.store = tempdb_fresh();
    app.metrics = metrics_new(NULL, 0);
    assert_non_null(app.metrics);
    create("first", STORE_TOKEN_SOON_S - 60);
    create("second", 3600);
    create("lasting", 0);
    create("later", STORE_TOKEN_SOON_S + 60);
    assert_int_equal(look(&x, "first", &named), 2); /* at the start */
    assert_int_equal(named, 1);
    create("third", 7200);
    for (int hour = 1; hour < 24; hour++) {
        assert_int_equal(look(&x, "third", &named), 0);
        x.told_ms -= DAY_MS / 24;
    }
    x.told_ms -= DAY_MS / 24;
    assert_int_equal(look(&x, "third", &named), 3); /* a day after the start */
    assert_int_equal(named, 1);
    assert_int_equal(look(&x, "first", &named), 0);
    metrics_free(app.metrics);
    store_close(app.store);
}
