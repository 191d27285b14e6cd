#include "listen.h"

#include <fcntl.h>
#include <sys/socket.h>
#include <systemd/sd-daemon.h>
#include <errno.h>
#include <stdbool.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "address.h"
#include "errinfo.h"
#include "options.h"

#define BACKLOG   1024
#define UNIX_MODE 0660

/* Removes a socket's file that no process listens on.  If another kind of file is there, it stays, and bind()
 * fails. */
static void remove_abandoned(const struct listen_socket *s)
{
    const char *path = address_path(&s->ss);
    struct stat sb;
    int fd;

    if (lstat(path, &sb) != 0 || !S_ISSOCK(sb.st_mode))
        return;
    fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (fd < 0)
        return;
    if (connect(fd, (const struct sockaddr *)&s->ss, s->len) != 0 &&
        errno == ECONNREFUSED)
        (void)unlink(path);
    (void)close(fd);
}

/* The file's mode is never wider than UNIX_MODE, not even before chmod(). */
static bool bind_path(struct listen_socket *s)
{
    const char *path = address_path(&s->ss);
    struct stat sb;

    remove_abandoned(s);
    if (fchmod(s->fd, UNIX_MODE) != 0 ||
        bind(s->fd, (const struct sockaddr *)&s->ss, s->len) != 0 ||
        lstat(path, &sb) != 0)
        return false;
    s->device = sb.st_dev;
    s->inode = sb.st_ino;
    return chmod(path, UNIX_MODE) == 0 && listen(s->fd, BACKLOG) == 0;
}

static bool bind_port(struct listen_socket *s)
{
    struct sockaddr *sa = (struct sockaddr *)&s->ss;
    int one = 1;

    return setsockopt(s->fd, SOL_SOCKET, SO_REUSEADDR, &one, sizeof one) == 0 &&
           bind(s->fd, sa, s->len) == 0 && listen(s->fd, BACKLOG) == 0 &&
           getsockname(s->fd, sa, &s->len) == 0;
}

static enum status open_address(const struct sockaddr_storage *ss, socklen_t len,
                                struct listen_socket *out, struct errinfo *e)
{
    char url[ADDRESS_URL_MAX];
    enum status st;

    *out = (struct listen_socket){.ss = *ss, .len = len};
    out->fd = socket(ss->ss_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (out->fd >= 0 && (address_path(ss) != NULL ? bind_path(out) : bind_port(out)))
        return ST_OK;
    address_url(ss, false, url);
    st = errinfo_set(e, ST_EIO, "cannot listen on %s: %s", url, strerror(errno));
    listen_close(out);
    return st;
}

/* Takes a socket that already listens.  Its file stays when it is closed: the service manager owns it. */
static enum status adopt(int fd, struct listen_socket *out, struct errinfo *e)
{
    *out = (struct listen_socket){.fd = fd, .len = sizeof out->ss, .passed = true};
    if (getsockname(fd, (struct sockaddr *)&out->ss, &out->len) == 0)
        return ST_OK;
    listen_close(out);
    return errinfo_set(e, ST_EIO, "the socket that was passed: %s", strerror(errno));
}

/* The one listening stream socket that a service manager passed, made non-blocking and
 * close-on-exec.  *fd is -1 when none was.  ST_EINVAL: more than one, or something else. */
static enum status passed_socket(int *fd, struct errinfo *e)
{
    const int n = sd_listen_fds(1), first = SD_LISTEN_FDS_START;
    int flags;

    *fd = -1;
    if (n == 0)
        return ST_OK;
    if (n < 0)
        return errinfo_set(e, ST_EINVAL, "sockets that were passed: %s", strerror(-n));
    if (n > 1)
        return errinfo_set(e, ST_EINVAL, "%d sockets were passed; one is served", n);
    if (sd_is_socket(first, AF_UNSPEC, SOCK_STREAM, 1) <= 0)
        return errinfo_set(e, ST_EINVAL,
                           "the socket that was passed is not a listening "
                           "stream socket");
    if ((flags = fcntl(first, F_GETFL)) < 0 ||
        fcntl(first, F_SETFL, flags | O_NONBLOCK) != 0)
        return errinfo_set(e, ST_EINVAL, "the socket that was passed: %s",
                           strerror(errno));
    *fd = first;
    return ST_OK;
}

/* The options were checked together at the start.  The address of a passed socket is known only now. */
enum status listen_start(const struct options *o, struct listen_socket *s,
                         struct errinfo *e)
{
    int fd;
    enum status st = passed_socket(&fd, e);

    if (st != ST_OK || fd < 0)
        return st != ST_OK ? st : open_address(&o->listen, o->listen_len, s, e);
    st = adopt(fd, s, e);
    if (st == ST_OK && !address_is_local((const struct sockaddr *)&s->ss) &&
        (o->no_auth || (o->tls_cert == NULL && !o->plaintext)))
        st = errinfo_set(e, ST_EINVAL,
                         "the socket that was passed accepts other machines: that needs "
                         "tokens, and --tls-cert or --plaintext");
    return st;
}

void listen_end(struct listen_socket *s)
{
    const char *path = address_path(&s->ss);
    struct stat sb;

    if (s->fd < 0 || s->passed)
        return;
    if (path != NULL && s->inode != 0 && lstat(path, &sb) == 0 &&
        sb.st_dev == s->device && sb.st_ino == s->inode)
        (void)unlink(path);
    (void)shutdown(s->fd, SHUT_RD);
}

void listen_close(struct listen_socket *s)
{
    if (s->fd < 0)
        return;
    listen_end(s);
    (void)close(s->fd);
    s->fd = -1;
}
