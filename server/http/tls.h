/* tls.h -- the daemon's certificate and key, by GnuTLS, and the CA whose certificates clients need.  The files are
 * read at the start and again by tls_reload(): open sessions keep the content that they began with, new ones get
 * the new content.  TLS 1.2 and 1.3 only, forward secrecy and authenticated ciphers only. */
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
    const char *cert; /* the daemon's certificate, then those between it and its CA */
    const char *key;  /* unencrypted key; refused if other users may read or write it */
    const char *client_ca; /* NULL: clients need no certificate */
};

/* GnuTLS's priority string for every session. */
extern const char tls_priorities[];

/* tls_open(names, out, e): Reads the files.  The message of an error names the file.
 *   names  its strings are borrowed until tls_close()
 * ST_OK; ST_ENOMEM; ST_EIO: a file cannot be read; ST_ESIZE: a file is larger than 1 MB; ST_EINVAL: a file has no
 * certificate or no key, they do not belong together, the certificate has expired, or other users may read
 * the key. */
enum status tls_open(const struct tls_names *names, struct tls **out, struct errinfo *e);

/* tls_reload(t, e): Reads the files again.  On an error, as of tls_open(), nothing changes.  Any thread. */
enum status tls_reload(struct tls *t, struct errinfo *e);

/* tls_end(t): Returns the time at which the current certificate expires.  Any thread. */
time_t tls_end(struct tls *t);

/* tls_attach(t, session): Gives a new session the current credentials, before its handshake.  Returns a reference
 * for tls_detach(); NULL: the session has no credentials. */
struct tls_files *tls_attach(struct tls *t, gnutls_session_t session);

/* Returns no certificate, so that the handshake fails: for a session without tls_attach(). */
gnutls_certificate_retrieve_function2 tls_none;

/* tls_detach(f): Gives back the reference; the session has ended.  NULL is allowed. */
void tls_detach(struct tls_files *f);

/* tls_send(session, data, len): Sends data that fit into the socket's buffer.  Returns len, or -1. */
ssize_t tls_send(gnutls_session_t session, const void *data, size_t len);

/* tls_close(t): Releases t; no session is left.  NULL is allowed. */
void tls_close(struct tls *t);

#endif
