/* forge DATABASE SQL: forge_sql() for the black-box tests. */
#include <sodium.h>
#include <stdio.h>

#include "errinfo.h"
#include "forge.h"

int main(int argc, char **argv)
{
    struct errinfo e;

    if (argc != 3 || sodium_init() < 0) {
        (void)fprintf(stderr, "usage: forge DATABASE SQL\n");
        return 64;
    }
    if (forge_sql(argv[1], argv[2], &e) == ST_OK)
        return 0;
    (void)fprintf(stderr, "forge: %s\n", e.msg);
    return 1;
}
