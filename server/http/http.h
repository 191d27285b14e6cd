/* http.h -- HTTP on libmicrohttpd: one I/O thread that receives requests and sends
 * responses.  It never computes: that is queued for the workers, and the connection is
 * suspended until its response is ready.  The body's limit is enforced before the body is read. */
#ifndef SERVER_HTTP_H
#define SERVER_HTTP_H
#include "address.h"
#include "status.h"

struct app;
struct errinfo;
struct http;
struct options;
struct request;
struct worker;

#define HTTP_URL_MAX ADDRESS_URL_MAX

/* http_listen(o, out, url, e): read the certificate, bind and listen; nothing is accepted
 * yet.  url: how to reach it, with the port that was got.  o's strings are borrowed until
 * http_stop().  Returns ST_OK; ST_EIO, ST_EINVAL (the message says why); ST_ENOMEM. */
enum status http_listen(const struct options *o, struct http **out,
                        char url[HTTP_URL_MAX], struct errinfo *e);

/* http_start(h, app, e): serve; app->queue is open and runs http_run(). */
enum status http_start(struct http *h, struct app *app, struct errinfo *e);

/* http_reload(h): read the TLS files again.  Open connections stay; if the files are not
 * valid, those read before stay in force, and the log says why. */
void http_reload(struct http *h);

/* http_run(w, r): a worker's part in a request that http.c has queued. */
void http_run(struct worker *w, struct request *r);

/* http_quiesce(h, ms): take no more connections, and wait up to ms for the requests that
 * have begun; every response from now on closes its connection. */
void http_quiesce(struct http *h, double ms);

/* http_stop(h): close what is left.  The queue must have been stopped.  NULL is allowed. */
void http_stop(struct http *h);

#endif
