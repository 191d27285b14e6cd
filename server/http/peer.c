#define _GNU_SOURCE /* RTLD_NEXT */
#include "peer.h"

#include <dlfcn.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <microhttpd.h>
#include <sodium.h>

#include "auth.h"
#include "cors.h"
#include "errinfo.h"
#include "events.h"
#include "inflate.h"
#include "mem.h"
#include "request.h"
#include "tls.h"

#define PART     ((size_t)64 << 10)
#define HEAD_MAX 2048 /* bytes of the headers of a response written by hand */

struct peer *peer_open(const struct peer_host *host, struct MHD_Connection *conn)
{
    const int fd =
        MHD_get_connection_info(conn, MHD_CONNECTION_INFO_CONNECTION_FD)->connect_fd;
    const struct sockaddr *addr =
        MHD_get_connection_info(conn, MHD_CONNECTION_INFO_CLIENT_ADDRESS)->client_addr;
    struct peer *p = calloc(1, sizeof *p);

    if (p != NULL)
        p->place = guard_open(host->guard, fd, addr);
    if (p == NULL || p->place == NULL) { /* or it would have no deadline */
        (void)shutdown(fd, SHUT_RDWR);
        free(p);
        return NULL;
    }
    p->host = host;
    p->conn = conn;
    p->fd = fd;
    if (host->tls != NULL) {
        p->session = MHD_get_connection_info(conn, MHD_CONNECTION_INFO_GNUTLS_SESSION)
                         ->tls_session;
        p->files = tls_attach(host->tls, p->session);
    }
    return p;
}

void peer_close(struct peer *p)
{
    if (p == NULL)
        return;
    guard_close(p->place);
    tls_detach(p->files);
    free(p);
}

/* ---- responses */

/* libmicrohttpd (0.9.75) responds by itself to malformed HTTP: with HTML and without a media type; if
 * Content-Length is malformed, it sends the status line and the headers twice.  No option changes this.  But the
 * library queues this response by its public MHD_queue_response(), through the dynamic linker, which finds the
 * function below first, because the program exports it.  The program itself calls the library's function by
 * queue_response.  In a build of the library that binds its own calls, the responses are HTML again.
 *
 * The function queues the library's response too, on a socket that sends no more.  If it failed instead, the
 * library would free the connection's memory and go on with it, for example in a header with many
 * cookies. */
static enum MHD_Result (*queue_response)(struct MHD_Connection *conn, unsigned status,
                                         struct MHD_Response *resp);

enum status peer_init(struct errinfo *e)
{
    *(void **)&queue_response = dlsym(RTLD_NEXT, "MHD_queue_response");
    return queue_response != NULL
               ? ST_OK
               : errinfo_set(e, ST_EINTERNAL,
                             "libmicrohttpd has no MHD_queue_response()");
}

enum MHD_Result MHD_queue_response(struct MHD_Connection *conn, unsigned status,
                                   struct MHD_Response *resp)
{
    struct peer *p =
        MHD_get_connection_info(conn, MHD_CONNECTION_INFO_SOCKET_CONTEXT)->socket_context;

    if (p != NULL) {
        p->host->refuse(p->host->arg, p, status);
        (void)shutdown(p->fd, SHUT_WR);
    }
    return queue_response(conn, status, resp);
}

/* A body that is handed over in parts, so that the guard sees how fast the client reads. */
struct parts {
    struct peer *peer;
    const char *text;
    char *body; /* owner of text; NULL: text is static */
    FILE *file; /* file in place of text; NULL: none */
};

static ssize_t read_part(void *arg, uint64_t pos, char *to, size_t max)
{
    const struct parts *s = arg;

    if (s->file == NULL)
        memcpy(to, s->text + pos, max);
    else if (fseeko(s->file, (off_t)pos, SEEK_SET) != 0 ||
             (max = fread(to, 1, max, s->file)) == 0)
        return MHD_CONTENT_READER_END_WITH_ERROR;
    guard_more(s->peer->place, max);
    return (ssize_t)max;
}

static void free_parts(void *arg)
{
    struct parts *s = arg;

    mem_free(s->body);
    if (s->file != NULL)
        (void)fclose(s->file);
    free(s);
}

/* ---- streams of events */

static void suspend(void *conn)
{
    MHD_suspend_connection(conn);
}

static void resume(void *conn)
{
    MHD_resume_connection(conn);
}

static ssize_t read_stream(void *stream, uint64_t pos, char *to, size_t max)
{
    const ssize_t n = events_read(stream, to, max);

    (void)pos;
    return n == STREAM_END    ? MHD_CONTENT_READER_END_OF_STREAM
           : n == STREAM_GONE ? MHD_CONTENT_READER_END_WITH_ERROR
                              : n;
}

/* Takes the stream, unless it returns NULL. */
static struct MHD_Response *make_stream(const struct peer *p,
                                        struct events_stream *stream)
{
    const struct stream_connection to = {p->conn, suspend, resume, p->fd, p->place};
    struct MHD_Response *resp = MHD_create_response_from_callback(
        MHD_SIZE_UNKNOWN, EVENTS_BLOCK, read_stream, stream, events_close);

    if (resp != NULL)
        events_attach(stream, &to);
    return resp;
}

/* ---- */

/* Takes the body, unless it returns NULL. */
static struct MHD_Response *make_body(struct peer *p, const struct response *a)
{
    struct MHD_Response *resp;
    struct parts *s;

    if (a->stream != NULL)
        return make_stream(p, a->stream);
    if (a->file == NULL && a->body == NULL && a->len <= PART)
        return MHD_create_response_from_buffer(a->len, (void *)(uintptr_t)a->page,
                                               MHD_RESPMEM_PERSISTENT);
    if (a->file == NULL && a->len <= PART)
        return MHD_create_response_from_buffer_with_free_callback(a->len, a->body,
                                                                  mem_free);
    if ((s = malloc(sizeof *s)) == NULL)
        return NULL;
    *s = (struct parts){p, a->body != NULL ? a->body : a->page, a->body, a->file};
    resp = MHD_create_response_from_callback(a->len, PART, read_part, s, free_parts);
    if (resp == NULL)
        free(s);
    return resp;
}

/* Calls add(arg, name, value) for each header, except Content-Length. */
static void peer_headers(const struct response *a, const char *id, bool close,
                         void (*add)(void *arg, const char *name, const char *value),
                         void *arg)
{
    char again[16] = "", challenge[AUTH_CHALLENGE_MAX] = "";
    const struct {
        const char *name, *value; /* value: "" or NULL: no such header */
    } header[] = {{"Content-Type", a->len > 0 || a->stream != NULL ? a->type : NULL},
                  {"X-Request-Id", id},
                  {"Cache-Control", a->etag != NULL ? "no-cache" : "no-store"},
                  {"ETag", a->etag},
                  {"Vary", a->etag != NULL ? "Accept-Encoding" : NULL},
                  {"Content-Encoding", a->gzip ? "gzip" : NULL},
                  {"X-Content-Type-Options", "nosniff"},
                  {"Content-Disposition", a->name},
                  {"Location", a->location},
                  {"Allow", a->allow},
                  {"Content-Security-Policy", a->policy},
                  {"WWW-Authenticate", challenge},
                  {"Accept-Encoding", a->codings ? INFLATE_ACCEPTED : NULL},
                  {"Preference-Applied", a->minimal ? "return=minimal" : NULL},
                  {"Retry-After", again},
                  /* a proxy like nginx hands it on at once */
                  {"X-Accel-Buffering", a->stream != NULL ? "no" : NULL},
                  {"Connection", close ? "close" : NULL}};

    if (a->challenge)
        auth_challenge(a, challenge);
    if (a->retry_after > 0) /* clients refused together do not all come back together */
        (void)snprintf(again, sizeof again, "%u",
                       a->retry_after + randombytes_uniform(a->retry_after / 8 + 3));
    for (size_t i = 0; i < sizeof header / sizeof *header; i++)
        if (header[i].value != NULL && header[i].value[0] != '\0')
            add(arg, header[i].name, header[i].value);
    cors_headers(a, add, arg);
}

static void add_header(void *resp, const char *name, const char *value)
{
    (void)MHD_add_response_header(resp, name, value);
}

bool peer_respond(struct peer *p, struct response *a, const char *id, bool close)
{
    struct MHD_Response *resp = make_body(p, a);
    enum MHD_Result sent;

    if (resp == NULL)
        return false;
    a->body = NULL; /* resp owns it */
    a->file = NULL;
    peer_headers(a, id, close, add_header, resp);
    a->stream = NULL; /* the header needs it */
    guard_begin(p->place, GUARD_RESPONSE);
    sent = queue_response(p->conn, (unsigned)a->http, resp);
    MHD_destroy_response(resp);
    return sent == MHD_YES;
}

static bool peer_send(const struct peer *p, const void *data, size_t len)
{
    if (p->session != NULL)
        return tls_send(p->session, data, len) == (ssize_t)len;
    return send(p->fd, data, len, MSG_NOSIGNAL | MSG_DONTWAIT) == (ssize_t)len;
}

/* Appends to a text of HEAD_MAX bytes. */
static void print_header(void *to, const char *name, const char *value)
{
    char *text = to;
    const size_t n = strlen(text);

    (void)snprintf(text + n, HEAD_MAX - n, "%s: %s\r\n", name, value);
}

/* libmicrohttpd accepts a response before or after the body, not amid it, so this one is
 * written by hand.  The socket's buffer is empty: the response fits in, or the client is
 * gone. */
bool peer_respond_midbody(struct peer *p, const struct response *a, const char *id)
{
    char head[HEAD_MAX], length[16];

    (void)snprintf(length, sizeof length, "%zu\r\n", a->len); /* the headers end */
    (void)snprintf(head, sizeof head, "HTTP/1.1 %d %s\r\n", a->http,
                   MHD_get_reason_phrase_for((unsigned)a->http));
    peer_headers(a, id, true, print_header, head);
    print_header(head, "Content-Length", length);
    return strlen(head) < HEAD_MAX - 1 && peer_send(p, head, strlen(head)) &&
           peer_send(p, a->body, a->len);
}
