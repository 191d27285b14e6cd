#define _GNU_SOURCE /* F_OFD_SETLK */
#include "anchor.h"

#include <errno.h>
#include <fcntl.h>
#include <sodium.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

#include "bytes.h"
#include "errinfo.h"
#include "newfile.h"

/* A place is less than a sector, which disks write whole, and in a block of its own. */
#define PLACES 2
#define STEP   4096
#define WORD   16
#define SAID   (WORD + 8 + 8 + 8 + 8 + STORE_CHAIN_HASH + VAULT_KEY)
#define PLACE  (SAID + VAULT_HASH)

#define FLAG_NEXT   1u
#define FLAG_SERVED 2u

static const char word[WORD] = "surface anchor1";

struct place {
    /* of the times that something was said; 0: nothing of this database */
    uint64_t number;
    uint64_t flags;
    struct anchor_end end;
};

struct file {
    int fd;
    const char *path;
    struct place place[PLACES];
    int top; /* the place that was written last */
};

static enum status fail(const char *what, const char *path, struct errinfo *e)
{
    return errinfo_set(e, errno == ENOENT ? ST_ENOTFOUND : ST_EIO,
                       "cannot %s the anchor %.300s: %s", what, path, strerror(errno));
}

static void encode(const struct vault *v, const struct place *p, unsigned char out[PLACE])
{
    unsigned char public[VAULT_KEY], *to = out;

    vault_public(v, public);
    bytes_put(&to, word, WORD);
    bytes_put_number(&to, p->number, 8);
    bytes_put_number(&to, p->flags, 8);
    bytes_put_number(&to, p->end.seq, 8);
    bytes_put_number(&to, p->end.uses, 8);
    bytes_put(&to, p->end.hash, sizeof p->end.hash);
    bytes_put(&to, public, sizeof public);
    vault_mac(v, out, SAID, to);
}

static void decode(const struct vault *v, const unsigned char in[PLACE], struct place *p)
{
    unsigned char mac[VAULT_HASH];

    memset(p, 0, sizeof *p);
    vault_mac(v, in, SAID, mac);
    if (memcmp(in, word, WORD) != 0 || sodium_memcmp(mac, in + SAID, sizeof mac) != 0)
        return;
    p->number = bytes_number(in + WORD, 8);
    p->flags = bytes_number(in + WORD + 8, 8);
    p->end.seq = bytes_number(in + WORD + 16, 8);
    p->end.uses = bytes_number(in + WORD + 24, 8);
    memcpy(p->end.hash, in + WORD + 32, sizeof p->end.hash);
}

static bool lock(int fd, int how)
{
    int rc;

    do
        rc = flock(fd, how);
    while (rc != 0 && errno == EINTR);
    return rc == 0;
}

/* The file, locked until it is closed, and what it says. */
static enum status open_file(const char *path, const struct vault *v, int flags,
                             struct file *f, struct errinfo *e)
{
    unsigned char in[PLACE];

    *f = (struct file){.path = path};
    if ((f->fd = open(path, flags | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK)) < 0)
        return fail("open", path, e);
    if (!lock(f->fd, flags == O_RDONLY ? LOCK_SH : LOCK_EX)) {
        const enum status st = fail("lock", path, e);

        (void)close(f->fd);
        return st;
    }
    for (int i = 0; i < PLACES; i++)
        if (pread(f->fd, in, sizeof in, (off_t)i * STEP) == (ssize_t)sizeof in)
            decode(v, in, &f->place[i]);
    f->top = f->place[1].number > f->place[0].number ? 1 : 0;
    return ST_OK;
}

static enum status close_file(struct file *f, enum status st)
{
    (void)close(f->fd);
    return st;
}

/* Into the place that is not in force, which is so no more. */
static enum status say(struct file *f, const struct vault *v, uint64_t flags,
                       const struct anchor_end *end, struct errinfo *e)
{
    const int to = f->place[f->top].number > 0 ? 1 - f->top : 0;
    const struct place p = {f->place[f->top].number + 1, flags, *end};
    unsigned char out[PLACE];

    encode(v, &p, out);
    if (pwrite(f->fd, out, sizeof out, (off_t)to * STEP) != (ssize_t)sizeof out)
        return fail("write", f->path, e);
    f->place[f->top = to] = p;
    return ST_OK;
}

static enum status flush(const struct file *f, struct errinfo *e)
{
    return fdatasync(f->fd) == 0 ? ST_OK : fail("flush", f->path, e);
}

static enum status make(const char *path, struct errinfo *e)
{
    static const unsigned char none[PLACES * STEP];
    struct newfile n = NEWFILE_NONE;
    enum status st;

    if ((st = newfile_open(path, &n, e)) == ST_OK &&
        (st = newfile_put(&n, none, sizeof none, e)) == ST_OK &&
        (st = newfile_keep(&n, e)) == ST_EEXISTS)
        st = ST_OK; /* by another process */
    newfile_close(&n);
    return st;
}

/* The same, made where it is missing. */
static enum status open_or_make(const char *path, const struct vault *v, struct file *f,
                                struct errinfo *e)
{
    enum status st = open_file(path, v, O_RDWR, f, e);

    if (st == ST_ENOTFOUND && (st = make(path, e)) == ST_OK)
        st = open_file(path, v, O_RDWR, f, e);
    return st;
}

/* ---- */

enum status anchor_read(const char *path, const struct vault *v, struct anchor *out,
                        struct errinfo *e)
{
    const struct place *top, *other;
    struct file f;
    enum status st;

    memset(out, 0, sizeof *out);
    if ((st = open_file(path, v, O_RDONLY, &f, e)) != ST_OK)
        return st;
    top = &f.place[f.top];
    other = &f.place[1 - f.top];
    if (top->number == 0)
        return close_file(
            &f, errinfo_set(e, ST_EREFUSED,
                            "the anchor %.300s is damaged, or another database's", path));
    out->served = (top->flags & FLAG_SERVED) != 0;
    if ((out->announced = (top->flags & FLAG_NEXT) != 0)) {
        out->next = top->end;
        top = other;
    }
    if ((out->said = top->number > 0 && (top->flags & FLAG_NEXT) == 0))
        out->last = top->end;
    return close_file(&f, ST_OK);
}

enum status anchor_advance(const char *path, const struct vault *v,
                           const struct anchor_end *end, struct errinfo *e)
{
    const struct place *top;
    struct file f;
    enum status st;

    if ((st = open_file(path, v, O_RDWR, &f, e)) != ST_OK)
        return st;
    top = &f.place[f.top];
    if (top->number > 0 && ((top->flags & FLAG_NEXT) != 0 || end->seq <= top->end.seq))
        return close_file(&f, ST_OK);
    return close_file(&f, say(&f, v, top->flags & FLAG_SERVED, end, e));
}

enum status anchor_set(const char *path, const struct vault *v,
                       const struct anchor_end *end, bool served, struct errinfo *e)
{
    struct file f;
    enum status st;

    if ((st = open_or_make(path, v, &f, e)) != ST_OK)
        return st;
    if ((st = say(&f, v, served ? FLAG_SERVED : 0, end, e)) == ST_OK)
        st = flush(&f, e);
    return close_file(&f, st);
}

enum status anchor_mark(const char *path, const struct vault *v, bool served,
                        struct errinfo *e)
{
    const struct place *top;
    struct file f;
    enum status st;

    if ((st = open_file(path, v, O_RDWR, &f, e)) != ST_OK)
        return st;
    top = &f.place[f.top];
    if (top->number > 0 && (top->flags & FLAG_NEXT) == 0) {
        const struct anchor_end end = top->end;

        if ((st = say(&f, v, served ? FLAG_SERVED : 0, &end, e)) == ST_OK)
            st = flush(&f, e);
    }
    return close_file(&f, st);
}

/* What is in force must not be overwritten: it is said again first where it is only announced
 * itself, as by a restore that was killed. */
enum status anchor_announce(const char *path, const struct vault *v,
                            const struct anchor_end *next, struct errinfo *e)
{
    const struct place *top;
    struct file f;
    enum status st;

    if ((st = open_or_make(path, v, &f, e)) != ST_OK)
        return st;
    top = &f.place[f.top];
    if ((top->flags & FLAG_NEXT) != 0 && f.place[1 - f.top].number > 0)
        f.top = 1 - f.top; /* that one's next is announced no more */
    if ((st = say(&f, v, FLAG_NEXT | (f.place[f.top].flags & FLAG_SERVED), next, e)) ==
        ST_OK)
        st = flush(&f, e);
    return close_file(&f, st);
}

bool anchor_used(const char *path)
{
    unsigned char in[PLACE];
    const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    bool used = fd < 0 && errno != ENOENT;

    for (int i = 0; i < PLACES && fd >= 0; i++) {
        const ssize_t got = pread(fd, in, sizeof in, (off_t)i * STEP);

        used = used || got < 0 || /* it is no file */
               (got == (ssize_t)sizeof in && memcmp(in, word, WORD) == 0 &&
                (bytes_number(in + WORD + 8, 8) & FLAG_NEXT) == 0);
    }
    if (fd >= 0)
        (void)close(fd);
    return used;
}

/* ---- daemons */

static bool claim(int fd, short how)
{
    struct flock l = {.l_type = how, .l_whence = SEEK_SET, .l_start = 0, .l_len = 1};

    return fcntl(fd, F_OFD_SETLK, &l) == 0;
}

int anchor_serve(const char *path, bool *alone, struct errinfo *e)
{
    const int fd = open(path, O_RDWR | O_CLOEXEC | O_NOFOLLOW);

    *alone = false;
    if (fd < 0) {
        (void)fail("open", path, e);
        return -1;
    }
    *alone = claim(fd, F_WRLCK);
    if (!claim(fd, F_RDLCK)) {
        (void)fail("lock", path, e);
        (void)close(fd);
        return -1;
    }
    return fd;
}

bool anchor_serves_alone(int fd)
{
    return claim(fd, F_WRLCK);
}
