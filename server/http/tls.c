#include "tls.h"

#include <errno.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <gnutls/gnutls.h>
#include <gnutls/x509.h>

#include "errinfo.h"
#include "logger.h"
#include "readfile.h"
#include "utc.h"

#define FILE_MAX ((size_t)1 << 20)

const char tls_priorities[] =
    "SECURE128:-VERS-ALL:+VERS-TLS1.3:+VERS-TLS1.2:-KX-ALL:+ECDHE-ECDSA:+ECDHE-RSA:"
    "-CIPHER-ALL:+AES-256-GCM:+CHACHA20-POLY1305:+AES-128-GCM:-MAC-ALL:+AEAD:"
    "%SERVER_PRECEDENCE:%SAFE_RENEGOTIATION";

/* The content of the files at one time; lives as long as a session or the daemon uses it. */
struct tls_files {
    struct tls *owner;
    gnutls_certificate_credentials_t credentials;
    bool clients; /* must have a certificate */
    time_t end;   /* expiry of the daemon's certificate */
    unsigned refs;
};

struct tls {
    struct tls_names names;
    pthread_mutex_t lock; /* protects current and every refs */
    struct tls_files *current;
};

/* ---- files */

/* Reads a file.  With secret, refuses a file that other users may read or write. */
static enum status read_file(const char *name, bool secret, gnutls_datum_t *out,
                             struct errinfo *e)
{
    struct stat sb;
    unsigned char *bytes;
    size_t len;
    enum status st;

    *out = (gnutls_datum_t){0};
    if (stat(name, &sb) != 0)
        return errinfo_set(e, ST_EIO, "cannot read %s: %s", name, strerror(errno));
    if (!S_ISREG(sb.st_mode))
        return errinfo_set(e, ST_EINVAL, "%s: not a file", name);
    if (secret && (sb.st_mode & (S_IROTH | S_IWOTH)) != 0)
        return errinfo_set(
            e, ST_EINVAL,
            "%s: others can read or change it (mode %03o); run: chmod o= %s", name,
            (unsigned)sb.st_mode & 0777, name);
    st = readfile_all(name, FILE_MAX, &bytes, &len, e);
    *out = (gnutls_datum_t){bytes, (unsigned)len};
    return st;
}

static void forget(gnutls_datum_t *d)
{
    if (d->data != NULL)
        gnutls_memset(d->data, 0, d->size);
    free(d->data);
}

static const char *day(time_t t, char text[UTC_TEXT])
{
    utc_print(t > 0 ? (int64_t)t * 1000 : 0, text);
    return text;
}

/* The daemon's own certificate is one that clients can accept today. */
static enum status check_certificate(const char *name, const gnutls_datum_t *pem,
                                     time_t *expires, struct errinfo *e)
{
    gnutls_x509_crt_t *list = NULL;
    unsigned n = 0;
    char text[UTC_TEXT];
    enum status st = ST_OK;
    int rc = gnutls_x509_crt_list_import2(&list, &n, pem, GNUTLS_X509_FMT_PEM,
                                          GNUTLS_X509_CRT_LIST_SORT);

    if (rc < 0 || n == 0)
        return errinfo_set(e, ST_EINVAL, "%s: not a certificate in PEM: %s", name,
                           gnutls_strerror(rc));
    *expires = gnutls_x509_crt_get_expiration_time(list[0]);
    if (*expires == (time_t)-1)
        st = errinfo_set(e, ST_EINVAL, "%s: the certificate has no expiry date", name);
    else if (*expires < time(NULL))
        st = errinfo_set(e, ST_EINVAL, "%s: the certificate expired at %s", name,
                         day(*expires, text));
    for (unsigned i = 0; i < n; i++)
        gnutls_x509_crt_deinit(list[i]);
    gnutls_free(list);
    return st;
}

static enum status read_own(const struct tls_names *names, struct tls_files *f,
                            struct errinfo *e)
{
    gnutls_datum_t cert = {0}, key = {0};
    enum status st = read_file(names->cert, false, &cert, e);
    int rc;

    if (st == ST_OK)
        st = check_certificate(names->cert, &cert, &f->end, e);
    if (st == ST_OK)
        st = read_file(names->key, true, &key, e);
    if (st == ST_OK) {
        rc = gnutls_certificate_set_x509_key_mem2(f->credentials, &cert, &key,
                                                  GNUTLS_X509_FMT_PEM, NULL, 0);
        if (rc < 0)
            st = errinfo_set(e, ST_EINVAL, "%s: not the key of %s: %s", names->key,
                             names->cert, gnutls_strerror(rc));
    }
    forget(&cert);
    forget(&key);
    return st;
}

static enum status read_ca(const char *name, struct tls_files *f, struct errinfo *e)
{
    gnutls_datum_t ca = {0};
    enum status st = read_file(name, false, &ca, e);
    int n;

    if (st == ST_OK) {
        n = gnutls_certificate_set_x509_trust_mem(f->credentials, &ca,
                                                  GNUTLS_X509_FMT_PEM);
        if (n <= 0)
            st = errinfo_set(e, ST_EINVAL, "%s: not a certificate in PEM", name);
    }
    forget(&ca);
    return st;
}

static void free_files(struct tls_files *f)
{
    if (f == NULL)
        return;
    if (f->credentials != NULL)
        gnutls_certificate_free_credentials(f->credentials);
    free(f);
}

static enum status read_all(struct tls *t, struct tls_files **out, struct errinfo *e)
{
    struct tls_files *f = calloc(1, sizeof *f);
    struct logger_line line;
    char text[UTC_TEXT];
    enum status st;

    *out = NULL;
    if (f == NULL || gnutls_certificate_allocate_credentials(&f->credentials) < 0) {
        free_files(f);
        return errinfo_memory(e);
    }
    f->owner = t;
    f->refs = 1;
    st = read_own(&t->names, f, e);
    if (st == ST_OK && t->names.client_ca != NULL) {
        f->clients = true;
        st = read_ca(t->names.client_ca, f, e);
    }
    if (st != ST_OK) {
        free_files(f);
        return st;
    }
    logger_begin(&line, "info", "TLS certificate");
    logger_text(&line, "file", t->names.cert);
    logger_text(&line, "expires", day(f->end, text));
    if (f->clients)
        logger_text(&line, "client_ca", t->names.client_ca);
    logger_end(&line);
    *out = f;
    return ST_OK;
}

time_t tls_end(struct tls *t)
{
    time_t end;

    (void)pthread_mutex_lock(&t->lock);
    end = t->current->end;
    (void)pthread_mutex_unlock(&t->lock);
    return end;
}

/* ---- sessions */

/* A client's certificate is one that the CA made, for clients, and that holds today. */
static int check_client(gnutls_session_t session)
{
    char purpose[] = GNUTLS_KP_TLS_WWW_CLIENT;
    gnutls_typed_vdata_st want = {.type = GNUTLS_DT_KEY_PURPOSE_OID,
                                  .data = (unsigned char *)purpose};
    static struct logger_seldom refused; /* the I/O thread's */
    gnutls_datum_t why = {0};
    struct logger_line line;
    unsigned status = 0;
    uint64_t n;
    int rc = gnutls_certificate_verify_peers(session, &want, 1, &status);

    if (rc == GNUTLS_E_SUCCESS && status == 0)
        return 0;
    if ((n = logger_seldom(&refused, logger_clock_ms())) > 0) {
        if (rc == GNUTLS_E_SUCCESS && gnutls_certificate_verification_status_print(
                                          status, GNUTLS_CRT_X509, &why, 0) < 0)
            why.data = NULL;
        logger_begin(&line, "warn", "client certificates refused");
        logger_count(&line, "certificates", n);
        logger_text(&line, "last",
                    why.data != NULL ? (const char *)why.data : gnutls_strerror(rc));
        logger_end(&line);
        gnutls_free(why.data);
    }
    (void)gnutls_alert_send(session, GNUTLS_AL_FATAL, GNUTLS_A_BAD_CERTIFICATE);
    return GNUTLS_E_CERTIFICATE_ERROR;
}

static void tls_release(struct tls_files *f)
{
    pthread_mutex_t *lock = &f->owner->lock;
    bool last;

    (void)pthread_mutex_lock(lock);
    last = --f->refs == 0;
    (void)pthread_mutex_unlock(lock);
    if (last)
        free_files(f);
}

struct tls_files *tls_attach(struct tls *t, gnutls_session_t session)
{
    struct tls_files *f;

    (void)pthread_mutex_lock(&t->lock);
    f = t->current;
    f->refs++;
    (void)pthread_mutex_unlock(&t->lock);
    if (gnutls_credentials_set(session, GNUTLS_CRD_CERTIFICATE, f->credentials) < 0) {
        tls_release(f);
        return NULL;
    }
    if (f->clients) {
        gnutls_certificate_server_set_request(session, GNUTLS_CERT_REQUIRE);
        gnutls_session_set_verify_function(session, check_client);
    }
    return f;
}

int tls_none(gnutls_session_t session, const gnutls_datum_t *ca, int nca,
             const gnutls_pk_algorithm_t *algorithms, int nalgorithms,
             gnutls_pcert_st **cert, unsigned *ncert, gnutls_privkey_t *key)
{
    (void)session;
    (void)ca;
    (void)nca;
    (void)algorithms;
    (void)nalgorithms;
    (void)cert;
    (void)ncert;
    (void)key;
    return -1;
}

void tls_detach(struct tls_files *f)
{
    if (f != NULL)
        tls_release(f);
}

ssize_t tls_send(gnutls_session_t session, const void *data, size_t len)
{
    size_t done = 0;

    while (done < len) { /* a record at a time */
        ssize_t n = gnutls_record_send(session, (const char *)data + done, len - done);

        if (n <= 0)
            return -1;
        done += (size_t)n;
    }
    return (ssize_t)done;
}

/* ---- start, reload, stop */

enum status tls_open(const struct tls_names *names, struct tls **out, struct errinfo *e)
{
    struct tls *t = calloc(1, sizeof *t);
    enum status st;

    *out = NULL;
    if (t == NULL)
        return errinfo_memory(e);
    t->names = *names;
    st = read_all(t, &t->current, e);
    if (st != ST_OK) {
        free(t);
        return st;
    }
    (void)pthread_mutex_init(&t->lock, NULL);
    *out = t;
    return ST_OK;
}

enum status tls_reload(struct tls *t, struct errinfo *e)
{
    struct tls_files *fresh, *old;
    enum status st = read_all(t, &fresh, e);

    if (st != ST_OK)
        return st;
    (void)pthread_mutex_lock(&t->lock);
    old = t->current;
    t->current = fresh;
    (void)pthread_mutex_unlock(&t->lock);
    tls_release(old);
    return ST_OK;
}

void tls_close(struct tls *t)
{
    if (t == NULL)
        return;
    tls_release(t->current);
    (void)pthread_mutex_destroy(&t->lock);
    free(t);
}
