/* Archives of `surfacectl export`.  The first byte modulo 3 selects what the others are: 0, a
 * decrypted record; 1, a whole archive; 2, records, each a length (u16) and its bytes, which
 * are encrypted here as an archive, so that the code behind decryption is reached too.
 * Nothing may be accepted after the last record, and an accepted record must be within its
 * limits. */
#include "fuzz.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "admin_archive.h"
#include "admin_record.h"
#include "crypt_file.h"
#include "errinfo.h"
#include "ident.h"

#define KIND_AT 10 /* db/FORMAT.md */

static struct crypt_file key = {
    64, "000102030405060708090a0b0c0d0e0f101112131415161718191a1b1c1d1e1f"};

static void try_record(const uint8_t *data, size_t size, struct admin_record_item *item)
{
    struct errinfo e = {ST_OK, ""};
    const enum status st = admin_record_parse(data, size, item, &e);

    if (st != ST_OK && st != ST_ECORRUPT)
        abort();
    if (st == ST_OK && item->kind == ADMIN_RECORD_TEMPLATE &&
        (item->face < data || item->face + item->len != data + size ||
         !ident_id_valid(item->template.one.id) ||
         strlen(item->template.one.digest) != 64 ||
         item->template.one.triangles > 2 * item->template.one.points))
        abort();
    if (st == ST_OK && item->kind == ADMIN_RECORD_SUBJECT &&
        !ident_subject_valid(item->subject.id))
        abort();
}

static void try_archive(FILE *from)
{
    static struct admin_record_item item;
    struct errinfo e = {ST_OK, ""};
    struct admin_archive *a = NULL;
    const unsigned char *data;
    bool last = false;
    size_t n;

    memset(&item, 0, sizeof item);
    if (admin_archive_open(from, &key, &a, &e) != ST_OK)
        return;
    while (!last && admin_archive_read(a, &data, &n, &last, &e) == ST_OK)
        try_record(data, n, &item);
    if (last && admin_archive_read(a, &data, &n, &last, &e) != ST_ECORRUPT)
        abort();
    admin_archive_close(a);
}

static void try_encrypted(const uint8_t *data, size_t size)
{
    struct errinfo e = {ST_OK, ""};
    struct admin_archive *a = NULL;
    FILE *file = tmpfile();

    if (file == NULL || admin_archive_create(file, &key, &a, &e) != ST_OK)
        abort();
    while (size >= 2) {
        size_t n = data[0] | (size_t)data[1] << 8;

        n = n < size - 2 ? n : size - 2;
        if (admin_archive_write(a, data + 2, n, n == size - 2, &e) != ST_OK)
            abort();
        data += n + 2;
        size -= n + 2;
    }
    admin_archive_close(a);
    rewind(file);
    try_archive(file);
    (void)fclose(file);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static struct admin_record_item item;
    uint8_t *copy;
    FILE *from;

    if (size < 2)
        return 0;
    if ((copy = malloc(size - 1)) == NULL)
        abort();
    memcpy(copy, data + 1, size - 1);
    switch (data[0] % 3) {
    case 0:
        memset(&item, 0, sizeof item);
        memcpy(item.subject.id, "alice", sizeof "alice");
        try_record(copy, size - 1, &item);
        break;
    case 1: /* without passphrases: deriving their keys is slow */
        if (size - 1 > KIND_AT && copy[KIND_AT] == 2)
            break;
        if ((from = fmemopen(copy, size - 1, "rb")) == NULL)
            abort();
        try_archive(from);
        (void)fclose(from);
        break;
    default:
        try_encrypted(copy, size - 1);
    }
    free(copy);
    return 0;
}
