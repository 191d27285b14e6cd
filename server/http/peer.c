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
#include "inflate.h"
#include "mem.h"
#include "request.h"
#include "tls.h"

#define PART     ((size_t)64 << 10)
#define CORS_MAX 768 /* bytes of its headers */

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

/* Takes the body, unless it returns NULL. */
static struct MHD_Response *make_body(struct peer *p, const struct response *a)
{
    struct MHD_Response *resp;
    struct parts *s;

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

static void add_header(void *resp, const char *name, const char *value)
{
    (void)MHD_add_response_header(resp, name, value);
}

/* Clients that were refused together do not all come back together. */
static unsigned again_in(const struct response *a)
{
    return a->retry_after + randombytes_uniform(a->retry_after / 8 + 3);
}

static struct MHD_Response *make_response(struct peer *p, struct response *a,
                                          const char *id, bool close)
{
    char number[16], challenge[AUTH_CHALLENGE_MAX];
    struct MHD_Response *resp = make_body(p, a);

    if (resp == NULL)
        return NULL;
    a->body = NULL; /* resp's now */
    a->file = NULL;
    if (a->len > 0)
        (void)MHD_add_response_header(resp, "Content-Type", a->type);
    (void)MHD_add_response_header(resp, "X-Request-Id", id);
    (void)MHD_add_response_header(resp, "Cache-Control",
                                  a->etag != NULL ? "no-cache" : "no-store");
    if (a->etag != NULL) {
        (void)MHD_add_response_header(resp, "ETag", a->etag);
        (void)MHD_add_response_header(resp, "Vary", "Accept-Encoding");
    }
    cors_headers(a, add_header, resp);
    if (a->gzip)
        (void)MHD_add_response_header(resp, "Content-Encoding", "gzip");
    (void)MHD_add_response_header(resp, "X-Content-Type-Options", "nosniff");
    if (a->name != NULL)
        (void)MHD_add_response_header(resp, "Content-Disposition", a->name);
    if (a->location[0] != '\0')
        (void)MHD_add_response_header(resp, "Location", a->location);
    if (a->allow[0] != '\0')
        (void)MHD_add_response_header(resp, "Allow", a->allow);
    if (a->policy != NULL)
        (void)MHD_add_response_header(resp, "Content-Security-Policy", a->policy);
    if (a->challenge) {
        auth_challenge(a, challenge);
        (void)MHD_add_response_header(resp, "WWW-Authenticate", challenge);
    }
    if (a->codings)
        (void)MHD_add_response_header(resp, "Accept-Encoding", INFLATE_ACCEPTED);
    if (a->minimal)
        (void)MHD_add_response_header(resp, "Preference-Applied", "return=minimal");
    if (a->retry_after > 0) {
        (void)snprintf(number, sizeof number, "%u", again_in(a));
        (void)MHD_add_response_header(resp, "Retry-After", number);
    }
    if (close)
        (void)MHD_add_response_header(resp, "Connection", "close");
    return resp;
}

bool peer_respond(struct peer *p, struct response *a, const char *id, bool close)
{
    struct MHD_Response *resp = make_response(p, a, id, close);
    enum MHD_Result sent;

    if (resp == NULL)
        return false;
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

static void print_header(void *to, const char *name, const char *value)
{
    char *text = to;
    const size_t n = strlen(text);

    (void)snprintf(text + n, CORS_MAX - n, "%s: %s\r\n", name, value);
}

/* libmicrohttpd accepts a response before or after the body, not amid it, so this one is
 * written by hand.  The socket's buffer is empty: the response fits in, or the client is
 * gone. */
bool peer_respond_midbody(struct peer *p, const struct response *a, const char *id)
{
    char head[512 + CORS_MAX], retry[32] = "", cors[CORS_MAX] = "";
    int n;

    if (a->retry_after > 0)
        (void)snprintf(retry, sizeof retry, "Retry-After: %u\r\n", again_in(a));
    cors_headers(a, print_header, cors);
    n = snprintf(head, sizeof head,
                 "HTTP/1.1 %d %s\r\nContent-Type: %s\r\nX-Request-Id: %s\r\n"
                 "Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\n%s%s"
                 "Connection: close\r\nContent-Length: %zu\r\n\r\n",
                 a->http, MHD_get_reason_phrase_for((unsigned)a->http), a->type, id,
                 retry, cors, a->len);
    return n > 0 && (size_t)n < sizeof head && peer_send(p, head, (size_t)n) &&
           peer_send(p, a->body, a->len);
}
