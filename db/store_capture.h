/* store_capture.h -- captures that a device signed: a nonce for each, and whether it is one.
 *
 * A nonce is a time, 128 random bits and a MAC by the database's key: nothing is kept of it until
 * it is used, so that asking for many costs no room; then it is kept until it expires, so that
 * each is good once, whichever process is asked.  Bytes, as base64url without padding: */
#ifndef DB_STORE_CAPTURE_H
#define DB_STORE_CAPTURE_H
#include "store_open.h"

#define STORE_NONCE         40 /* bytes: i64 ms since 1970, 16 random, 16 of the MAC */
#define STORE_NONCE_TEXT    54
#define STORE_NONCE_LIFE_MS 120000

/* store_capture_nonce(s, nonce, expires, e): a new one. */
enum status store_capture_nonce(struct store *s, char nonce[STORE_NONCE_TEXT + 1],
                                char expires[32], struct errinfo *e);

struct store_capture {
    const char *device, *nonce; /* as the capture names them: anything */
    const void *text;           /* of len bytes, that the device has signed */
    size_t len;
    unsigned char signature[CRYPT_SIGN];
};

enum store_captured { /* the first of these that it is */
                      STORE_CAPTURED,
                      STORE_CAPTURE_UNKNOWN,  /* there is no such device */
                      STORE_CAPTURE_FORGED,   /* the device has not signed this */
                      STORE_CAPTURE_FOREIGN,  /* the nonce is none of this database's */
                      STORE_CAPTURE_STALE,    /* it has expired */
                      STORE_CAPTURE_REPLAYED, /* it was used before */
};

/* store_capture_take(s, c, out, e): the nonce is used then.
 * Returns ST_OK whatever *out says; ST_ECORRUPT: the device's row. */
enum status store_capture_take(struct store *s, const struct store_capture *c,
                               enum store_captured *out, struct errinfo *e);

#endif
