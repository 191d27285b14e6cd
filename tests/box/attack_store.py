#!/usr/bin/env python3
"""Attacks on a database by somebody who can write its file and has an older copy, but no key.
usage: attack_store.py --list rows|pages [CLASS]   |   attack_store.py NAME DB OLD

An attack's class says what is to come of it (store-attacks.sh):
  found    by the next verification of the rows
  walk     by `check` and `audit verify`, which read the logs and the faces too
  harmless nothing: neither what it seeks nor a difference
  outright nothing can be opened any more
  anchor   an older state, which the anchor refuses (anchor.sh)
  second   found, after another subject was enrolled under the id of one who was hidden meanwhile

In `rows` are plain SQL statements, for any engine; in `pages` is what only SQLite has: its schema
table, its b-trees, its journals."""
import os
import sqlite3
import struct
import sys

ATTACKS = {}


def attack(kind, what):
    def add(f):
        ATTACKS[f.__name__] = (kind, what, f)
        return f
    return add


def connect(path):
    c = sqlite3.connect(path, isolation_level=None, timeout=10)
    c.execute('PRAGMA foreign_keys = OFF')
    c.execute('PRAGMA ignore_check_constraints = ON')
    return c


class Rows:
    """Statements on the database, and rows of the older one."""

    def __init__(self, path, old):
        self.path, self.old_path = path, old
        self.now, self.old = connect(path), connect(old)

    def run(self, sql, *values):
        return self.now.execute(sql, values).fetchall()

    def script(self, *statements):
        self.run('BEGIN')
        for sql in statements:
            self.run(sql)
        self.run('COMMIT')

    def put(self, table, where):
        """The older rows, instead of those with the same first column or besides."""
        rows = self.old.execute('SELECT * FROM %s WHERE %s' % (table, where))
        key = rows.description[0][0]
        for row in rows.fetchall():
            self.run('DELETE FROM %s WHERE %s = ?' % (table, key), row[0])
            self.run('INSERT INTO %s VALUES (%s)' % (table, ', '.join('?' * len(row))), *row)


UID = '(SELECT uid FROM subjects WHERE subject_key = %d)'
ALICE, BOB = UID % 1, UID % 2  # bob is disabled, carol (3) erased, dave (4) on hold
LAST = '(SELECT max(seq) FROM change_log)'


# ---- rows: plain SQL.  A text is a statement; a pair is Rows.put().

OF_ALICE = 'template_key IN (SELECT template_key FROM templates WHERE uid = %s)' % ALICE
ALL_OF_ALICE = [('templates', 'uid = ' + ALICE), ('faces', OF_ALICE)]
EXCHANGED = 'CREATE TEMP TABLE was AS SELECT * FROM subjects'

FOUND = {
    'token_not_revoked': ['UPDATE tokens SET revoked = NULL'],
    'token_older': [('tokens', "name = 'lost'")],
    'token_rotated_back': [('tokens', "name = 'stolen'")],
    'token_more_scopes': ["UPDATE tokens SET scopes = 'enroll,verify,read,delete,manage' WHERE name = 'door'"],
    'token_of_other_groups': ["UPDATE tokens SET groups = 'east' WHERE name = 'door'"],
    'token_made': ["INSERT INTO tokens (id, revision, name, hash, created, scopes, groups, mac) SELECT "
                   "'0123456789abcdef0123456789abcdef', 1, name, randomblob(32), created, scopes, groups, mac "
                   'FROM tokens LIMIT 1'],
    'token_secret_of_another': ["CREATE TEMP TABLE was AS SELECT hash FROM tokens WHERE name = 'door'",
                                "UPDATE tokens SET hash = zeroblob(32) WHERE name = 'door'",
                                "UPDATE tokens SET hash = (SELECT hash FROM was) WHERE name = 'x'"],
    'token_removed': ["DELETE FROM tokens WHERE name = 'lost'"],
    'subject_enabled': [('subjects', 'subject_key = 2')],
    'subject_enabled_by_bit': ['UPDATE subjects SET disabled = 0'],
    'subject_no_hold': ['UPDATE subjects SET hold = 0'],
    'subject_erased_back': [('subjects', 'subject_key = 3'), ('templates', 'uid = ' + UID % 3),
                            ('faces', OF_ALICE.replace(ALICE, UID % 3))],
    'subject_removed': ['DELETE FROM faces WHERE ' + OF_ALICE, 'DELETE FROM templates WHERE uid = ' + ALICE,
                        'DELETE FROM subjects WHERE subject_key = 1'],
    # A list begins with key 1: rekey would leave her out.
    'subject_out_of_the_lists': ['UPDATE subjects SET subject_key = -1 WHERE subject_key = 1'],
    'subjects_exchange_ids': [
        EXCHANGED, 'UPDATE subjects SET lookup = randomblob(32) WHERE subject_key IN (1, 2)',
        'UPDATE subjects SET lookup = (SELECT lookup FROM was WHERE was.subject_key = 3 - subjects.subject_key) '
        'WHERE subject_key IN (1, 2)'],
    'subjects_exchange_all_but_uid': [
        EXCHANGED, 'UPDATE subjects SET (key, about, mac) = (SELECT key, about, mac FROM was '
        'WHERE was.subject_key = 3 - subjects.subject_key) WHERE subject_key IN (1, 2)'],
    # Her row and her templates fit together: only the digest of all knows.
    'subject_older_with_all_of_hers': [('subjects', 'subject_key = 1'), 'DELETE FROM templates WHERE uid = ' + ALICE,
                                       *ALL_OF_ALICE],
    'template_deleted_back': ALL_OF_ALICE,
    'template_removed': ['DELETE FROM faces WHERE template_key = 1', 'DELETE FROM templates WHERE template_key = 1'],
    'template_given_to_another': ['UPDATE templates SET uid = %s WHERE uid = %s' % (BOB, ALICE)],
    'template_doubled': ["INSERT INTO templates SELECT 99, '0123456789abcdef0123456789abcdef', revision, uid, "
                         'zeroblob(32), read, created, engine, points, triangles, about, descriptor, mac FROM templates LIMIT 1'],
    'template_out_of_the_lists': ['UPDATE faces SET template_key = -1 WHERE template_key = 1',
                                  'UPDATE templates SET template_key = -1 WHERE template_key = 1'],
    'template_other_engine': ["UPDATE templates SET engine = 'surfaced/0 measure/0 model/0'"],
    'macs_exchanged': [EXCHANGED, 'UPDATE subjects SET mac = (SELECT mac FROM was WHERE was.subject_key = '
                       '5 - subjects.subject_key) WHERE subject_key IN (1, 4)'],
    'device_removed_back': [('devices', "name = 'gone'")],
    'device_key': ["UPDATE devices SET public = zeroblob(32) WHERE name = 'front'"],
    'device_removed': ["DELETE FROM devices WHERE name = 'front'"],
    'calibration_removed': ['DELETE FROM calibrations WHERE calibration_key = '
                            '(SELECT max(calibration_key) FROM calibrations)'],
    'calibration_threshold': ['UPDATE calibrations SET threshold = -900, low = -900'],
    'calibration_older_in_force': ['CREATE TEMP TABLE was AS SELECT * FROM calibrations WHERE calibration_key = 1',
                                   'UPDATE was SET calibration_key = 77', 'INSERT INTO calibrations SELECT * FROM was'],
    'all_older_but_the_log': [step for table in ('subjects', 'templates', 'faces', 'tokens', 'devices', 'calibrations')
                              for step in ('DELETE FROM ' + table, (table, '1 = 1'))],
    'log_older_alone': ['DELETE FROM change_log', ('change_log', '1 = 1')],
    'log_cut': ['DELETE FROM change_log WHERE seq = ' + LAST],
    'log_older_with_tokens': ['DELETE FROM change_log', ('change_log', '1 = 1'), 'DELETE FROM tokens',
                              ('tokens', '1 = 1')],
    'log_digest_of_another': ['UPDATE change_log SET digest = (SELECT digest FROM change_log WHERE seq = 2) '
                              'WHERE seq = ' + LAST],
    'log_older_entry_last': ['UPDATE change_log SET seq = 9999 WHERE seq = 3'],
    'log_forged': ["INSERT INTO change_log SELECT seq + 1, at, 'enable_subject', actor, uid, object, outcome, digest, "
                   'daemon, access_seq, access_hash, zeroblob(32), mac, signature FROM change_log WHERE seq = ' + LAST],
}
WALK = {
    'log_changed': ["UPDATE change_log SET actor = 'somebody' WHERE seq = 3"],
    'log_entry_removed': ['DELETE FROM change_log WHERE seq = 3'],
    'log_last_changed': ["UPDATE change_log SET outcome = 'x' WHERE seq = " + LAST],
    'access_changed': ["UPDATE access_log SET outcome = 'no_match' WHERE seq = 1"],
    'access_forged': ["INSERT INTO access_log SELECT daemon, seq + 1, at, kind, actor, uid, object, 'match', zeroblob(32), "
                      'mac, NULL FROM access_log ORDER BY seq DESC LIMIT 1'],
    'access_cut': ['DELETE FROM access_log'],
    'faces_exchanged': ['CREATE TEMP TABLE was AS SELECT * FROM faces WHERE template_key IN (1, 2)',
                        'UPDATE faces SET face = (SELECT face FROM was WHERE was.template_key = '
                        '3 - faces.template_key) WHERE template_key IN (1, 2)'],
    'faces_removed': ['DELETE FROM faces'],
}
HARMLESS = {
    # Another one is not the oldest for that (http-drift.sh).
    'templates_exchange_keys': ['UPDATE %s SET template_key = %d WHERE template_key = %d' % (table, b, a)
                                for table in ('faces', 'templates') for a, b in ((1, 99), (2, 1), (99, 2))],
    # What docs/threat-model.md says: attempts, nonces, last seen, last used.
    'not_protected': ['DELETE FROM attempts', 'DELETE FROM nonces', 'UPDATE subjects SET seen = NULL',
                      "UPDATE tokens SET used = '2031-01-01T00:00:00.000Z'"],
}


def steps(todo):
    def f(t):
        for one in todo:
            if isinstance(one, str):
                t.run(one)
            else:
                t.put(*one)
    return f


for what, table in ('found', FOUND), ('walk', WALK), ('harmless', HARMLESS):
    ATTACKS.update({name: ('rows', what, steps(todo)) for name, todo in table.items()})


# ---- pages: SQLite's schema, b-trees and files

class Schema:
    """The schema table, written."""

    def __init__(self, t):
        self.t = t
        t.now.execute('PRAGMA writable_schema = ON')

    def sql(self, name, new=None):
        if new is None:
            return self.t.run('SELECT sql FROM sqlite_schema WHERE name = ?', name)[0][0]
        self.t.run('UPDATE sqlite_schema SET sql = ? WHERE name = ?', new, name)
        return self.fresh()

    def replace(self, name, a, b):
        was = self.sql(name)
        assert a in was, was
        return self.sql(name, was.replace(a, b))

    def fresh(self):
        """What the connection knows of the schema is read again."""
        self.t.now.close()
        self.t.now = connect(self.t.path)
        self.t.now.execute('PRAGMA writable_schema = ON')

    def expires(self, of):
        """The index of the ends is of something else, under an unchanged schema."""
        was = self.sql('subjects_expires')
        self.t.run('DROP INDEX subjects_expires')
        self.t.run('CREATE INDEX subjects_expires ON subjects ' + of)
        self.sql('subjects_expires', was)

    def index(self, table, name, columns, where):
        """The index of a UNIQUE column with the entries that `where` leaves, under an unchanged schema."""
        was = self.sql(table)
        self.t.run("UPDATE sqlite_schema SET sql = replace(replace(sql, 'UNIQUE (uid, used)', 'CHECK (1)'), "
                   "' UNIQUE', '') WHERE name = ?", table)
        self.t.run("UPDATE sqlite_schema SET name = 'mine', sql = 'CREATE INDEX mine ON %s (%s) WHERE %s' WHERE name = ?"
                   % (table, columns, where), name)
        for other in self.t.run("SELECT name FROM sqlite_schema WHERE type = 'index' AND tbl_name = ? AND sql IS NULL",
                                table):
            self.t.run("UPDATE sqlite_schema SET type = 'other' WHERE name = ?", other[0])
        hidden = self.t.run("SELECT rowid, * FROM sqlite_schema WHERE type = 'other'")
        self.t.run("DELETE FROM sqlite_schema WHERE type = 'other'")
        self.fresh()
        self.t.run('REINDEX mine')
        self.t.run('UPDATE sqlite_schema SET name = ?, sql = NULL WHERE name = ?', name, 'mine')
        for row in hidden:
            self.t.run("INSERT INTO sqlite_schema VALUES ('index', ?, ?, ?, ?)", *row[2:6])
        self.t.run('UPDATE sqlite_schema SET sql = ? WHERE name = ?', was, table)
        self.fresh()


@attack('pages', 'found')
def index_hides_subject(t):
    Schema(t).index('subjects', 'sqlite_autoindex_subjects_2', 'lookup', 'subject_key != 1')

@attack('pages', 'found')
def index_hides_token(t):
    Schema(t).index('tokens', 'sqlite_autoindex_tokens_1', 'id', "name != ''lost''")

@attack('pages', 'found')
def index_hides_template(t):
    Schema(t).index('templates', 'sqlite_autoindex_templates_1', 'id', 'template_key != 1')

@attack('pages', 'found')
def index_hides_expiry(t):
    Schema(t).expires('(expires) WHERE expires IS NOT NULL AND hold = 0')

@attack('pages', 'found')
def index_doubles(t):
    Schema(t).expires('(created)')

@attack('pages', 'found')
def other_tree(t):
    """The older rows in a tree of their own, to which the schema leads."""
    s = Schema(t)
    t.run('CREATE TABLE twin AS SELECT * FROM tokens')
    t.run('UPDATE twin SET revoked = NULL')
    t.run("UPDATE sqlite_schema SET rootpage = (SELECT rootpage FROM sqlite_schema WHERE name = 'twin') "
          "WHERE name = 'tokens'")
    t.run("DELETE FROM sqlite_schema WHERE name = 'twin'")
    s.fresh()

@attack('pages', 'walk')
def one_tree_for_both_logs(t):
    s = Schema(t)
    t.run("UPDATE sqlite_schema SET rootpage = (SELECT rootpage FROM sqlite_schema WHERE name = 'change_log') "
          "WHERE name = 'access_log'")
    s.fresh()

@attack('pages', 'found')
def second_of_an_id(t):
    """The UNIQUE of the schema and its index gone, a row of the same id beside the first."""
    s = Schema(t)
    s.replace('subjects', 'lookup      BLOB NOT NULL UNIQUE', 'lookup      BLOB NOT NULL')
    t.run("DELETE FROM sqlite_schema WHERE name = 'sqlite_autoindex_subjects_2'")
    s.fresh()
    t.run('UPDATE subjects SET lookup = (SELECT lookup FROM subjects WHERE subject_key = 1) WHERE subject_key = 4')

@attack('pages', 'found')
def all_doubled(t):
    t.script('CREATE TABLE twin AS SELECT * FROM tokens', 'DROP TABLE tokens', 'ALTER TABLE twin RENAME TO tokens',
             'INSERT INTO tokens SELECT * FROM tokens')

@attack('pages', 'found')
def covered_by_an_index(t):
    """A full scan would read an index that has the rows as they should be; the table has older ones."""
    s = Schema(t)
    names = [d[0] for d in t.now.execute('SELECT * FROM tokens LIMIT 0').description]
    t.run('CREATE INDEX cover ON tokens (%s)' % ', '.join(names))
    row = t.run("SELECT type, name, tbl_name, rootpage, sql FROM sqlite_schema WHERE name = 'cover'")[0]
    t.run("DELETE FROM sqlite_schema WHERE name = 'cover'")
    s.fresh()
    t.put('tokens', "name = 'lost'")
    t.run('INSERT INTO sqlite_schema VALUES (?, ?, ?, ?, ?)', *row)
    s.fresh()
    t.run('CREATE TABLE IF NOT EXISTS x (a)')
    t.run('ANALYZE')
    t.run("UPDATE sqlite_stat1 SET stat = '1000000 1 1 1 1 1 1 1 1 1 1 1 1 1 sz=10' WHERE idx = 'cover'")

@attack('pages', 'found')
def generated_column(t):
    """The table says for each row that it is not revoked."""
    s = Schema(t)
    t.script('CREATE TABLE twin AS SELECT * FROM tokens', 'DELETE FROM tokens')
    s.replace('tokens', 'revoked   TEXT CHECK (revoked IS NULL OR revoked GLOB \'????-??-??T??:??:??.???Z\')',
              'revoked   TEXT GENERATED ALWAYS AS (NULL) VIRTUAL')
    names = ', '.join(d[0] for d in t.now.execute('SELECT * FROM twin LIMIT 0').description if d[0] != 'revoked')
    t.run('INSERT INTO tokens (%s) SELECT %s FROM twin' % (names, names))

@attack('pages', 'found')
def not_strict(t):
    """A number as bytes: the type is in the MAC."""
    s = Schema(t)
    sql = s.sql('subjects')
    s.sql('subjects', sql.replace(') STRICT', ')').replace('disabled    INTEGER', 'disabled    BLOB'))
    t.run("UPDATE subjects SET disabled = CAST('0' AS BLOB)")

@attack('pages', 'found')
def table_away(t):
    """The rows cannot be verified: which is a difference, not another try a minute later."""
    t.run('ALTER TABLE devices RENAME TO others')

@attack('pages', 'found')
def table_is_view(t):
    t.run('ALTER TABLE tokens RENAME TO others')
    t.run("CREATE VIEW tokens AS SELECT token_key, id, revision, name, hash, created, NULL AS revoked, scopes, groups, expires, "
          'old_hash, old_until, mac, used FROM others')

@attack('pages', 'found')
def table_is_virtual(t):
    t.run('CREATE VIRTUAL TABLE twin USING fts5(token_key, id, revision, name, hash, created, revoked, scopes, groups, expires, '
          'old_hash, old_until, mac, used)')
    t.run('INSERT INTO twin SELECT * FROM tokens')
    t.run('UPDATE twin SET revoked = NULL')
    t.run('DROP TABLE tokens')
    t.run('ALTER TABLE twin RENAME TO tokens')

@attack('pages', 'found')
def cascade(t):
    """An honest deletion takes another row along."""
    s = Schema(t)
    s.replace('tokens', ') STRICT', ', FOREIGN KEY (name) REFERENCES devices (name) ON DELETE CASCADE) STRICT')
    t.run("UPDATE tokens SET name = 'front' WHERE name = 'lost'")

@attack('pages', 'found')
def defaults_and_triggers(t):
    """Another's secret, more scopes: of each new token."""
    s = Schema(t)
    s.replace('tokens', 'old_hash  BLOB', "old_hash  BLOB DEFAULT x'%s'" % ('ab' * 32))
    s.replace('tokens', 'old_until TEXT', "old_until TEXT DEFAULT '2099-01-01T00:00:00.000Z'")
    t.run("CREATE TRIGGER more AFTER INSERT ON tokens BEGIN UPDATE tokens SET scopes = 'manage'; END")
    t.run('CREATE TRIGGER keep BEFORE DELETE ON devices BEGIN SELECT RAISE(IGNORE); END')
    t.run('CREATE TRIGGER twice AFTER UPDATE ON tokens BEGIN INSERT INTO tokens SELECT * FROM tokens; END')

@attack('pages', 'found')
def no_checks(t):
    s = Schema(t)
    sql = s.sql('change_log')
    s.sql('change_log', sql.replace('CHECK (length(hash) = 32)', '').replace(') STRICT', ')'))

@attack('pages', 'harmless')
def sequence_reset(t):
    t.run('UPDATE sqlite_sequence SET seq = 0')

# Pages as they are in the file.

class Pages:
    def __init__(self, t):
        t.run('PRAGMA wal_checkpoint(TRUNCATE)')
        self.root = dict(t.run('SELECT name, rootpage FROM sqlite_schema WHERE rootpage > 0'))
        t.now.close()
        self.path = t.path
        self.data = bytearray(open(t.path, 'rb').read())
        self.size = struct.unpack('>H', self.data[16:18])[0]

    def page(self, n):
        return self.data[(n - 1) * self.size:n * self.size]

    def put(self, n, page):
        self.data[(n - 1) * self.size:n * self.size] = page

    def add(self, page):
        self.data += page
        count = len(self.data) // self.size
        self.data[28:32] = struct.pack('>I', count)
        return count

    def interior(self, children, right):
        """A table's page with children (page, greatest key)."""
        p = bytearray(self.size)
        p[0:12] = struct.pack('>BHHHBI', 5, 0, len(children), self.size - 5 * len(children), 0, right)
        for i, (child, key) in enumerate(children):
            at = self.size - 5 * (i + 1)
            p[12 + 2 * i:14 + 2 * i] = struct.pack('>H', at)
            p[at:at + 5] = struct.pack('>IB', child, key)
        return p

    def write(self):
        with open(self.path, 'r+b') as f:
            f.write(self.data)


def exchange_cells(t, name, kind):
    """The first two of a leaf, of a table (13) or an index (10)."""
    p = Pages(t)
    page = p.page(p.root[name])
    assert page[0] == kind
    page[8:12] = page[10:12] + page[8:10]
    p.put(p.root[name], page)
    p.write()

@attack('pages', 'found')
def cells_out_of_order(t):
    """Found by a scan, but not by its key."""
    exchange_cells(t, 'tokens', 13)

@attack('pages', 'found')
def second_leaf(t):
    """The same rows in two leaves."""
    p = Pages(t)
    leaf = p.page(p.root['tokens'])
    a, b = p.add(leaf), p.add(leaf)
    p.put(p.root['tokens'], p.interior([(a, 100)], b))
    p.write()

@attack('pages', 'found')
def key_misleads(t):
    """Two leaves in their order, and above them a key by which the last row of the first is looked for in the second."""
    keys = [row[0] for row in t.run('SELECT token_key FROM tokens ORDER BY token_key')]
    p = Pages(t)
    leaf = p.page(p.root['tokens'])
    n = struct.unpack('>H', leaf[3:5])[0]
    half = n // 2
    assert leaf[0] == 13 and half > 0
    def part(first, last):
        page = bytearray(leaf)
        page[3:5] = struct.pack('>H', last - first)
        page[8:8 + 2 * (last - first)] = leaf[8 + 2 * first:8 + 2 * last]
        return p.add(page)
    p.put(p.root['tokens'], p.interior([(part(0, half), keys[half - 1] - 1)], part(half, n)))
    p.write()

@attack('pages', 'found')
def index_out_of_order(t):
    """Every key is there, but a search takes the wrong way."""
    exchange_cells(t, 'sqlite_autoindex_tokens_1', 10)

def put_back(t, *trees):
    """The first subject beside another of the same id, who was enrolled while she was hidden: each row is as it was
    written, and none is missing.  In these trees both have the id's hash."""
    lookup = t.old.execute('SELECT lookup FROM subjects WHERE subject_key = 1').fetchone()[0]
    other = os.urandom(len(lookup))
    t.run('UPDATE subjects SET lookup = ? WHERE lookup = ?', other, lookup)
    for table, where in [('subjects', 'subject_key = 1'), *ALL_OF_ALICE]:
        t.put(table, where)
    p = Pages(t)
    for name in trees:
        page = p.page(p.root[name])
        assert other in page
        p.put(p.root[name], page.replace(other, lookup))
    p.write()

@attack('pages', 'second')
def second_row(t):
    put_back(t, 'subjects')

@attack('pages', 'second')
def second_row_and_key(t):
    put_back(t, 'subjects', 'sqlite_autoindex_subjects_2')

@attack('pages', 'found')
def endless(t):
    """Pages that refer to the same ones again and again: some 10^10 rows, which nobody can read to their end."""
    p = Pages(t)
    page = p.page(p.root['devices'])
    for _ in range(4):
        child = p.add(page)
        page = p.interior([(child, 100)] * 300, child)
    p.put(p.root['devices'], page)
    p.write()

@attack('pages', 'found')
def endless_index(t):
    p = Pages(t)
    name = 'sqlite_autoindex_devices_1'
    page = p.page(p.root[name])
    cell = struct.unpack('>H', page[8:10])[0]
    payload = bytes(page[cell:cell + 1 + page[cell]])
    for _ in range(4):
        child = p.add(page)
        page = bytearray(p.size)
        n = 200
        page[0:12] = struct.pack('>BHHHBI', 2, 0, n, p.size - n * (4 + len(payload)), 0, child)
        for i in range(n):
            at = p.size - (i + 1) * (4 + len(payload))
            page[12 + 2 * i:14 + 2 * i] = struct.pack('>H', at)
            page[at:at + 4 + len(payload)] = struct.pack('>I', child) + payload
    p.put(p.root[name], page)
    p.write()

def older_tokens(t, p):
    """A page of the older file."""
    n = connect(t.old_path).execute("SELECT rootpage FROM sqlite_schema WHERE name = 'tokens'").fetchone()[0]
    with open(t.old_path, 'rb') as f:
        return f.read()[(n - 1) * p.size:n * p.size]

@attack('pages', 'found')
def leaf_older(t):
    p = Pages(t)
    p.put(p.root['tokens'], older_tokens(t, p))
    p.write()

@attack('pages', 'found')
def hot_journal(t):
    """SQLite puts the page back by itself."""
    p = Pages(t)
    page = older_tokens(t, p)
    nonce = 7
    check = (nonce + sum(page[i] for i in range(p.size - 200, 0, -200))) & 0xffffffff
    head = bytes.fromhex('d9d505f920a163d7') + struct.pack('>IIIII', 1, nonce, len(p.data) // p.size, 512, p.size)
    with open(t.path + '-journal', 'wb') as f:
        f.write(head.ljust(512, b'\0') + struct.pack('>I', p.root['tokens']) + page + struct.pack('>I', check))

@attack('pages', 'found')
def wal_left(t):
    """A WAL with an older row, of a process that was killed."""
    copy = t.path + '.copy'
    t.run('PRAGMA wal_checkpoint(TRUNCATE)')
    with open(t.path, 'rb') as f, open(copy, 'wb') as to:
        to.write(f.read())
    c = connect(copy)
    c.execute('PRAGMA journal_mode = WAL')
    c.execute('UPDATE tokens SET revoked = NULL')
    with open(copy + '-wal', 'rb') as f, open(t.path + '-wal', 'wb') as to:
        to.write(f.read())
    c.close()
    os.unlink(copy)
    os._exit(0)  # this connection would bring it in

@attack('pages', 'anchor')
def anchor_entry(t):
    """The last change of the other file, where a search finds it and the end of the log is not (anchor.sh)."""
    p, rows = Pages(t), t.old.execute('SELECT * FROM change_log ORDER BY seq DESC LIMIT 1').fetchone()
    root = p.root['change_log']
    older = bytes(p.page(root))
    t.now = connect(t.path)
    t.run('DELETE FROM change_log')
    t.run('INSERT INTO change_log VALUES (%s)' % ', '.join('?' * len(rows)), *rows)
    p = Pages(t)
    entry, rest = p.add(bytes(p.page(root))), p.add(older)
    p.put(root, p.interior([(entry, 120)], rest))
    p.write()

@attack('pages', 'outright')
def key_record_plaintext(t):
    t.run('UPDATE root SET kind = 0, plaintext = zeroblob(32)')

@attack('pages', 'outright')
def key_record_other(t):
    t.run('UPDATE root SET secrets = zeroblob(136)')

@attack('pages', 'outright')
def another_program(t):
    t.run('PRAGMA application_id = 1')


def main():
    if sys.argv[1] == '--list':
        print('\n'.join(n for n, (kind, what, _) in ATTACKS.items()
                        if kind == sys.argv[2] and what in sys.argv[3:]))
        return
    t = Rows(sys.argv[2], sys.argv[3])
    ATTACKS[sys.argv[1]][2](t)
    t.now.close()


main()
