#include "crash.h"

#include <dirent.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "brute.h"

#define FILES_MAX  64 /* of a log, at any time */
#define NAMES_MAX  32 /* of a folder */
#define BYTES_MAX  (64 << 20)
#define SECTOR     512
#define NEVER      SIZE_MAX
#define CANNOT(at) (perror(at), exit(2))

struct bytes {
    unsigned char *at;
    size_t n, room;
};

struct change {
    struct crash_op op;
    size_t data;  /* where its bytes are in the log */
    size_t file;  /* of crash_log.file */
    size_t until; /* the sync that covers this one, or NEVER */
};

struct name {
    char text[CRASH_NAME];
    size_t file;
};

struct crash_log {
    struct bytes text; /* of the log */
    struct change *change;
    size_t n;
    struct bytes file[FILES_MAX]; /* as they were before, and then new ones */
    uint64_t inode[FILES_MAX];
    size_t files;
    struct name name[NAMES_MAX]; /* before */
    size_t names;
};

/* ---- files and folders */

void crash_join(char out[CRASH_PATH], const char *dir, const char *name)
{
    if (snprintf(out, CRASH_PATH, "%s/%s", dir, name) >= CRASH_PATH) {
        (void)fprintf(stderr, "%s/%s: too long\n", dir, name);
        exit(2);
    }
}

static void resize(struct bytes *b, size_t n)
{
    if (n > BYTES_MAX) {
        (void)fprintf(stderr, "a file of %zu bytes\n", n);
        exit(2);
    }
    if (n > b->room) {
        b->room = 2 * n;
        if ((b->at = realloc(b->at, b->room)) == NULL)
            CANNOT("realloc");
    }
    if (n > b->n)
        memset(b->at + b->n, 0, n - b->n);
    b->n = n;
}

static void read_file(const char *path, struct bytes *out)
{
    struct stat sb;
    FILE *f = fopen(path, "rb");

    if (f == NULL || fstat(fileno(f), &sb) != 0)
        CANNOT(path);
    resize(out, (size_t)sb.st_size);
    if (out->n > 0 && fread(out->at, 1, out->n, f) != out->n)
        CANNOT(path);
    (void)fclose(f);
}

static void write_file(const char *path, const struct bytes *b)
{
    FILE *f;
    const mode_t mask = umask(077); /* a key's file is its owner's */

    if ((f = fopen(path, "wb")) == NULL || fwrite(b->at, 1, b->n, f) != b->n ||
        fclose(f) != 0)
        CANNOT(path);
    (void)umask(mask);
}

typedef void use_file(void *arg, const char *path, const char *name);

static void each(const char *dir, use_file *use, void *arg)
{
    char path[CRASH_PATH];
    struct dirent *entry;
    DIR *d = opendir(dir);

    if (d == NULL)
        CANNOT(dir);
    while ((entry = readdir(d)) != NULL)
        if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0) {
            crash_join(path, dir, entry->d_name);
            use(arg, path, entry->d_name);
        }
    (void)closedir(d);
}

/* Runs "FORMAT", in which the %s are folders. */
__attribute__((format(printf, 1, 2))) static void shell(const char *format, ...)
{
    char text[3 * CRASH_PATH];
    va_list args;

    va_start(args, format);
    (void)vsnprintf(text, sizeof text, format, args);
    va_end(args);
    if (system(text) != 0)
        CANNOT(text);
}

void crash_remove(const char *dir)
{
    shell("rm -rf '%s'", dir);
}

void crash_copy(const char *from, const char *to)
{
    shell("rm -rf '%s' && cp -rp '%s' '%s'", to, from, to);
}

/* ---- the log */

static size_t new_file(struct crash_log *l, uint64_t inode)
{
    if (l->files == FILES_MAX) {
        (void)fprintf(stderr, "more than %d files\n", FILES_MAX);
        exit(2);
    }
    l->inode[l->files] = inode;
    return l->files++;
}

static void see_file(void *arg, const char *path, const char *name)
{
    struct crash_log *l = arg;
    struct name *to = &l->name[l->names];
    struct stat sb;

    if (stat(path, &sb) != 0 || l->names == NAMES_MAX)
        CANNOT(path);
    (void)snprintf(to->text, sizeof to->text, "%s", name);
    to->file = new_file(l, sb.st_ino);
    read_file(path, &l->file[to->file]);
    l->names++;
}

struct crash_log *crash_log_new(const char *dir)
{
    struct crash_log *l = calloc(1, sizeof *l);

    if (l == NULL)
        CANNOT("calloc");
    each(dir, see_file, l);
    return l;
}

/* The file that has the inode now: the newest. */
static size_t file_of(const struct crash_log *l, uint64_t inode)
{
    for (size_t i = l->files; i-- > 0;)
        if (l->inode[i] == inode)
            return i;
    (void)fprintf(stderr, "a change of a file that is not known\n");
    exit(2);
}

static bool is_name(const struct change *c)
{
    return c->op.kind == CRASH_CREATE || c->op.kind == CRASH_RENAME ||
           c->op.kind == CRASH_LINK || c->op.kind == CRASH_UNLINK;
}

/* The n-th change, a sync, covers all changes before it of the same file or folder. */
static void waited(struct crash_log *l, size_t n)
{
    const struct change *c = &l->change[n];

    for (size_t i = n; i-- > 0;) {
        struct change *b = &l->change[i];

        if (b->until == NEVER &&
            (c->op.kind == CRASH_SYNC_DIR ? is_name(b)
                                          : !is_name(b) && b->file == c->file))
            b->until = n;
    }
}

void crash_log_read(struct crash_log *l, const char *path)
{
    size_t at = 0;

    read_file(path, &l->text);
    while (l->text.n - at >= sizeof(struct crash_op)) {
        struct change *c;

        if (l->n % 256 == 0 &&
            (l->change = realloc(l->change, (l->n + 256) * sizeof *l->change)) == NULL)
            CANNOT("realloc");
        c = &l->change[l->n];
        memcpy(&c->op, l->text.at + at, sizeof c->op);
        if (l->text.n - at - sizeof c->op < c->op.len)
            break; /* killed as it was written */
        c->data = at + sizeof c->op;
        c->until = NEVER;
        c->file = 0;
        at = c->data + c->op.len;
        if (c->op.kind == CRASH_CREATE)
            c->file = new_file(l, c->op.file);
        else if (c->op.kind <= CRASH_SYNC)
            c->file = file_of(l, c->op.file);
        if (c->op.kind == CRASH_SYNC || c->op.kind == CRASH_SYNC_DIR)
            waited(l, l->n);
        l->n++;
    }
}

void crash_log_free(struct crash_log *l)
{
    if (l == NULL)
        return;
    for (size_t i = 0; i < l->files; i++)
        free(l->file[i].at);
    free(l->change);
    free(l->text.at);
    free(l);
}

size_t crash_log_n(const struct crash_log *l)
{
    return l->n;
}

uint64_t crash_log_bytes(const struct crash_log *l, size_t n)
{
    return n == 0 ? 0 : l->change[n - 1].data + l->change[n - 1].op.len;
}

/* ---- a folder out of it */

struct folder {
    struct bytes file[FILES_MAX];
    struct name name[NAMES_MAX];
    size_t names;
};

static struct name *find(struct folder *f, const char *text)
{
    for (size_t i = 0; i < f->names; i++)
        if (strcmp(f->name[i].text, text) == 0)
            return &f->name[i];
    return NULL;
}

static void set_name(struct folder *f, const char *text, size_t file)
{
    struct name *to = find(f, text);

    if (to == NULL) {
        if (f->names == NAMES_MAX)
            CANNOT("too many names");
        to = &f->name[f->names++];
        (void)snprintf(to->text, sizeof to->text, "%s", text);
    }
    to->file = file;
}

static void change_name(struct folder *f, const struct change *c)
{
    struct name *from = find(f, c->op.name);

    if (c->op.kind == CRASH_CREATE)
        set_name(f, c->op.name, c->file);
    if ((c->op.kind == CRASH_RENAME || c->op.kind == CRASH_LINK) && from != NULL)
        set_name(f, c->op.to, from->file);
    if ((c->op.kind == CRASH_RENAME || c->op.kind == CRASH_UNLINK) && from != NULL)
        *from = f->name[--f->names];
}

static void put(struct bytes *b, const unsigned char *data, size_t n, size_t at)
{
    if (n > 0) {
        resize(b, at + n > b->n ? at + n : b->n);
        memcpy(b->at + at, data, n);
    }
}

/* Of a write that was not synced: all, nothing, or any sectors. */
static void put_some(struct bytes *b, const unsigned char *data, size_t n, size_t at,
                     struct brute_rng *rng)
{
    const uint64_t how = brute_rand(rng) % 4;

    for (size_t done = 0, part; done < n; done += part) {
        part = SECTOR - (at + done) % SECTOR;
        part = part < n - done ? part : n - done;
        if (how == 0 || (how > 1 && brute_rand(rng) % 2 == 0))
            put(b, data + done, part, at + done);
    }
}

static void apply(struct folder *f, const struct crash_log *l, const struct change *c,
                  struct brute_rng *some)
{
    struct bytes *b = &f->file[c->file];

    if (is_name(c))
        change_name(f, c);
    else if (c->op.kind == CRASH_WRITE && some != NULL)
        put_some(b, l->text.at + c->data, c->op.len, c->op.at, some);
    else if (c->op.kind == CRASH_WRITE)
        put(b, l->text.at + c->data, c->op.len, c->op.at);
    else if (c->op.kind == CRASH_TRUNCATE && (some == NULL || brute_rand(some) % 2 == 0))
        resize(b, c->op.at);
}

void crash_log_state(const struct crash_log *l, size_t n, bool some,
                     struct brute_rng *rng, const char *dir)
{
    struct folder *f = calloc(1, sizeof *f);
    char path[CRASH_PATH];
    size_t names = 0, kept = 0;

    if (f == NULL)
        CANNOT("calloc");
    memcpy(f->name, l->name, sizeof f->name);
    f->names = l->names;
    for (size_t i = 0; i < l->files; i++)
        put(&f->file[i], l->file[i].at, l->file[i].n, 0);
    for (size_t i = 0; i < n; i++)
        names += is_name(&l->change[i]) && l->change[i].until >= n;
    if (some)
        kept = (size_t)(brute_rand(rng) % (names + 1));
    for (size_t i = 0; i < n; i++) {
        const struct change *c = &l->change[i];

        if (c->until < n)
            apply(f, l, c, NULL);
        else if (is_name(c) && kept > 0 && kept-- > 0)
            apply(f, l, c, NULL);
        else if (!is_name(c) && some)
            apply(f, l, c, rng);
    }
    shell("rm -rf '%s' && mkdir -m 700 '%s'", dir, dir);
    for (size_t i = 0; i < f->names; i++) {
        crash_join(path, dir, f->name[i].text);
        write_file(path, &f->file[f->name[i].file]);
    }
    for (size_t i = 0; i < l->files; i++)
        free(f->file[i].at);
    free(f);
}

/* ---- bytes in files */

struct search {
    const struct crash_secret *s;
    size_t n, found;
};

static void search_file(void *arg, const char *path, const char *name)
{
    struct search *to = arg;
    struct bytes b = {0};

    if (strcmp(name, "db") != 0 && strncmp(name, "db-", 3) != 0)
        return;
    read_file(path, &b);
    for (size_t i = 0; i < to->n; i++)
        for (size_t at = 0; at + sizeof *to->s <= b.n; at++)
            if (b.at[at] == to->s[i].at[0] &&
                memcmp(b.at + at, to->s[i].at, sizeof *to->s) == 0) {
                to->found++;
                break;
            }
    free(b.at);
}

size_t crash_found(const struct crash_secret *s, size_t n, const char *dir)
{
    struct search to = {s, n, 0};

    if (n > 0)
        each(dir, search_file, &to);
    return to.found;
}
