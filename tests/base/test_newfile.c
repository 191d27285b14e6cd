/* link: -Wl,--wrap=malloc -Wl,--wrap=strdup -Wl,--wrap=fsync */
/* New files appear complete or not at all. */
#include <errno.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "errinfo.h"
#include "fail_alloc.h"
#include "newfile.h"
#include "unit.h"

int __real_fsync(int fd);
int __wrap_fsync(int fd);

static int synced;
static bool full;        /* fsync() fails: the disk is full */
static int folder_errno; /* fsync() of a folder fails so; 0: it does not */

int __wrap_fsync(int fd)
{
    struct stat sb;

    synced++;
    if (folder_errno != 0 && fstat(fd, &sb) == 0 && S_ISDIR(sb.st_mode)) {
        errno = folder_errno;
        return -1;
    }
    errno = ENOSPC;
    return full ? -1 : __real_fsync(fd);
}

static char folder[64];
static struct newfile n = NEWFILE_NONE;
static struct errinfo e;

static const char *in_folder(const char *name)
{
    static char path[128];

    (void)snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

BEFORE_EACH(begin)
{
    strcpy(folder, "/tmp/newfile.XXXXXX");
    assert_non_null(mkdtemp(folder));
    full = false;
    folder_errno = 0;
    synced = 0;
}

AFTER_EACH(end)
{
    (void)unlink(in_folder("x"));
    assert_int_equal(rmdir(folder), 0); /* no other file was left */
}

static void holds(const char *want)
{
    char text[64] = "";
    FILE *in = fopen(in_folder("x"), "r");

    assert_non_null(in);
    assert_int_equal(fread(text, 1, sizeof text - 1, in), strlen(want));
    (void)fclose(in);
    assert_string_equal(text, want);
}

static bool is_there(const char *name)
{
    return access(in_folder(name), F_OK) == 0;
}

TEST(test_commit)
{
    struct stat sb;

    (void)umask(0);
    assert_int_equal(newfile_open(in_folder("x"), &n, &e), ST_OK);
    assert_int_equal(newfile_put(&n, "one", 3, &e), ST_OK);
    assert_false(is_there("x"));
    assert_true(is_there("x.part"));
    assert_int_equal(newfile_commit(&n, &e), ST_OK);
    newfile_close(&n);
    newfile_close(&n);
    holds("one");
    assert_int_equal(synced, 2); /* the file and its name */
    assert_int_equal(stat(in_folder("x"), &sb), 0);
    assert_int_equal(sb.st_mode & 0777, 0600);
    assert_int_equal(newfile_open(in_folder("x"), &n, &e), ST_OK);
    assert_int_equal(newfile_put(&n, "two", 3, &e), ST_OK);
    holds("one");
    assert_int_equal(newfile_commit(&n, &e), ST_OK);
    newfile_close(&n);
    holds("two");
}

TEST(test_keep)
{
    for (int i = 0; i < 2; i++) {
        assert_int_equal(newfile_open(in_folder("x"), &n, &e), ST_OK);
        assert_int_equal(newfile_put(&n, i == 0 ? "old" : "new", 3, &e), ST_OK);
        assert_int_equal(newfile_keep(&n, &e), i == 0 ? ST_OK : ST_EEXISTS);
        newfile_close(&n);
        holds("old");
    }
}

/* Without a commit, or if it fails for lack of space, the old file stays. */
TEST(test_given_up)
{
    assert_int_equal(newfile_open(in_folder("x"), &n, &e), ST_OK);
    assert_int_equal(newfile_put(&n, "one", 3, &e), ST_OK);
    newfile_close(&n);
    assert_false(is_there("x"));
    full = true;
    assert_int_equal(newfile_open(in_folder("x"), &n, &e), ST_OK);
    assert_int_equal(newfile_commit(&n, &e), ST_EIO);
    assert_non_null(strstr(e.msg, strerror(ENOSPC)));
    assert_int_equal(newfile_keep(&n, &e), ST_EIO);
    newfile_close(&n);
    assert_false(is_there("x"));
}

/* A killed process's partial file is overwritten; one that is being written is ST_EBUSY. */
TEST(test_part)
{
    struct newfile other = NEWFILE_NONE;
    FILE *out = fopen(in_folder("x.part"), "w");

    assert_non_null(out);
    (void)fputs("much that was left", out);
    assert_int_equal(fchmod(fileno(out), 0600), 0);
    (void)fclose(out);
    assert_int_equal(newfile_open(in_folder("x"), &n, &e), ST_OK);
    assert_int_equal(newfile_open(in_folder("x"), &other, &e), ST_EBUSY);
    assert_int_equal(newfile_put(&n, "new", 3, &e), ST_OK);
    assert_int_equal(newfile_commit(&n, &e), ST_OK);
    newfile_close(&n);
    holds("new");
    assert_int_equal(newfile_open(in_folder("none/x"), &n, &e), ST_EIO);
}

/* A process that was killed between link() and unlink() has left two names of one file. */
TEST(test_two_names)
{
    char from[128];

    assert_int_equal(newfile_open(in_folder("x"), &n, &e), ST_OK);
    assert_int_equal(newfile_put(&n, "one", 3, &e), ST_OK);
    assert_int_equal(newfile_commit(&n, &e), ST_OK);
    newfile_close(&n);
    (void)snprintf(from, sizeof from, "%s", in_folder("x"));
    assert_int_equal(link(from, in_folder("x.part")), 0);
    assert_int_equal(newfile_open(in_folder("x"), &n, &e), ST_OK);
    assert_int_equal(newfile_put(&n, "two", 3, &e), ST_OK);
    holds("one");
    assert_int_equal(newfile_keep(&n, &e), ST_EEXISTS);
    newfile_close(&n);
    holds("one");
}

/* What others have put there is neither written into nor through, and stays. */
TEST(test_planted)
{
    struct stat before, after;
    FILE *out;

    for (int i = 0; i < 4; i++) {
        if (i < 2) { /* readable by others, or theirs */
            assert_non_null(out = fopen(in_folder("x.part"), "w"));
            assert_int_equal(fchmod(fileno(out), i == 0 ? 0644 : 0600), 0);
            (void)fclose(out);
            if (i == 1 && chown(in_folder("x.part"), 12345, (gid_t)-1) != 0) {
                assert_int_equal(unlink(in_folder("x.part")), 0);
                continue; /* only root can make such a file */
            }
        } else if (i == 2) {
            assert_int_equal(symlink("x", in_folder("x.part")), 0);
        } else {
            assert_int_equal(mkfifo(in_folder("x.part"), 0600), 0);
        }
        assert_int_equal(lstat(in_folder("x.part"), &before), 0);
        assert_int_equal(newfile_open(in_folder("x"), &n, &e), ST_EDENIED);
        assert_non_null(strstr(e.msg, "x.part exists and was not left by"));
        assert_int_equal(lstat(in_folder("x.part"), &after), 0);
        assert_true(before.st_ino == after.st_ino && before.st_size == after.st_size);
        assert_false(is_there("x"));
        assert_int_equal(unlink(in_folder("x.part")), 0);
    }
}

/* A file that takes the part's place while it is written never gets the name. */
TEST(test_replaced)
{
    enum status (*const finish[])(struct newfile *, struct errinfo *) = {newfile_commit,
                                                                         newfile_keep};

    for (size_t i = 0; i < 2; i++) {
        FILE *out;

        assert_int_equal(newfile_open(in_folder("x"), &n, &e), ST_OK);
        assert_int_equal(unlink(in_folder("x.part")), 0);
        assert_non_null(out = fopen(in_folder("x.part"), "w"));
        (void)fclose(out);
        assert_int_equal(finish[i](&n, &e), ST_EIO);
        newfile_close(&n);
        assert_false(is_there("x"));
        assert_true(is_there("x.part")); /* it is not ours to remove */
        assert_int_equal(unlink(in_folder("x.part")), 0);
    }
}

static enum status print(FILE *to, const void *arg, struct errinfo *why)
{
    (void)fputs(arg, to);
    return ((const char *)arg)[0] == 'b' ? errinfo_set(why, ST_ECORRUPT, "bad") : ST_OK;
}

TEST(test_fill)
{
    int fd;

    assert_int_equal(newfile_open(in_folder("x"), &n, &e), ST_OK);
    assert_int_equal(newfile_fill(&n, print, "bad", &e), ST_ECORRUPT);
    newfile_close(&n);
    assert_int_equal(newfile_open(in_folder("x"), &n, &e), ST_OK);
    assert_int_equal(newfile_fill(&n, print, "good", &e), ST_OK);
    assert_int_equal(newfile_commit(&n, &e), ST_OK);
    newfile_close(&n);
    holds("good");
    assert_int_equal(newfile_open(in_folder("x"), &n, &e), ST_OK);
    fd = n.fd;
    assert_true((n.fd = open("/dev/full", O_WRONLY)) >= 0);
    assert_int_equal(newfile_fill(&n, print, "good", &e), ST_EIO);
    assert_int_equal(newfile_put(&n, "good", 4, &e), ST_EIO);
    (void)close(n.fd);
    n.fd = fd;
    newfile_close(&n);
    holds("good");
}

TEST(test_memory)
{
    unsigned long failing;
    enum status st;

    for (failing = 1;; failing++) {
        fail_alloc_at(failing);
        if ((st = newfile_open(in_folder("x"), &n, &e)) == ST_OK)
            break;
        assert_int_equal(st, ST_ENOMEM);
        assert_false(is_there("x.part"));
    }
    assert_int_equal(failing, 3);
    fail_alloc_at(0);
    newfile_close(&n);
}

/* What was renamed is there, and nobody removes it, also if its folder could not be flushed. */
TEST(test_unsynced)
{
    char other[128];

    for (int way = 0; way < 3; way++) {
        must(newfile_open(in_folder("x"), &n, &e));
        must(newfile_put(&n, "good", 4, &e));
        folder_errno = EIO;
        fails(way == 0 ? newfile_keep(&n, &e) : newfile_commit(&n, &e), ST_EUNSYNCED);
        newfile_close(&n);
        holds("good");
        assert_false(is_there("x.part"));
        folder_errno = 0;
    }
    (void)snprintf(other, sizeof other, "%s/y", folder);
    folder_errno = EIO;
    fails(newfile_rename(in_folder("x"), other, &e), ST_EUNSYNCED);
    assert_false(is_there("x"));
    folder_errno = EINVAL; /* a file system that has no such flush */
    must(newfile_rename(other, in_folder("x"), &e));
    holds("good");
    must(newfile_open(other, &n, &e));
    must(newfile_keep(&n, &e));
    newfile_close(&n);
    fails(newfile_rename(other, in_folder("x"), &e), ST_EEXISTS);
    holds("good");
    assert_int_equal(unlink(other), 0);
    fails(newfile_rename(other, in_folder("z"), &e), ST_EIO);

    must(newfile_open(in_folder("x"), &n, &e));
    newfile_leave(&n);
    assert_true(is_there("x.part"));
    assert_int_equal(unlink(in_folder("x.part")), 0);
}

static void assert_beside(const char *path, const char *wanted)
{
    char *name;

    must(newfile_beside(in_folder(path), ".new", &name, &e));
    assert_string_equal(name, wanted);
    free(name);
}

/* Names are beside the file that links lead to, whether that is there or not. */
TEST(test_beside)
{
    char wanted[128], target[128];
    char *name;

    (void)snprintf(wanted, sizeof wanted, "%s.new", in_folder("x"));
    assert_beside("x", wanted); /* no file */
    assert_int_equal(symlink("x", in_folder("relative")), 0);
    assert_beside("relative", wanted); /* to no file */
    (void)snprintf(target, sizeof target, "%s", in_folder("relative"));
    assert_int_equal(symlink(target, in_folder("absolute")), 0);
    assert_beside("absolute", wanted);
    assert_int_equal(symlink("loop", in_folder("loop")), 0);
    fails(newfile_beside(in_folder("loop"), "", &name, &e), ST_EIO);
    assert_int_equal(unlink(in_folder("relative")), 0);
    assert_int_equal(unlink(in_folder("absolute")), 0);
    assert_int_equal(unlink(in_folder("loop")), 0);
    must(newfile_beside("postgresql://user@host/name", "", &name, &e));
    assert_string_equal(name, "postgresql://user@host/name");
    free(name);
}
