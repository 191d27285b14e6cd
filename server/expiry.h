/* expiry.h -- finds tokens that expire within STORE_TOKEN_SOON_S, for the metrics, and once a day for the
 * log, with a line for each.  From one thread. */
#ifndef SERVER_EXPIRY_H
#define SERVER_EXPIRY_H

struct app;

struct expiry {
    double told_ms; /* logger_clock_ms() of the last lines in the log; 0: never */
};

/* expiry_look(x, app): Reads the tokens.  If they cannot be read, logs this and leaves the metrics. */
void expiry_look(struct expiry *x, const struct app *app);

#endif
