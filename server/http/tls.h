/* tls.h -- the daemon's certificate and key, by GnuTLS, and who may connect by a certificate
 * of their own.  The files are read at the start and again by tls_reload(): sessions that are
 * open keep what they began with, new ones get the new files' content.
 * TLS 1.2 and 1.3 only, forward secrecy and authenticated ciphers only. */
#ifndef SERVER_TLS_H
#define SERVER_TLS_H
#include <stddef.h>
#include <sys/types.h>
#include <time.h>
#include <gnutls/abstract.h>
#include "status.h"

struct errinfo;
struct tls;
struct tls_files;

/* PEM files. */
struct tls_names {
    const char *cert;      /* the daemon's own, then those between it and its CA */
    const char *key;       /* not encrypted; refused when others may read or write it */
    const char *client_ca; /* NULL: clients need no certificate */
};

/* GnuTLS's priority string for every session. */
extern const char tls_priorities[];

/* tls_open(names, out, e): the strings are borrowed until tls_close().
 * Returns ST_OK; ST_EIO: a file cannot be read; ST_EINVAL: it holds no certificate or no key,
 * they do not belong together, the certificate has expired, others may read the key;
 * ST_ENOMEM.  The message names the file. */
enum status tls_open(const struct tls_names *names, struct tls **out, struct errinfo *e);

/* tls_reload(t, e): read the files again.  On an error (as above) nothing changes.  From any
 * thread, beside the others. */
enum status tls_reload(struct tls *t, struct errinfo *e);

/* tls_end(t): when the certificate in force ends.  From any thread, beside the others. */
time_t tls_end(struct tls *t);

/* tls_attach(t, session): give a new session, before its handshake, the credentials in force.
 * Returns a reference for tls_detach(); NULL when it cannot, and then the session has none. */
struct tls_files *tls_attach(struct tls *t, gnutls_session_t session);

/* The certificate of a session that tls_attach() has not been called for: none, so that its
 * handshake fails. */
gnutls_certificate_retrieve_function2 tls_none;

/* tls_detach(f): the session is gone.  NULL is allowed. */
void tls_detach(struct tls_files *f);

/* tls_send(session, data, len): as send(), for what fits into the socket's buffer; -1 else. */
ssize_t tls_send(gnutls_session_t session, const void *data, size_t len);

void tls_close(struct tls *t); /* when no session is left; NULL is allowed */

#endif
