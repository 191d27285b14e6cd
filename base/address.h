/* address.h -- addresses as text, that to listen on, those of clients, and lists of trusted ones:
 * IPv4 or IPv6, or a Unix socket. */
#ifndef BASE_ADDRESS_H
#define BASE_ADDRESS_H
#include <stdbool.h>
#include <stdint.h>
#include <sys/socket.h>

#define ADDRESS_URL_MAX  160
#define ADDRESS_HOST_MAX 48

/* address_read(text, out, len): "127.0.0.1:8787", "localhost:8787", "[::1]:8787",
 * "unix:/run/surfaced/socket"; no name is looked up.  False: it is none of these; *out
 * and *len are then undefined. */
bool address_read(const char *text, struct sockaddr_storage *out, socklen_t *len);

/* address_is_local(sa): Returns true if only this machine can reach the address. */
bool address_is_local(const struct sockaddr *sa);

#define ADDRESS_NO_KEY UINT64_MAX

/* address_key(sa): Returns a number for what counts as one address in limits: an IPv4 address, also of an IPv6
 * socket's peer, or an IPv6 network of 64 bits, which is what one customer gets.
 * ADDRESS_NO_KEY: a Unix socket, or NULL. */
uint64_t address_key(const struct sockaddr *sa);

/* address_path(ss): the path of a Unix socket, borrowed; NULL for other addresses. */
const char *address_path(const struct sockaddr_storage *ss);

/* address_url(ss, tls, url): http://ADDR:PORT, https://ADDR:PORT or unix:PATH. */
void address_url(const struct sockaddr_storage *ss, bool tls, char url[ADDRESS_URL_MAX]);

/* address_host(sa, host): without the port, "192.0.2.1" (also of an IPv6 socket's IPv4 peer) or
 * "2001:db8::1"; "unix"; "" for NULL and other families. */
void address_host(const struct sockaddr *sa, char host[ADDRESS_HOST_MAX]);

/* address_is_list(list): is it a list of addresses and networks: "192.0.2.1", "10.0.0.0/8",
 * "2001:db8::/32", "unix", with commas between them and no spaces?  No bit may be set beyond a
 * network's prefix. */
bool address_is_list(const char *list);

/* address_in_list(list, sa): is sa one of them?  "unix": any Unix socket; an IPv6 socket's IPv4
 * peer counts as IPv4.  list: address_is_list(); it is read anew: O(length). */
bool address_in_list(const char *list, const struct sockaddr *sa);

#endif
