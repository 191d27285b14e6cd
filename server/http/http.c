#include "http.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <time.h>
#include <microhttpd.h>

#include "access.h"
#include "address.h"
#include "app.h"
#include "auth.h"
#include "body.h"
#include "capture.h"
#include "cors.h"
#include "errinfo.h"
#include "errmap.h"
#include "events.h"
#include "guard.h"
#include "headers.h"
#include "listen.h"
#include "logger.h"
#include "metrics.h"
#include "options.h"
#include "peer.h"
#include "proxy.h"
#include "queue.h"
#include "quota.h"
#include "recent.h"
#include "refusal.h"
#include "request.h"
#include "route.h"
#include "tls.h"
#include "upload.h"
#include "worker.h"

/* Size of libmicrohttpd's buffer for a connection, which limits the headers of a request.  libmicrohttpd clears all of it
 * after every request: a thousand idle connections take 13 MB.  Measured: a body of 100 KB arrives 0.1 ms
 * later than with 256 KB. */
#define CONNECTION_MEMORY (12 * 1024)
/* Connections that are being closed still count with libmicrohttpd. */
#define CONNECTIONS_CLOSING 64
#define PER_ADDRESS         64
/* Until a slow route may be free again. */
#define SLOW_RETRY_S 5
/* On a stop: time for a client that got a response just before to send its next request. */
#define QUIET_MS 100.0
/* Large bodies and responses together take at most so many times the limit of one body, and a
 * token's or an address's so many. */
#define LARGE_AT_ONCE 8
#define LARGE_OF_ONE  2
/* Small ones: more than a thousand of 10,000 points, and half of it for a token or an address. */
#define SMALL_AT_ONCE ((size_t)256 << 20)

enum state {
    ARRIVED,  /* the headers are there, nothing has been decided */
    ADMITTED, /* suspended: a worker checks the token */
    COLLECTING,
    WORKING,  /* suspended: a worker handles it; or the response is ready already */
    RESPONDED /* the response is being sent */
};

/* A request and its connection. */
struct exchange {
    struct request r; /* first: workers know the request alone */
    struct http *http;
    struct MHD_Connection *conn;
    struct peer *peer;
    enum state state;    /* changed by the thread that has the request */
    struct queue *queue; /* queue that got it last; NULL: none yet */
    struct upload upload;
    struct headers_framing framing;
    bool unframed;    /* the beginning of the next request is unknown */
    bool body_sent;   /* the client sends a body, or says so */
    double queued_ms; /* logger_clock_ms() when it was last handed to the workers */
    int linger_fd;    /* responded to before the body was read; -1: not */
};

struct http {
    struct app *app;
    struct MHD_Daemon *daemon;
    struct listen_socket socket;
    struct proxy *proxy; /* NULL: libmicrohttpd itself accepts connections */
    struct peer_host host;
    atomic_uint exchanges;
    struct quota *quota; /* I/O thread only */
    unsigned long serial;
};

/* ---- responses */

static bool closing(const struct exchange *x)
{
    return x->unframed || atomic_load(&x->http->app->stopping);
}

static enum MHD_Result send_response(struct exchange *x)
{
    x->state = RESPONDED;
    upload_respond(&x->upload);
    return peer_respond(x->peer, &x->r.response, x->r.id, closing(x)) ? MHD_YES : MHD_NO;
}

/* A header of the request; NULL: not there. */
static const char *header(const struct exchange *x, const char *name)
{
    return MHD_lookup_connection_value(x->conn, MHD_HEADER_KIND, name);
}

/* NULL: libmicrohttpd does not know. */
static const struct sockaddr *client_address(const struct exchange *x)
{
    const union MHD_ConnectionInfo *info =
        MHD_get_connection_info(x->conn, MHD_CONNECTION_INFO_CLIENT_ADDRESS);

    return info == NULL ? NULL : info->client_addr;
}

/* Responds before the body is read.  A client that still sends it may lose the response unless the socket stays
 * open longer than libmicrohttpd keeps it (guard_linger()).  Without a body the response waits for the next
 * call, so that the connection can be used again. */
static enum MHD_Result send_early(struct exchange *x)
{
    if (!x->body_sent) {
        x->state = WORKING;
        return MHD_YES;
    }
    x->linger_fd = fcntl(x->peer->fd, F_DUPFD_CLOEXEC, 0);
    return send_response(x);
}

/* Responds before the body has ended, so that a body of unknown length is refused as soon as it is over the
 * limit.  Closes the connection. */
static enum MHD_Result send_amid(struct exchange *x)
{
    if (peer_respond_midbody(x->peer, &x->r.response, x->r.id)) {
        x->linger_fd = fcntl(x->peer->fd, F_DUPFD_CLOEXEC, 0);
        x->state = RESPONDED;
    }
    return MHD_NO;
}

/* The request is over. */
static void http_finish(struct exchange *x)
{
    struct http *h = x->http;
    const double ms = logger_clock_ms() - x->r.start_ms;
    const int http = x->state == RESPONDED ? x->r.response.http : 0;

    metrics_request(h->app->metrics, &x->r, http, ms);
    access_log(&x->r, http, ms);
    if (x->linger_fd >= 0)
        guard_linger(h->host.guard, x->linger_fd);
    guard_begin(x->peer->place, GUARD_IDLE);
    upload_end(&x->upload);
    events_close(x->r.response.stream);
    events_close(x->r.waits);
    request_free(&x->r);
}

/* ---- requests that libmicrohttpd refuses by itself */

static void explain(struct request *r, unsigned status)
{
    static const struct {
        unsigned status, kind;
        const char *why;
    } known[] = {{414, ERRMAP_TARGET, "the limit for path and query is about 11 KB"},
                 {431, ERRMAP_HEADERS, "the limit for all headers is about 11 KB"},
                 {505, ERRMAP_VERSION, "use HTTP/1.1 or HTTP/1.0"},
                 /* without the limit: the client may have no token */
                 {413, ST_ESIZE, "Content-Length or a chunk's size has too many digits"},
                 {400, ST_EINVAL, "a header, Content-Length or a chunk is malformed"},
                 /* its buffer is full, and we cannot take anything of it */
                 {500, ST_EINVAL, "a chunk's size and extension are too long"},
                 {0, ST_EINTERNAL, "libmicrohttpd rejected the request"}};
    size_t i = 0;

    while (known[i].status != 0 && known[i].status != status)
        i++;
    request_problem(r, known[i].kind, "%s", known[i].why);
}

/* See peer_host. */
static void on_refusal(void *arg, struct peer *p, unsigned status)
{
    struct http *h = arg;
    struct exchange none = {.http = h, .peer = p, .linger_fd = -1};
    struct exchange *x = p->current != NULL ? p->current : &none;

    if (x == &none) { /* not even a request line was read */
        none.r.app = h->app;
        none.r.start_ms = logger_clock_ms();
    }
    if (x->r.id[0] == '\0')
        request_set_id(&x->r, NULL, ++h->serial);
    explain(&x->r, status);
    (void)send_amid(x);
    if (x == &none)
        http_finish(x);
}

/* ---- workers */

/* The one place of a slow route.  False: it is taken. */
static bool begin_slow(struct exchange *x)
{
    if (x->r.route->where != ROUTE_SLOW ||
        !atomic_flag_test_and_set(&x->http->app->slow_taken))
        return true;
    request_problem(&x->r, ERRMAP_OVERLOAD,
                    "the audit log is being verified or exported: one at a time");
    x->r.response.retry_after = SLOW_RETRY_S;
    return false;
}

/* Frees the one place of the slow routes if x has it. */
static void end_slow(struct exchange *x)
{
    if (x->queue == x->http->app->slow)
        atomic_flag_clear(&x->http->app->slow_taken);
}

/* x is suspended.  On any thread; x may be done when it returns. */
static void queue_up(struct exchange *x, enum queue_kind kind)
{
    struct app *app = x->http->app;
    struct request *out;

    x->queued_ms = logger_clock_ms();
    out = queue_push(x->queue, &x->r, kind, request_sender(&x->r));
    if (out == NULL)
        return;
    request_problem(out, ERRMAP_OVERLOAD, "%s",
                    atomic_load(&app->stopping) ? "the daemon is stopping"
                                                : "the queue is full");
    end_slow((struct exchange *)out);
    MHD_resume_connection(((struct exchange *)out)->conn);
}

/* False: r is to be queued again, as a large one. */
static bool handle(struct worker *w, struct request *r)
{
    if (request_gone(r))
        return true;
    capture_digest(r); /* before the body is decompressed */
    if (body_unpack(r) && !refusal_found(r))
        r->route->handle(r, w);
    else if (r->response.http == 0)
        return false;
    if (!atomic_load(&r->gone)) {
        recent_note(r->app->recent, r);
        access_refusal(r);
    }
    return true;
}

/* There is an event for x, or it has waited long enough. */
static void on_waited(void *arg)
{
    struct exchange *x = arg;

    MHD_resume_connection(x->conn);
}

void http_run(struct worker *w, struct request *r)
{
    struct exchange *x = (struct exchange *)r;

    request_stage(r, REQUEST_QUEUE, logger_clock_ms() - x->queued_ms);
    if (x->state == ADMITTED) {
        auth_check(r);
    } else {
        w->large = w->large || r->large;
        if (!handle(w, r)) {
            queue_up(x, QUEUE_LARGE);
            return;
        }
    }
    end_slow(x);
    refusal_tell(r->app);
    if (r->method != REQUEST_GET)
        events_poke(r->app->events);
    if (r->waits != NULL)
        events_wait(r->waits, on_waited, x);
    else
        MHD_resume_connection(x->conn);
}

/* The client has disconnected (guard_work()).  A worker that has x sees r.gone.  Called on the guard's thread,
 * perhaps while the I/O thread changes x->state: this function must not read it. */
static void on_gone(void *arg)
{
    struct exchange *x = arg;

    atomic_store(&x->r.gone, true);
    if (queue_drop(x->queue, &x->r)) {
        end_slow(x);
        MHD_resume_connection(x->conn);
    }
}

/* Hands x over to a worker; on_request() is called again when it is done. */
static void to_worker(struct exchange *x, enum state state)
{
    const struct app *app = x->http->app;

    x->state = state;
    x->queue =
        state == WORKING && x->r.route->where == ROUTE_SLOW ? app->slow : app->queue;
    guard_work(x->peer->place, on_gone, x);
    x->r.large = upload_is_large(&x->upload);
    MHD_suspend_connection(x->conn); /* first: the worker may be faster than we */
    queue_up(x, state == ADMITTED ? QUEUE_TOKEN : x->r.large ? QUEUE_LARGE : QUEUE_SMALL);
}

/* ---- the body */

/* Reads the headers of the body. */
static void look_at_body(struct exchange *x)
{
    const char *length = header(x, "Content-Length");
    const char *coding = header(x, "Transfer-Encoding");

    x->upload.length = 0;
    if (coding != NULL)
        x->upload.length = UPLOAD_LENGTH_UNKNOWN;
    else if (length != NULL)
        x->upload.length = strtoull(length, NULL, 10); /* libmicrohttpd has checked it */
    x->body_sent = x->upload.length > 0;
    x->r.capture.type = header(x, "Content-Type");
    x->r.capture.coding = header(x, "Content-Encoding");
    x->r.media = request_media(x->r.capture.type, &x->r.format);
    if (x->r.media == REQUEST_FORM)
        (void)multipart_boundary(x->r.capture.type, x->r.boundary);
}

static enum MHD_Result http_collect(struct exchange *x, const char *data, size_t *size)
{
    guard_more(x->peer->place, *size);
    if (x->r.route->body == ROUTE_NO_BODY) { /* in chunks */
        body_refuse_any(&x->r);
        return send_amid(x);
    }
    switch (upload_add(&x->upload, data, *size)) {
    case ST_OK:
        *size = 0;
        return MHD_YES;
    case ST_ESIZE:
        body_refuse_size(&x->r);
        break;
    default:
        body_refuse_room(&x->r);
    }
    return send_amid(x);
}

static enum MHD_Result body_complete(struct exchange *x)
{
    if (x->r.route->body != ROUTE_NO_BODY && x->r.len == 0) {
        request_problem(&x->r, ST_EINVAL, "the body is empty");
        return send_response(x);
    }
    if (x->r.route->where == ROUTE_QUICK) {
        x->r.route->handle(&x->r, NULL);
        return send_response(x);
    }
    if (!begin_slow(x))
        return send_response(x);
    to_worker(x, WORKING);
    return MHD_YES;
}

/* ---- libmicrohttpd's callbacks */

/* The token is valid.  Checks the path's id, the query and the body's headers. */
static enum MHD_Result admit(struct exchange *x)
{
    route_read_id(&x->r);
    if (x->r.response.http == 0)
        route_check_query(&x->r);
    if (x->r.response.http == 0)
        body_check(&x->r, x->framing.has_length, x->upload.length);
    if (x->r.response.http == 0 && !upload_has_room(&x->upload))
        body_refuse_room(&x->r);
    if (x->r.response.http != 0)
        return send_early(x);
    x->state = COLLECTING;
    guard_begin(x->peer->place, GUARD_BODY);
    return MHD_YES;
}

static enum MHD_Result on_header(void *cls, enum MHD_ValueKind kind, const char *name,
                                 const char *value)
{
    struct exchange *x = cls;

    (void)kind;
    headers_take(&x->r, &x->framing, name, value);
    return MHD_YES;
}

static enum MHD_Result arrive(struct exchange *x, const char *method, const char *version)
{
    struct request *r = &x->r;

    request_set_id(r, header(x, "X-Request-Id"), ++x->http->serial);
    r->method = request_method(method);
    r->address = address_key(client_address(x));
    look_at_body(x);
    (void)MHD_get_connection_values(x->conn, MHD_HEADER_KIND, on_header, x);
    cors_take(r);
    if ((x->unframed = headers_refuse(r, &x->framing, version))) {
        x->body_sent = true; /* whatever the headers that were taken say */
        return send_early(x);
    }
    route_find(r->app->routes, r->app->nroutes, r);
    if (r->response.http != 0 || refusal_stands(r))
        return send_early(x);
    if (cors_refuse(r))
        return send_early(x);
    if (r->app->no_auth)
        return auth_free(r) ? admit(x) : send_early(x);
    const char *token = header(x, "Authorization");

    if (r->route->scope == 0 || (token == NULL && route_open(r->route)))
        return admit(x);
    if (!auth_take(r, token))
        return send_early(x);
    to_worker(x, ADMITTED);
    return MHD_YES;
}

/* Called when the headers are there, again after each suspension, for each part of the body
 * and at its end. */
static enum MHD_Result on_request(void *cls, struct MHD_Connection *conn, const char *url,
                                  const char *method, const char *version,
                                  const char *data, size_t *size, void **con_cls)
{
    struct exchange *x = *con_cls;

    (void)cls;
    (void)conn;
    (void)url;
    if (x == NULL)
        return MHD_NO;
    switch (x->state) {
    case ARRIVED:
        return arrive(x, method, version);
    case ADMITTED:
        if (atomic_load(&x->r.gone))
            return MHD_NO;
        return x->r.response.http != 0 ? send_early(x) : admit(x);
    case COLLECTING:
        return *size > 0 ? http_collect(x, data, size) : body_complete(x);
    case WORKING:
        return atomic_load(&x->r.gone) ? MHD_NO : send_response(x);
    case RESPONDED:
        break;
    }
    return MHD_NO;
}

/* libmicrohttpd (0.9.75) would then keep each parameter in the connection's memory.  If that is full, it refuses
 * the request, frees the memory, and goes on with it: some 190 parameters ended the program.  A NUL behind
 * the '?', in its buffer, hides the parameters. */
static void hide_query(const char *uri)
{
    char *query = strchr(uri, '?');

    if (query != NULL)
        query[1] = '\0';
}

/* Takes scheme and host off a target in absolute form, which proxies send and every server must accept (RFC
 * 9112, section 3.2.2). */
static void make_origin_form(char *target)
{
    const size_t scheme = strncasecmp(target, "http://", 7) == 0    ? 7
                          : strncasecmp(target, "https://", 8) == 0 ? 8
                                                                    : 0;
    const char *path = target + scheme + strcspn(target + scheme, "/?");

    if (scheme == 0)
        return;
    if (*path != '/')
        *target++ = '/'; /* the scheme is longer */
    memmove(target, path, strlen(path) + 1);
}

/* The request line is there: the path as it was sent, percent-encoding and all. */
static void *on_uri(void *cls, const char *uri, struct MHD_Connection *conn)
{
    struct http *h = cls;
    struct peer *p =
        MHD_get_connection_info(conn, MHD_CONNECTION_INFO_SOCKET_CONTEXT)->socket_context;
    struct exchange *x = p != NULL ? calloc(1, sizeof *x) : NULL;
    char *target = x != NULL ? strdup(uri) : NULL;

    hide_query(uri);
    if (target != NULL)
        make_origin_form(target);
    if (target == NULL) {
        free(x);
        return NULL;
    }
    x->http = h;
    x->conn = conn;
    x->peer = p;
    x->linger_fd = -1;
    x->r.app = h->app;
    address_host(client_address(x), x->r.client);
    x->r.start_ms = logger_clock_ms();
    upload_begin(&x->upload, &x->r, h->quota);
    x->r.target = target;
    p->current = x;
    guard_begin(x->peer->place, GUARD_HEADERS);
    (void)atomic_fetch_add(&h->exchanges, 1);
    return x;
}

static void on_completed(void *cls, struct MHD_Connection *conn, void **con_cls,
                         enum MHD_RequestTerminationCode how)
{
    struct http *h = cls;
    struct exchange *x = *con_cls;

    (void)conn;
    (void)how;
    if (x == NULL)
        return;
    *con_cls = NULL;
    x->peer->current = NULL;
    http_finish(x);
    free(x);
    (void)atomic_fetch_sub(&h->exchanges, 1);
}

/* request_decode() decodes the path.  libmicrohttpd would lose the difference between "/" and "%2F". */
static size_t keep_encoded(void *cls, struct MHD_Connection *conn, char *s)
{
    (void)cls;
    (void)conn;
    return strlen(s);
}

/* ---- connections */

static enum MHD_Result on_accept(void *cls, const struct sockaddr *addr, socklen_t len)
{
    struct http *h = cls;

    return guard_admit(h->host.guard, len == 0 ? NULL : addr) ? MHD_YES : MHD_NO;
}

static void on_connection(void *cls, struct MHD_Connection *conn, void **context,
                          enum MHD_ConnectionNotificationCode what)
{
    const struct http *h = cls;

    if (what == MHD_CONNECTION_NOTIFY_STARTED) {
        *context = peer_open(&h->host, conn);
        proxy_taken(h->proxy);
    } else {
        peer_close(*context);
        *context = NULL;
    }
}

/* ---- start and stop */

/* Behind proxies libmicrohttpd itself accepts no connections. */
static enum status start_daemon(struct http *h, const struct options *o,
                                struct errinfo *e)
{
    const bool behind = o->proxy_protocol != NULL;
    struct MHD_OptionItem listening[] = {
        {behind ? MHD_OPTION_END : MHD_OPTION_LISTEN_SOCKET, h->socket.fd, NULL},
        {MHD_OPTION_END, 0, NULL}};
    /* libmicrohttpd (0.9.75) closes an added connection beyond this limit with a mutex locked, and hangs:
     * behind proxies the guard's limit is the only one. */
    const unsigned limit = behind ? UINT_MAX : o->max_connections + CONNECTIONS_CLOSING;

    h->daemon = MHD_start_daemon(
        MHD_USE_EPOLL_INTERNAL_THREAD | MHD_ALLOW_SUSPEND_RESUME |
            (h->host.tls != NULL ? MHD_USE_TLS : 0) |
            (behind ? MHD_USE_NO_LISTEN_SOCKET : 0),
        0, on_accept, h, on_request, h, MHD_OPTION_ARRAY, listening,
        MHD_OPTION_URI_LOG_CALLBACK, on_uri, h, MHD_OPTION_NOTIFY_COMPLETED, on_completed,
        h, MHD_OPTION_NOTIFY_CONNECTION, on_connection, h, MHD_OPTION_UNESCAPE_CALLBACK,
        keep_encoded, NULL, MHD_OPTION_CONNECTION_MEMORY_LIMIT, (size_t)CONNECTION_MEMORY,
        MHD_OPTION_CONNECTION_LIMIT, limit,
        h->host.tls != NULL ? MHD_OPTION_HTTPS_CERT_CALLBACK : MHD_OPTION_END, tls_none,
        MHD_OPTION_HTTPS_PRIORITIES, tls_priorities, MHD_OPTION_END);
    if (h->daemon == NULL)
        return errinfo_set(e, ST_EIO, "cannot start serving: %s", strerror(errno));
    return behind ? proxy_start(o->proxy_protocol, h->socket.fd, h->daemon, h->host.guard,
                                &h->proxy, e)
                  : ST_OK;
}

enum status http_start(const struct options *o, struct app *app, struct http **out,
                       char url[HTTP_URL_MAX], struct errinfo *e)
{
    struct guard_rules rules = {.connections = o->max_connections,
                                .per_address = o->max_connections_per_address,
                                .local_too = true,
                                .timeout_s = o->timeout_s,
                                .waiting = o->proxy_protocol != NULL ? PROXY_WAITING : 0};
    const struct quota_limits limits = {
        .all = {SMALL_AT_ONCE, LARGE_AT_ONCE * (o->max_body + 1)},
        .one = {SMALL_AT_ONCE / 2, LARGE_OF_ONE * (o->max_body + 1)}};
    struct tls_names names = {o->tls_cert, o->tls_key, o->tls_client_ca};
    struct http *h = calloc(1, sizeof *h);
    enum status st;

    if (h == NULL)
        return errinfo_memory(e);
    h->app = app;
    h->socket.fd = -1;
    h->host.refuse = on_refusal;
    h->host.arg = h;
    if (rules.per_address == OPTIONS_UNSET) {
        rules.per_address = PER_ADDRESS;
        rules.local_too = false;
    }
    st = peer_init(e);
    if (st == ST_OK && (h->quota = quota_new(&limits)) == NULL)
        st = errinfo_memory(e);
    if (st == ST_OK && names.cert != NULL)
        st = tls_open(&names, &h->host.tls, e);
    if (st == ST_OK)
        st = guard_start(&rules, &h->host.guard, e);
    if (st == ST_OK)
        st = listen_start(o, &h->socket, e);
    app->guard = h->host.guard;
    app->quota = h->quota;
    app->tls = h->host.tls;
    if (st == ST_OK) {
        address_url(&h->socket.ss, h->host.tls != NULL, url);
        st = start_daemon(h, o, e);
    }
    if (st == ST_OK)
        *out = h;
    else
        http_stop(h);
    return st;
}

void http_reload(struct http *h)
{
    struct errinfo e = {0};

    if (h->host.tls != NULL && tls_reload(h->host.tls, &e) != ST_OK)
        logger_line("error", "the TLS certificate stays as it was", "reason", e.msg);
}

void http_quiesce(struct http *h, double ms)
{
    const struct timespec pause = {0, 5 * 1000 * 1000};
    double now, end, busy;

    if (!atomic_exchange(&h->app->stopping, true)) {
        (void)MHD_quiesce_daemon(h->daemon); /* does nothing behind proxies */
        proxy_stop(h->proxy);
        listen_end(&h->socket); /* not closed: the I/O thread may be at it */
        events_stop(h->app->events);
    }
    now = busy = logger_clock_ms();
    end = now + ms;
    for (; now < end && now < busy + QUIET_MS; now = logger_clock_ms()) {
        if (atomic_load(&h->exchanges) > 0)
            busy = now;
        (void)nanosleep(&pause, NULL);
    }
}

void http_stop(struct http *h)
{
    if (h == NULL)
        return;
    proxy_stop(h->proxy);
    if (h->daemon != NULL)
        MHD_stop_daemon(h->daemon);
    proxy_free(h->proxy);
    listen_close(&h->socket);
    guard_stop(h->host.guard);
    tls_close(h->host.tls);
    quota_free(h->quota);
    free(h);
}
