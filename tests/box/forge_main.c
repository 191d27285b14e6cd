/* forge DATABASE KEY SQL: forge_sql() for the black-box tests. */
#include <sodium.h>
#include <stdio.h>

#include "errinfo.h"
#include "forge.h"
#include "store.h"

int main(int argc, char **argv)
{
    struct store_key key = {.make = CRYPT_FILE};
    struct errinfo e;

    if (argc != 4 || sodium_init() < 0) {
        (void)fprintf(stderr, "usage: forge DATABASE KEY SQL\n");
        return 64;
    }
    key.path = argv[2];
    if (forge_sql(argv[1], &key, argv[3], &e) == ST_OK)
        return 0;
    (void)fprintf(stderr, "forge: %s\n", e.msg);
    return 1;
}
