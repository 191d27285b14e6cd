-- schema.sql -- the template database in SQLite, schema version 1.
-- Embedded in the programs at build and run in one transaction on an empty database.
-- A change of the tables is a new user_version, added as a step at the end: the statements
-- after a line "-- version 2" upgrade a database of version 1, and so on.  The statements
-- before that line stay as they are.

PRAGMA application_id = 0x53524644; -- "SRFD"
PRAGMA user_version = 1;

-- Where the master key comes from, and what it encrypts: struct vault_root of db/vault.h.
CREATE TABLE root (
    root_key  INTEGER PRIMARY KEY CHECK (root_key = 1),
    kind      INTEGER NOT NULL CHECK (kind IN (0, 1, 2)), -- in this row, a file, a passphrase
    version   INTEGER NOT NULL CHECK (version >= 1),
    passes    INTEGER NOT NULL CHECK (passes >= 0), -- of Argon2id, and its MB
    mib       INTEGER NOT NULL CHECK (mib >= 0),
    salt      BLOB NOT NULL CHECK (length(salt) = 16),
    plaintext BLOB NOT NULL CHECK (length(plaintext) = 32), -- the key itself, for kind 0
    public    BLOB NOT NULL CHECK (length(public) = 32), -- Ed25519
    secrets   BLOB NOT NULL CHECK (length(secrets) = 136),
    mac       BLOB NOT NULL CHECK (length(mac) = 32) -- by the key before it
) STRICT;

-- A person, under the client's own id, which is encrypted and found by a keyed hash.
CREATE TABLE subjects (
    subject_key INTEGER PRIMARY KEY AUTOINCREMENT,
    lookup      BLOB NOT NULL UNIQUE CHECK (length(lookup) = 32),
    uid         BLOB NOT NULL UNIQUE CHECK (length(uid) = 16),
    key         BLOB NOT NULL CHECK (length(key) = 72), -- the subject's, wrapped
    about       BLOB NOT NULL CHECK (length(about) BETWEEN 41 AND 1024),
    created     TEXT NOT NULL CHECK (created GLOB '????-??-??T??:??:??.???Z'),
    expires     TEXT CHECK (expires IS NULL OR expires GLOB '????-??-??T??:??:??.???Z'),
    seen        TEXT CHECK (seen IS NULL OR seen GLOB '????-??-??T??:??:??.???Z'),
    hold        INTEGER NOT NULL CHECK (hold IN (0, 1)),
    disabled    INTEGER NOT NULL CHECK (disabled IN (0, 1)),
    templates   INTEGER NOT NULL CHECK (templates >= 0) -- that there must be
) STRICT;

CREATE INDEX subjects_expires ON subjects (expires) WHERE expires IS NOT NULL;

-- One enrolled face.  Its points never change; what an engine made of them may be re-encoded.
CREATE TABLE templates (
    template_key INTEGER PRIMARY KEY AUTOINCREMENT,
    id           TEXT NOT NULL UNIQUE
                 CHECK (length(id) = 32 AND id NOT GLOB '*[^0-9a-f]*'),
    subject_key  INTEGER NOT NULL REFERENCES subjects (subject_key) ON DELETE CASCADE,
    same         BLOB NOT NULL CHECK (length(same) = 32), -- keyed hash of the digest
    created      TEXT NOT NULL CHECK (created GLOB '????-??-??T??:??:??.???Z'),
    engine       TEXT NOT NULL CHECK (length(engine) BETWEEN 1 AND 63),
    points       INTEGER NOT NULL CHECK (points BETWEEN 3 AND 2097152),
    triangles    INTEGER NOT NULL CHECK (triangles BETWEEN 1 AND 2 * points - 5),
    about        BLOB NOT NULL CHECK (length(about) BETWEEN 41 AND 1024),
    model        BLOB NOT NULL CHECK (length(model) > 40), -- last: lists do not
                                                           -- read it
    UNIQUE (subject_key, same)            -- the same cloud again is the same template
) STRICT;

-- Those of another engine are found without reading the rows.
CREATE INDEX templates_engine ON templates (engine, id);

-- Failed verifications of a subject in a row by one token (its id; '' without one), and the
-- time of the last.  No row: the token's last one was a match, or there was none for a month.
CREATE TABLE attempts (
    subject_key INTEGER NOT NULL REFERENCES subjects (subject_key) ON DELETE CASCADE,
    token       TEXT NOT NULL CHECK (length(token) <= 64),
    failures    INTEGER NOT NULL CHECK (failures BETWEEN 1 AND 1000000),
    at_ms       INTEGER NOT NULL CHECK (at_ms >= 0), -- since 1970, UTC
    PRIMARY KEY (subject_key, token)
) STRICT;

-- How many subjects a token has tried in an hour.
CREATE INDEX attempts_token ON attempts (token, at_ms);

-- The clouds that templates were made of, which are refused as probes: keyed hashes of the points
-- as they were read; those of the points as they were used are templates.same.
CREATE TABLE clouds (
    subject_key  INTEGER NOT NULL REFERENCES subjects (subject_key) ON DELETE CASCADE,
    digest       BLOB NOT NULL CHECK (length(digest) = 32),
    template_key INTEGER NOT NULL REFERENCES templates (template_key) ON DELETE CASCADE,
    PRIMARY KEY (subject_key, digest)
) STRICT;

CREATE INDEX clouds_template ON clouds (template_key);

-- The audit log: who did what, when, with what outcome, in two chains (db/store_chain.h):
-- 0 the changes, which are kept for ever; 1 the uses (verifications, refusals, exports), of
-- which the oldest may be cut off.  Rows are only added.  No biometrics, no tokens, no ids of
-- subjects but a keyed hash of them.  Each entry's hash is of its columns and of the hash
-- before it in its chain.  An entry of changes names the row that it leaves, by the object
-- and the row's MAC, empty where the row is gone, and the end of the uses at that time.  A
-- row of subjects, templates, tokens, devices or calibrations is good where it is the one that the
-- latest entry of its object leaves.
CREATE TABLE events (
    event_key   INTEGER PRIMARY KEY, -- the order of their coming
    chain       INTEGER NOT NULL CHECK (chain IN (0, 1)),
    seq         INTEGER NOT NULL CHECK (seq >= 1),
    at          TEXT NOT NULL CHECK (at GLOB '????-??-??T??:??:??.???Z'),
    kind        TEXT NOT NULL CHECK (length(kind) BETWEEN 1 AND 64),
    actor       TEXT NOT NULL CHECK (length(actor) <= 64),
    subject     BLOB NOT NULL CHECK (length(subject) IN (0, 16)),
    template_id TEXT NOT NULL CHECK (length(template_id) <= 32),
    outcome     TEXT NOT NULL CHECK (length(outcome) <= 64),
    object      BLOB NOT NULL CHECK (length(object) IN (0, 16)),
    row_mac     BLOB NOT NULL CHECK (length(row_mac) IN (0, 32)),
    uses        INTEGER NOT NULL CHECK (uses >= 0),
    uses_hash   BLOB NOT NULL CHECK (length(uses_hash) IN (0, 32)),
    hash        BLOB NOT NULL CHECK (length(hash) = 32),
    UNIQUE (chain, seq)
) STRICT;

-- The latest entry of an object, and of a subject's id.
CREATE INDEX events_object ON events (object, seq) WHERE chain = 0;
CREATE INDEX events_subject ON events (subject, seq) WHERE chain = 0;

-- The last event of each chain, so that none can be cut off: the MAC of its number and hash.
CREATE TABLE events_end (
    chain INTEGER PRIMARY KEY CHECK (chain IN (0, 1)),
    seq   INTEGER NOT NULL CHECK (seq >= 0),
    hash  BLOB NOT NULL CHECK (length(hash) = 32),
    mac   BLOB NOT NULL CHECK (length(mac) = 32)
) STRICT;

-- Signed events, for verifiers that have the public key alone.
CREATE TABLE checkpoints (
    chain     INTEGER NOT NULL CHECK (chain IN (0, 1)),
    seq       INTEGER NOT NULL CHECK (seq >= 1),
    at        TEXT NOT NULL CHECK (at GLOB '????-??-??T??:??:??.???Z'),
    hash      BLOB NOT NULL CHECK (length(hash) = 32),
    signature BLOB NOT NULL CHECK (length(signature) = 64),
    PRIMARY KEY (chain, seq)
) STRICT;

-- Bearer tokens: 256 random bits each, of which only a hash is kept.  What a token may do
-- (store_scopes_read()), for how long, when it was last used, to the minute; and the hash of
-- the secret that it had before it was rotated, while that is still accepted.
CREATE TABLE tokens (
    token_key INTEGER PRIMARY KEY,
    id        TEXT NOT NULL UNIQUE CHECK (length(id) = 32 AND id NOT GLOB '*[^0-9a-f]*'),
    name      TEXT NOT NULL CHECK (length(name) BETWEEN 1 AND 64),
    hash      BLOB NOT NULL UNIQUE CHECK (length(hash) = 32), -- BLAKE2b-256 of the secret
    created   TEXT NOT NULL CHECK (created GLOB '????-??-??T??:??:??.???Z'),
    revoked   TEXT CHECK (revoked IS NULL OR revoked GLOB '????-??-??T??:??:??.???Z'),
    scopes    TEXT NOT NULL CHECK (length(scopes) BETWEEN 1 AND 64),
    expires   TEXT CHECK (expires IS NULL OR expires GLOB '????-??-??T??:??:??.???Z'),
    used      TEXT CHECK (used IS NULL OR used GLOB '????-??-??T??:??:??.???Z'),
    old_hash  BLOB CHECK (old_hash IS NULL OR length(old_hash) = 32),
    old_until TEXT CHECK (old_until IS NULL OR old_until GLOB '????-??-??T??:??:??.???Z')
) STRICT;

CREATE UNIQUE INDEX tokens_old_hash ON tokens (old_hash);

-- Scanners whose captures are signed (docs/operation.md): the public keys, by name.
CREATE TABLE devices (
    device_key INTEGER PRIMARY KEY,
    id         TEXT NOT NULL UNIQUE CHECK (length(id) = 32 AND id NOT GLOB '*[^0-9a-f]*'),
    name       TEXT NOT NULL UNIQUE CHECK (length(name) BETWEEN 1 AND 32),
    public     BLOB NOT NULL CHECK (length(public) = 32), -- Ed25519
    created    TEXT NOT NULL CHECK (created GLOB '????-??-??T??:??:??.???Z')
) STRICT;

-- The nonces of captures that were taken, until they expire: each is good once.
CREATE TABLE nonces (
    until_ms INTEGER NOT NULL CHECK (until_ms >= 0), -- since 1970, UTC
    nonce    BLOB NOT NULL CHECK (length(nonce) = 16), -- its random part
    PRIMARY KEY (until_ms, nonce)
) STRICT;

-- From a score to a decision (docs/decision.md): the newest is in force.  Rows are only ever
-- added; going back to the shipped table is a new row too.
CREATE TABLE calibrations (
    calibration_key INTEGER PRIMARY KEY,
    created      TEXT NOT NULL CHECK (created GLOB '????-??-??T??:??:??.???Z'),
    actor        TEXT NOT NULL CHECK (length(actor) <= 64),
    engine       TEXT NOT NULL CHECK (length(engine) BETWEEN 1 AND 63),
    shipped      INTEGER NOT NULL CHECK (shipped IN (0, 1)), -- the engine's own table
    fmr          REAL NOT NULL CHECK (fmr > 0 AND fmr < 1),  -- that was wanted
    threshold    REAL NOT NULL CHECK (abs(threshold) < 10000),
    low          REAL NOT NULL CHECK (low <= threshold),   -- 95 % interval of it
    high         REAL NOT NULL CHECK (high >= threshold),
    subjects     INTEGER NOT NULL CHECK (subjects >= 0),
    impostors    INTEGER NOT NULL CHECK (impostors >= 0),    -- comparisons
    genuine      INTEGER NOT NULL CHECK (genuine >= 0),
    knots        BLOB NOT NULL -- score, rate of each, as little-endian IEEE 754 doubles
                 CHECK (length(knots) BETWEEN 32 AND 512 AND length(knots) % 16 = 0)
) STRICT;
