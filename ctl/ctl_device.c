/* Devices: scanners that sign their captures, with their public keys. */
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ctl_command.h"
#include "readfile.h"

#define FILE_MAX 4096

static void out_device(struct ctl *c, const struct store_device *d)
{
    char key[2 * sizeof d->public + 1];

    json_text(c->out, "id", d->id);
    json_text(c->out, "name", d->name);
    json_text(c->out, "public_key",
              sodium_bin2hex(key, sizeof key, d->public, sizeof d->public));
    json_text(c->out, "created", d->created);
}

/* ---- the key */

static bool decode(const char *text, size_t len, unsigned char *out, size_t n)
{
    size_t got;

    return sodium_base642bin(out, n, text, len, "\r\n", &got, NULL,
                             sodium_base64_VARIANT_ORIGINAL) == 0 &&
           got == n;
}

/* The key in PEM, as openssl pkey -pubout writes it: a SubjectPublicKeyInfo of RFC 8410. */
static bool decode_pem(const char *text, unsigned char key[CRYPT_KEY])
{
    static const char begin[] = "-----BEGIN PUBLIC KEY-----";
    static const unsigned char before[] = {0x30, 0x2a, 0x30, 0x05, 0x06, 0x03,
                                           0x2b, 0x65, 0x70, 0x03, 0x21, 0x00};
    unsigned char der[sizeof before + CRYPT_KEY];
    const char *from = strstr(text, begin), *end;

    if (from == NULL || (end = strstr(from += sizeof begin - 1, "-----END")) == NULL ||
        !decode(from, (size_t)(end - from), der, sizeof der) ||
        memcmp(der, before, sizeof before) != 0)
        return false;
    memcpy(key, der + sizeof before, CRYPT_KEY);
    return true;
}

static enum status read_key(struct ctl *c, const char *text, unsigned char key[CRYPT_KEY])
{
    unsigned char *file;
    size_t len;
    bool sound = false;
    enum status st;

    if ((sodium_hex2bin(key, CRYPT_KEY, text, strlen(text), NULL, &len, NULL) == 0 &&
         len == CRYPT_KEY && text[2 * CRYPT_KEY] == '\0') ||
        decode(text, strlen(text), key, CRYPT_KEY))
        return ST_OK;
    if ((st = readfile_all(text, FILE_MAX, &file, &len, &c->e)) == ST_OK)
        sound = decode_pem((const char *)file, key);
    free(file);
    if (st != ST_OK && st != ST_ESIZE)
        return st;
    return sound
               ? ST_OK
               : errinfo_set(
                     &c->e, ST_EINVAL,
                     "%.120s is not an Ed25519 public key in PEM, hexadecimal or base64",
                     text);
}

/* ---- the commands */

static enum status ctl_run_device_add(struct ctl *c)
{
    unsigned char key[CRYPT_KEY];
    struct store_device d;
    enum status st = read_key(c, c->args[1], key);

    if (st == ST_OK)
        st = store_device_add(c->store, c->actor, c->args[0], key, &d, &c->e);
    if (st != ST_OK)
        return st;
    out_device(c, &d);
    ctl_say(c, "added %s\n", d.name);
    return ST_OK;
}

static enum status ctl_run_device_list(struct ctl *c)
{
    struct store_device *d;
    size_t n;
    enum status st = store_device_list(c->store, &d, &n, &c->e);

    if (st != ST_OK)
        return st;
    json_array(c->out, "devices");
    ctl_say(c, "%-32s  %-16s  %s\n", "NAME", "ADDED (UTC)", "PUBLIC KEY");
    for (size_t i = 0; i < n; i++) {
        char key[2 * sizeof d->public + 1];

        json_object(c->out, NULL);
        out_device(c, &d[i]);
        json_close(c->out);
        ctl_say(c, "%-32s  %.10s %.5s  %s\n", d[i].name, d[i].created, d[i].created + 11,
                sodium_bin2hex(key, sizeof key, d[i].public, sizeof d->public));
    }
    json_close(c->out);
    free(d);
    return ST_OK;
}

static enum status do_remove(struct ctl *c)
{
    const char *name = c->args[0];
    const enum status st = store_device_remove(c->store, c->actor, name, &c->e);

    if (st != ST_OK)
        return st;
    json_text(c->out, "name", name);
    json_flag(c->out, "removed", true);
    ctl_say(c, "removed %s\n", name);
    return ST_OK;
}

const struct ctl_command ctl_device_add = {
    .name = "device add",
    .args = "NAME PUBLIC-KEY",
    .takes = {2, 2},
    .database = CTL_WRITES_DATABASE,
    .run = ctl_run_device_add,
    .summary = "register a scanner that signs its captures",
    .help = "The key is Ed25519: 64 hexadecimal digits, base64, or a PEM file.",
    .example = "surfacectl --db faces.db device add door-1 door-1.pem"};

const struct ctl_command ctl_device_list = {
    .name = "device list",
    .database = CTL_READS_DATABASE,
    .run = ctl_run_device_list,
    .summary = "list the devices and their public keys",
    .help = "In order of creation.",
    .example = "surfacectl --db faces.db device list"};

const struct ctl_command ctl_device_remove = {
    .name = "device remove",
    .args = "NAME",
    .takes = {1, 1},
    .database = CTL_WRITES_DATABASE,
    .run = do_remove,
    .summary = "remove a device",
    .help = "A running daemon refuses its captures at once.",
    .example = "surfacectl --db faces.db device remove door-1"};
