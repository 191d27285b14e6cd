/* address.h -- the address to listen on, as text. */
#ifndef SERVER_ADDRESS_H
#define SERVER_ADDRESS_H
#include <stdbool.h>
#include <sys/socket.h>

/* address_read(text, out, len): "127.0.0.1:8787", "localhost:8787", "[::1]:8787"; no name
 * is looked up.  False: it is none of these; *out and *len are then undefined. */
bool address_read(const char *text, struct sockaddr_storage *out, socklen_t *len);

/* address_is_loopback(ss): who reaches it is on this machine.  ss as address_read() made. */
bool address_is_loopback(const struct sockaddr_storage *ss);

#endif
