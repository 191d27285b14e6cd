/* sql_server.h -- what a database server says of itself and of the connection to it, for somebody who
 * sets it up. */
#ifndef DB_SQL_SERVER_H
#define DB_SQL_SERVER_H
#include "sql.h"

/* Advisory locks are numbers, which other programs may use too: ours begin with "SRFD", and the last
 * of them is held, shared, by each connection to a database. */
#define SQL_SERVER_LOCK   (INT64_C(0x53524644) << 32)
#define SQL_SERVER_IN_USE "6003938515404980223" /* SQL_SERVER_LOCK + 0xffffffff */

struct sql_server {
    char version[32];
    bool encrypted;   /* the connection, by TLS */
    bool local;       /* by a socket on the same machine */
    bool keeps;       /* what it has committed survives a power failure */
    bool may_define;  /* the role may make and drop tables */
    bool waits;       /* a commit waits for a standby */
    uint32_t others;  /* connections of this program, without this one */
    int64_t ahead_ms; /* its clock, against this machine's, within a round trip */
};

/* sql_server_look(t, out, e): ST_EINVAL: the database is in a file. */
enum status sql_server_look(struct sql_txn *t, struct sql_server *out, struct errinfo *e);

#endif
