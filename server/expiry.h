/* expiry.h -- tokens that will end within a month (STORE_TOKEN_SOON_S): for the metrics, and a
 * line in the log for each, once a day.  From one thread. */
#ifndef SERVER_EXPIRY_H
#define SERVER_EXPIRY_H

struct app;

struct expiry {
    double told_ms; /* logger_clock_ms() of the last log line; 0: never */
};

/* expiry_look(x, app): reads the tokens.  Where they cannot be read the log says so, and the
 * metrics stay. */
void expiry_look(struct expiry *x, const struct app *app);

#endif
