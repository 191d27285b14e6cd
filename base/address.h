/* address.h -- addresses as text: the daemon's own, those of clients, and lists of trusted ones.  They are
 * IPv4 or IPv6 addresses, or Unix sockets. */
#ifndef BASE_ADDRESS_H
#define BASE_ADDRESS_H
#include <stdbool.h>
#include <stdint.h>
#include <sys/socket.h>

#define ADDRESS_URL_MAX  160
#define ADDRESS_HOST_MAX 48

/* address_read(text, out, len): Reads an address like "127.0.0.1:8787", "localhost:8787", "[::1]:8787" or
 * "unix:/run/surfaced/socket".  Looks up no name.
 * Returns false if text is none of these; *out and *len are then unspecified. */
bool address_read(const char *text, struct sockaddr_storage *out, socklen_t *len);

/* address_is_local(sa): Returns true if only this machine can reach the address. */
bool address_is_local(const struct sockaddr *sa);

#define ADDRESS_NO_KEY UINT64_MAX

/* address_key(sa): Returns a number for what counts as one address in limits: an IPv4 address, also of an IPv6
 * socket's peer, or an IPv6 network of 64 bits, which is what one customer gets.
 * ADDRESS_NO_KEY: a Unix socket, or NULL. */
uint64_t address_key(const struct sockaddr *sa);

/* address_path(ss): Returns the path of a Unix socket, borrowed from *ss; NULL for another address. */
const char *address_path(const struct sockaddr_storage *ss);

/* address_url(ss, tls, url): Prints http://ADDR:PORT, https://ADDR:PORT or unix:PATH. */
void address_url(const struct sockaddr_storage *ss, bool tls, char url[ADDRESS_URL_MAX]);

/* address_host(sa, host): Prints an address without the port: "192.0.2.1" (also for the IPv4 peer of an IPv6
 * socket), "2001:db8::1" or "unix"; "" for NULL and other families. */
void address_host(const struct sockaddr *sa, char host[ADDRESS_HOST_MAX]);

/* address_is_list(list): Returns true if list has addresses and networks, separated by commas without spaces:
 * "192.0.2.1", "10.0.0.0/8", "2001:db8::/32", "unix".  No bit beyond a network's prefix may be set. */
bool address_is_list(const char *list);

/* address_in_list(list, sa): Returns true if an entry of the list contains sa.  "unix" contains all Unix
 * sockets; the IPv4 peer of an IPv6 socket counts as IPv4.
 *   list    address_is_list() is true
 * Cost: O(length of list), which is read each time. */
bool address_in_list(const char *list, const struct sockaddr *sa);

#endif
