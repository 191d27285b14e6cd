#include "store.h"

#include <sodium.h>
#include <string.h>

#include "bytes.h"
#include "rows_device.h"
#include "store_txn.h"
#include "utc.h"

#define CODING sodium_base64_VARIANT_URLSAFE_NO_PADDING
#define RANDOM 16
#define MAC    16

static const char label[16] = "surface nonce";

static void mac_of(const struct log_txn *t, const unsigned char nonce[STORE_NONCE],
                   unsigned char out[MAC])
{
    unsigned char text[sizeof label + STORE_NONCE - MAC], mac[CRYPT_HASH];

    memcpy(text, label, sizeof label);
    memcpy(text + sizeof label, nonce, STORE_NONCE - MAC);
    crypt_mac(t->crypt, text, sizeof text, mac);
    memcpy(out, mac, MAC);
}

enum status store_capture_nonce(struct store *s, char nonce[STORE_NONCE_TEXT + 1],
                                char expires[32], struct errinfo *e)
{
    unsigned char raw[STORE_NONCE];
    struct log_txn t;
    enum status st;

    if ((st = store_begin(s, SQL_READ, &t, e)) != ST_OK)
        return st;
    bytes_set(raw, (uint64_t)t.by.ms, 8);
    randombytes_buf(raw + 8, RANDOM);
    mac_of(&t, raw, raw + STORE_NONCE - MAC);
    (void)sodium_bin2base64(nonce, STORE_NONCE_TEXT + 1, raw, sizeof raw, CODING);
    utc_print(t.by.ms + STORE_NONCE_LIFE_MS, expires);
    return store_end(s, &t, ST_OK, e);
}

/* Is it one of ours? */
static bool read_nonce(const struct log_txn *t, const char *text,
                       unsigned char out[STORE_NONCE])
{
    unsigned char mac[MAC];
    size_t n;

    if (sodium_base642bin(out, STORE_NONCE, text, strlen(text), NULL, &n, NULL, CODING) !=
            0 ||
        n != STORE_NONCE)
        return false;
    mac_of(t, out, mac);
    return sodium_memcmp(mac, out + STORE_NONCE - MAC, MAC) == 0;
}

static enum status store_capture_look(struct store *s, const struct store_capture *c,
                                      unsigned char nonce[STORE_NONCE],
                                      enum store_captured *out, struct errinfo *e)
{
    struct rows_device d;
    struct log_txn t;
    bool ours;
    enum status st = store_begin(s, SQL_READ, &t, e);

    if (st != ST_OK)
        return st;
    st = rows_device_find(&t, c->device, &d, e);
    ours = read_nonce(&t, c->nonce, nonce);
    *out = STORE_CAPTURED;
    if (st == ST_ENOTFOUND) {
        *out = STORE_CAPTURE_UNKNOWN;
        st = ST_OK;
    }
    if ((st = store_end(s, &t, st, e)) != ST_OK || *out != STORE_CAPTURED)
        return st;
    if (!crypt_verify(d.one.public, c->text, c->len, c->signature))
        *out = STORE_CAPTURE_FORGED;
    else if (!ours)
        *out = STORE_CAPTURE_FOREIGN;
    return ST_OK;
}

static enum status use(struct store *s, const unsigned char nonce[STORE_NONCE],
                       int64_t until_ms, int64_t now_ms, bool *was_used,
                       struct errinfo *e)
{
    struct log_txn t;
    uint64_t n = 0;
    enum status st =
        store_begin_use(s, NULL, SQL_WRITE, &(struct store_use){.subject = 0}, &t, e);

    if (st != ST_OK)
        return st;
    st = SQL_RUN(t.sql, e,
                 "INSERT INTO nonces (until_ms, nonce) VALUES ($1, $2) "
                 "ON CONFLICT DO NOTHING",
                 sql_int(until_ms), sql_blob(nonce + 8, RANDOM));
    if (st == ST_OK)
        st = sql_changed(t.sql, &n, e);
    *was_used = st == ST_OK && n == 0;
    if (st == ST_OK)
        st = SQL_RUN(t.sql, e, "DELETE FROM nonces WHERE until_ms < $1",
                     sql_int(now_ms - STORE_NONCE_KEPT_MS));
    return store_end(s, &t, st, e);
}

enum status store_capture_take(struct store *s, const struct store_capture *c,
                               enum store_captured *out, struct errinfo *e)
{
    unsigned char nonce[STORE_NONCE];
    int64_t ms, made_ms;
    bool was_used;
    enum status st;

    if ((st = store_capture_look(s, c, nonce, out, e)) != ST_OK ||
        *out != STORE_CAPTURED || (st = store_rules_now(&ms, e)) != ST_OK)
        return st;
    made_ms = (int64_t)bytes_number(nonce, 8);
    if (made_ms > ms + STORE_AHEAD_MS || made_ms + STORE_NONCE_LIFE_MS < ms) {
        *out = STORE_CAPTURE_STALE;
        return ST_OK;
    }
    st = use(s, nonce, made_ms + STORE_NONCE_LIFE_MS, ms, &was_used, e);
    if (st == ST_OK && was_used)
        *out = STORE_CAPTURE_REPLAYED;
    return st;
}
