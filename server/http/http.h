/* http.h -- HTTP on libmicrohttpd: one I/O thread receives requests and sends responses.  It never computes
 * and never waits for the store: it suspends the connection and queues the request for the workers.
 * A request goes to a worker twice: with its token, before its body is received, and with its body.  So a
 * client without a valid token cannot make the daemon hold a large body, and learns of a wrong token
 * before it sends one.  The second trip costs 6 us of 85 for a GET, and of 8,500 for a verification. */
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

/* http_start(o, app, out, url, e): Reads the certificate, binds, listens and serves.
 *   o    its strings are borrowed until http_stop()
 *   app  its queues are open and run http_run(); guard, quota and tls are set
 *   url  set to the URL of the daemon, with the port that it got
 * Returns ST_OK; ST_EIO, ST_EINVAL (the message says why); ST_ENOMEM. */
enum status http_start(const struct options *o, struct app *app, struct http **out,
                       char url[HTTP_URL_MAX], struct errinfo *e);

/* http_reload(h): Reads the TLS files again.  Open connections stay.  If a file is not valid, logs it and
 * keeps the content that was read before. */
void http_reload(struct http *h);

/* http_run(w, r): Does a worker's part of a request from the queue. */
void http_run(struct worker *w, struct request *r);

/* http_quiesce(h, ms): Accepts no more connections, and waits up to ms for the requests that have begun.  From
 * now on each response closes its connection. */
void http_quiesce(struct http *h, double ms);

/* http_stop(h): Closes all that is left.  The queues must have been stopped.  NULL is allowed. */
void http_stop(struct http *h);

#endif
