/* Templates that another process has erased leave the daemon's memory, although the store fails, is
 * busy or has no memory at any one call of a look.  The looks are called here, without their thread. */
/* link: -Wl,--wrap=every_start,--wrap=every_stop,--wrap=store_template_get */
/* link: -Wl,--wrap=sql_begin,--wrap=sql_query,--wrap=sql_first,--wrap=sql_next,--wrap=sql_done */
/* link: -Wl,--wrap=sql_end,--wrap=calloc,--wrap=malloc */
#include "app.h"
#include "cache.h"
#include "erasures.h"
#include "errinfo.h"
#include "every.h"
#include "fail_alloc.h"
#include "fail_sql.h"
#include "store.h"
#include "tempdb.h"
#include "unit.h"

#define ERASED 3 /* templates of the subject that is erased */

static struct app app;
static struct erasures *erasures;
static char erased[ERASED][STORE_ID_LEN + 1], lasting[STORE_ID_LEN + 1];
static struct errinfo e;

/* ---- the thread */

static void (*look)(void *arg);
static void *look_arg;

struct every *__wrap_every_start(const char *name, unsigned ms, void (*run)(void *arg),
                                 void *arg);
void __wrap_every_stop(struct every *x);

struct every *__wrap_every_start(const char *name, unsigned ms, void (*run)(void *arg),
                                 void *arg)
{
    (void)name;
    (void)ms;
    look = run;
    look_arg = arg;
    return (struct every *)&app; /* nothing looks at it */
}

void __wrap_every_stop(struct every *x)
{
    (void)x;
}

/* ---- a template about which the store never answers */

static const char *mute; /* its id; NULL: there is none */

enum status __real_store_template_get(struct store *s, const char *id,
                                      struct store_template *t, struct errinfo *x);
enum status __wrap_store_template_get(struct store *s, const char *id,
                                      struct store_template *t, struct errinfo *x);

enum status __wrap_store_template_get(struct store *s, const char *id,
                                      struct store_template *t, struct errinfo *x)
{
    return mute != NULL && strcmp(id, mute) == 0 ? ST_EDB
                                                 : __real_store_template_get(s, id, t, x);
}

/* ---- tests */

BEFORE_ALL(begin)
{
    app.store = tempdb_fresh();
    app.cache = cache_new((size_t)64 << 20);
    erasures = erasures_start(&app);
    assert_non_null(erasures);
}

AFTER_ALL(end)
{
    erasures_stop(erasures);
    cache_free(app.cache);
    store_close(app.store);
}

static void enroll(const char *subject, int face, char id[STORE_ID_LEN + 1])
{
    const uint64_t mark = cache_mark(app.cache);
    struct surface_face *f = NULL;
    struct store_template t;

    tempdb_enroll(app.store, subject, "", &tempdb_face[face], &t);
    memcpy(id, t.id, sizeof t.id);
    must(store_template_load(app.store, id, &t, tempdb_work, &f, &e));
    cache_release(app.cache, cache_keep(app.cache, mark, id, false, f));
}

static bool is_cached(const char *id)
{
    const struct cache_held *f = cache_find(app.cache, id);

    cache_release(app.cache, f);
    return f != NULL;
}

/* The subject was enrolled, every template of it is in the cache, and it is erased. */
static void enroll_and_erase(void)
{
    for (int i = 0; i < ERASED; i++)
        enroll("alice", i, erased[i]);
    look(look_arg);
    for (int i = 0; i < ERASED; i++)
        assert_true(is_cached(erased[i]));
    must(tempdb_erase(app.store, "test", "alice", &e));
}

static void expect_gone(enum status st, unsigned long n)
{
    for (int i = 0; i < ERASED; i++)
        if (is_cached(erased[i]))
            fail_msg("an erased template stays in memory: call %lu gave %s", n,
                     status_message(st));
}

TEST(test_erased)
{
    enroll("bob", ERASED, lasting);
    enroll_and_erase();
    look(look_arg);
    expect_gone(ST_OK, 0);
    assert_true(is_cached(lasting));
}

/* Returns how many calls a look makes. */
static unsigned long fail_each_call(enum status st)
{
    unsigned long n = 0, all;

    do {
        enroll_and_erase();
        fail_sql_at(++n, st);
        look(look_arg);
        all = fail_sql_count();
        fail_sql_at(0, ST_OK);
        look(look_arg);
        expect_gone(st, n);
    } while (all >= n);
    return all;
}

TEST(test_a_call_fails)
{
    static const enum status st[] = {ST_EBUSY, ST_EIO, ST_ENOMEM, ST_EDB};

    for (size_t i = 0; i < sizeof st / sizeof *st; i++)
        assert_true(fail_each_call(st[i]) > 10);
}

TEST(test_no_memory)
{
    unsigned long n = 0, all;

    do {
        enroll_and_erase();
        fail_alloc_at(++n);
        look(look_arg);
        all = fail_alloc_count();
        fail_alloc_at(0);
        look(look_arg);
        expect_gone(ST_ENOMEM, n);
    } while (all >= n);
    assert_true(all > 0);
}

/* It does not keep the others in memory, and is dropped itself. */
TEST(test_no_answer_ever)
{
    for (int i = 0; i < ERASED; i++) {
        enroll_and_erase();
        mute = erased[i];
        look(look_arg);
        look(look_arg);
        expect_gone(ST_EDB, 1);
        mute = NULL;
    }
}
