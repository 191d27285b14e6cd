/* The log has one line for each outage of the anchor, and one for each recovery.  The store is a
 * stub: it says what the test sets. */
/* link: -Wl,--wrap=store_anchor_fault,--wrap=store_refused */
#include <pthread.h>
#include <unistd.h>

#include "app.h"
#include "errinfo.h"
#include "refusal.h"
#include "store.h"
#include "unit.h"

static const char *fault, *refusal; /* reasons; NULL: none stands */

bool __wrap_store_anchor_fault(struct store *s, struct errinfo *e);
bool __wrap_store_refused(struct store *s, struct errinfo *e);

bool __wrap_store_anchor_fault(struct store *s, struct errinfo *e)
{
    (void)s;
    if (fault != NULL)
        (void)errinfo_set(e, ST_EIO, "%s", fault);
    return fault != NULL;
}

bool __wrap_store_refused(struct store *s, struct errinfo *e)
{
    (void)s;
    if (refusal != NULL)
        (void)errinfo_set(e, ST_EREFUSED, "%s", refusal);
    return refusal != NULL;
}

static void *tell(void *app)
{
    refusal_tell(app);
    return NULL;
}

/* What several threads leave in the log, from its message on. */
static const char *told(struct app *app)
{
    static char text[2000];
    FILE *log = tmpfile();
    const int saved = dup(STDERR_FILENO);
    pthread_t t[4];
    char line[500];

    assert_non_null(log);
    assert_true(saved >= 0 && dup2(fileno(log), STDERR_FILENO) >= 0);
    for (int i = 0; i < 4; i++)
        assert_int_equal(pthread_create(&t[i], NULL, tell, app), 0);
    for (int i = 0; i < 4; i++)
        (void)pthread_join(t[i], NULL);
    assert_true(dup2(saved, STDERR_FILENO) >= 0);
    (void)close(saved);
    rewind(log);
    text[0] = '\0';
    while (fgets(line, sizeof line, log) != NULL)
        (void)strncat(text, strstr(line, "level="), sizeof text - strlen(text) - 1);
    (void)fclose(log);
    return text;
}

TEST(test_anchor)
{
    struct app app = {.anchor_behind = false};

    assert_string_equal(told(&app), "");
    for (int outage = 0; outage < 3; outage++) {
        fault = "full";
        assert_string_equal(told(&app),
                            "level=warn msg=\"the database's anchor is not up "
                            "to date\" reason=full\n");
        assert_string_equal(told(&app), "");
        fault = NULL;
        assert_string_equal(
            told(&app), "level=info msg=\"the database's anchor is up to date again\"\n");
        assert_string_equal(told(&app), "");
    }
}

TEST(test_refusal)
{
    struct app app = {.anchor_behind = false};

    assert_string_equal(told(&app), "");
    refusal = "altered";
    assert_string_equal(told(&app),
                        "level=error msg=\"the database is refused until the daemon is "
                        "restarted\" reason=altered\n");
    assert_string_equal(told(&app), "");
    refusal = NULL;
}
