#include "headers.h"

#include <string.h>
#include <strings.h>

#include "capture.h"
#include "request.h"

#define BLANKS " \t"

/* One preference, s[0..len-1]: name[=value][;parameters]. */
static void take_preference(struct request *r, const char *s, size_t len)
{
    size_t name = strcspn(s, "=;, \t"), at = name;
    bool quoted;

    if (name > len || name != 6 || strncasecmp(s, "return", 6) != 0 || r->has_return)
        return;
    at += strspn(s + at, BLANKS);
    if (s[at] != '=')
        return;
    at += 1 + strspn(s + at + 1, BLANKS);
    quoted = s[at] == '"';
    s += at + quoted;
    r->has_return = true;
    r->minimal = strncasecmp(s, "minimal", 7) == 0 &&
                 strchr(quoted ? "\"" : " \t;,", s[7]) != NULL;
}

static void take_preferences(struct request *r, const char *s)
{
    while (*s != '\0') {
        size_t len;
        bool quoted = false;

        s += strspn(s, BLANKS ",");
        for (len = 0; s[len] != '\0' && (quoted || s[len] != ','); len++)
            if (s[len] == '"')
                quoted = !quoted;
        take_preference(r, s, len);
        s += len;
    }
}

/* A structured field's string (RFC 9651) has quotes round it; many clients leave them out.
 * Escapes are of no use in a key and are not read. */
static void take_key(struct request *r, const char *s)
{
    size_t len;

    s += strspn(s, BLANKS);
    len = strlen(s);
    while (len > 0 && strchr(BLANKS, s[len - 1]) != NULL)
        len--;
    if (len >= 2 && s[0] == '"' && s[len - 1] == '"') {
        s++;
        len -= 2;
    }
    r->bad_key = len == 0 || len > REQUEST_KEY_MAX || r->key[0] != '\0' || r->bad_key;
    for (size_t i = 0; i < len && !r->bad_key; i++)
        r->bad_key = s[i] < '!' || s[i] > '~' || s[i] == '"' || s[i] == '\\';
    if (!r->bad_key) {
        memcpy(r->key, s, len);
        r->key[len] = '\0';
    }
}

void headers_take(struct request *r, const char *name, const char *value)
{
    if (value == NULL)
        value = "";
    if (strcasecmp(name, "Content-Encoding") == 0)
        r->coding = r->coding == INFLATE_NONE ? inflate_coding(value) : INFLATE_OTHER;
    else if (strcasecmp(name, "Capture-Signature") == 0)
        capture_take(r, value);
    else if (strcasecmp(name, "Prefer") == 0)
        take_preferences(r, value);
    else if (strcasecmp(name, "Idempotency-Key") == 0)
        take_key(r, value);
}
