/* The store, used at once by several threads, its own too, and by other processes. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cmocka.h>
#include <sqlite3.h>

#include "errinfo.h"
#include "face.h"
#include "store.h"
#include "tempdb.h"

#define ROUNDS 40

static struct errinfo e;

static void *reader(void *arg)
{
    struct store *s = arg;
    struct face_work *w = face_work_new(NULL);
    struct face f = {0};
    struct errinfo why;
    intptr_t bad = w == NULL;

    for (int i = 0; i < ROUNDS && !bad; i++) {
        struct store_template *list, got;
        size_t n;
        enum status st = store_template_list(s, "alice", &list, &n, &why);

        if (st != ST_OK || n < 1)
            bad = 1;
        for (size_t k = 0; k < n && !bad; k++) {
            st = store_template_load(s, list[k].id, &got, w, &f, &why);
            if (st != ST_OK && st != ST_ENOTFOUND) /* deleted meanwhile */
                bad = 1;
        }
        free(list);
    }
    face_free(&f);
    face_work_free(w);
    return (void *)bad;
}

static void *writer(void *arg)
{
    struct store *s = arg;
    struct errinfo why;
    struct store_template t;
    intptr_t bad = 0;
    bool created;

    for (int i = 0; i < ROUNDS && !bad; i++)
        if (tempdb_store(s, "test", "alice", "", &tempdb_face[1 + i % 3], &t, &created,
                         &why) != ST_OK ||
            store_template_delete(s, "test", t.id, &why) != ST_OK)
            bad = 1;
    return (void *)bad;
}

static void test_threads(void **state)
{
    struct store *s = tempdb_fresh();
    struct store_template t;
    pthread_t thread[5];

    (void)state;
    tempdb_enroll(s, "alice", "", &tempdb_face[0], &t);
    for (int i = 0; i < 5; i++)
        assert_int_equal(pthread_create(&thread[i], NULL, i == 0 ? writer : reader, s),
                         0);
    for (int i = 0; i < 5; i++) {
        void *bad;

        assert_int_equal(pthread_join(thread[i], &bad), 0);
        assert_null(bad);
    }
    assert_int_equal(store_verify(s, NULL, NULL, &e), ST_OK);
    assert_int_equal(tempdb_number("SELECT count(*) FROM templates"), 1);
    store_close(s);
}

/* Another process adds and deletes while this one has the database open. */
static void test_processes(void **state)
{
    struct store *s = tempdb_fresh();
    struct store_template t, got;
    struct store_subject one;
    pid_t child;
    int status;

    (void)state;
    tempdb_enroll(s, "alice", "", &tempdb_face[0], &t);
    if ((child = fork()) == 0) {
        /* The parent's connections are not the child's to use: it opens its own. */
        struct store *mine;
        struct store_template u;
        struct errinfo why;
        bool created;

        _exit(store_open(tempdb_path, STORE_WRITE, NULL, &mine, &why) == ST_OK &&
                      tempdb_store(mine, "test", "bob", "", &tempdb_face[1], &u, &created,
                                   &why) == ST_OK &&
                      store_template_delete(mine, "test", t.id, &why) == ST_OK
                  ? 0
                  : 1);
    }
    assert_true(child > 0);
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    assert_int_equal(store_template_get(s, t.id, &got, &e), ST_ENOTFOUND);
    assert_int_equal(store_subject_get(s, "bob", &one, &e), ST_OK);
    assert_int_equal(one.templates, 1);
    tempdb_enroll(s, "bob", "", &tempdb_face[2], &t); /* and we can write after it */
    assert_int_equal(store_verify(s, NULL, NULL, &e), ST_OK);
    store_close(s);
}

/* Locked by another process for longer than we wait. */
static void test_locked(void **state)
{
    struct store *s = tempdb_fresh();
    struct store_template t, got, *list;
    sqlite3 *db;
    size_t n;
    bool created;

    (void)state;
    tempdb_enroll(s, "alice", "", &tempdb_face[0], &t);
    assert_int_equal(sqlite3_open(tempdb_path, &db), SQLITE_OK);
    assert_int_equal(sqlite3_exec(db, "BEGIN IMMEDIATE", NULL, NULL, NULL), SQLITE_OK);
    assert_int_equal(tempdb_store(s, "", "bob", "", &tempdb_face[1], &t, &created, &e),
                     ST_EBUSY);
    assert_int_equal(store_template_list(s, "alice", &list, &n, &e), ST_OK);
    assert_int_equal(n, 1);
    free(list);
    assert_int_equal(sqlite3_exec(db, "ROLLBACK", NULL, NULL, NULL), SQLITE_OK);
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
    assert_int_equal(tempdb_store(s, "", "bob", "", &tempdb_face[1], &got, &created, &e),
                     ST_OK);
    store_close(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_threads),
        cmocka_unit_test(test_processes),
        cmocka_unit_test(test_locked),
    };

    return cmocka_run_group_tests_name("store_threads", tests, tempdb_begin_faces,
                                       tempdb_end_faces);
}
