#include "log_entry.h"

#include <inttypes.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bytes.h"
#include "errinfo.h"
#include "ident.h"

const char *log_word(enum log_name log)
{
    return log == LOG_CHANGES ? "changes" : "accesses";
}

enum status log_act(struct log_act *by, const char *actor, struct errinfo *e)
{
    if (!ident_printable(actor, 0, LOG_TEXT))
        return errinfo_set(e, ST_EINVAL, "an actor is up to %d printable characters",
                           LOG_TEXT);
    by->actor = actor;
    if (!utc_now(&by->ms))
        return errinfo_set(e, ST_EINTERNAL, "the system's clock cannot be read");
    utc_print(by->ms, by->at);
    return ST_OK;
}

/* ---- hashes */

static void add_number(crypto_generichash_state *h, uint64_t v)
{
    unsigned char out[8];

    bytes_set(out, v, sizeof out);
    (void)crypto_generichash_update(h, out, sizeof out);
}

/* With its length, so that no two entries have the same bytes. */
static void add_text(crypto_generichash_state *h, const char *text)
{
    add_number(h, strlen(text));
    (void)crypto_generichash_update(h, (const unsigned char *)text, strlen(text));
}

void log_hash(const unsigned char before[LOG_HASH], const struct log_entry *entry,
              unsigned char out[LOG_HASH])
{
    const char *const text[] = {entry->at, entry->kind, entry->actor, entry->object,
                                entry->outcome};
    crypto_generichash_state h;

    (void)crypto_generichash_init(&h, NULL, 0, LOG_HASH);
    (void)crypto_generichash_update(&h, (const unsigned char *)"surface entry 2", 16);
    (void)crypto_generichash_update(&h, before, LOG_HASH);
    add_number(&h, (uint64_t)entry->log);
    add_number(&h, entry->daemon);
    add_number(&h, entry->seq);
    (void)crypto_generichash_update(&h, entry->uid, sizeof entry->uid);
    for (size_t i = 0; i < sizeof text / sizeof *text; i++)
        add_text(&h, text[i]);
    if (entry->log == LOG_CHANGES) {
        (void)crypto_generichash_update(&h, entry->digest, sizeof entry->digest);
        add_number(&h, entry->accesses.seq);
        (void)crypto_generichash_update(&h, entry->accesses.hash, LOG_HASH);
    }
    (void)crypto_generichash_final(&h, out, LOG_HASH);
}

void log_mac(const struct crypt *c, const unsigned char hash[LOG_HASH],
             unsigned char out[CRYPT_HASH])
{
    unsigned char data[16 + LOG_HASH];

    memcpy(data, "surface log   2", 16);
    memcpy(data + 16, hash, LOG_HASH);
    crypt_mac(c, data, sizeof data, out);
}

bool log_follows(const struct crypt *c, struct log_end *at, const struct log_entry *entry)
{
    unsigned char hash[LOG_HASH], mac[CRYPT_HASH];

    log_hash(at->hash, entry, hash);
    log_mac(c, hash, mac);
    if (entry->seq != at->seq + 1 || memcmp(hash, entry->hash, sizeof hash) != 0 ||
        sodium_memcmp(mac, entry->mac, sizeof mac) != 0)
        return false;
    *at = (struct log_end){.seq = entry->seq};
    memcpy(at->hash, hash, sizeof hash);
    return true;
}

/* ---- signatures */

#define SIGNED_TEXT 256

/* What is signed, as text, so that it can be made by hand. */
static size_t signed_text(const struct log_entry *entry, const char *with,
                          char out[SIGNED_TEXT])
{
    char hash[2 * LOG_HASH + 1];

    (void)sodium_bin2hex(hash, sizeof hash, entry->hash, sizeof entry->hash);
    return (size_t)snprintf(out, SIGNED_TEXT,
                            "surface signed 3\n%" PRIu64 "\n%s\n%s\n%s\n", entry->seq,
                            entry->at, hash, with);
}

void log_sign(const struct crypt *c, struct log_entry *entry, const char *with)
{
    char text[SIGNED_TEXT];

    crypt_sign(c, text, signed_text(entry, with, text), entry->signature);
    entry->is_signed = true;
}

bool log_signed(const unsigned char public[CRYPT_KEY], const struct log_entry *entry,
                const char *with)
{
    char text[SIGNED_TEXT];

    return entry->is_signed &&
           crypt_verify(public, text, signed_text(entry, with, text), entry->signature);
}

bool log_trimmed(const struct log_entry *entry, struct log_end *to)
{
    char again[LOG_TEXT + 1];
    unsigned daemon = 0;
    struct log_end end;
    size_t n = 0;

    if (entry->log != LOG_CHANGES || strcmp(entry->kind, LOG_TRIM) != 0 ||
        sscanf(entry->outcome, "%18" SCNu64 " of daemon %4u", &end.seq, &daemon) < 1 ||
        daemon >= LOG_DAEMONS ||
        sodium_hex2bin(end.hash, LOG_HASH, entry->object, strlen(entry->object), NULL, &n,
                       NULL) != 0 ||
        n != LOG_HASH)
        return false;
    log_trim_text(daemon, end.seq, again);
    if (strcmp(again, entry->outcome) == 0)
        to[daemon] = end;
    return strcmp(again, entry->outcome) == 0;
}

void log_trim_text(uint32_t daemon, uint64_t seq, char out[LOG_TEXT + 1])
{
    if (daemon == 0)
        (void)snprintf(out, LOG_TEXT + 1, "%" PRIu64, seq);
    else
        (void)snprintf(out, LOG_TEXT + 1, "%" PRIu64 " of daemon %" PRIu32, seq, daemon);
}
