#!/usr/bin/env python3
"""Runs a command, or a daemon with clients, many times, ends it at a random moment, and checks the
state that is left.
usage: crash.py BUILD BASE WORK kill|power SEED TRIALS [--clients SCAN PROBE] PROGRAM ARGUMENT...
  BUILD  the programs and crash_shim.so    BASE  a folder with the state before (db, db.key, ...)
  WORK   a folder of its own               an ARGUMENT @NAME is the file NAME of the trial's
  --clients: PROGRAM is a daemon on the Unix socket WORK/socket; clients enroll the face SCAN as
         many subjects at once, verify some by PROBE, and erase them
kill   the daemon is killed when it begins a change to the folder, or in the middle of a write
power  the program ran to its end; the folder is in the state of the disk after some of its
       changes, with none or some of those that were not synced
Afterwards the database must be intact.  After a command it has the contents from before or, if
the command succeeded, those of an undisturbed run; running the command again must give the
latter, and no bytes of deleted keys and templates may be left.  After a daemon it agrees with
all responses that were received.
Trial i of seed S is trial 0 of seed S + i, except for the timing of a daemon's threads.  Exit
status 1: a trial failed; WORK is kept."""
import os
import random
import shutil
import signal
import socket
import sqlite3
import struct
import subprocess
import sys
import threading
import time
from types import SimpleNamespace

from contents import Failure, look, names

BUILD, BASE, WORK, KIND, SEED, TRIALS, *COMMAND = sys.argv[1:]
POWER, SEED, TRIALS = KIND == 'power', int(SEED), int(TRIALS)
DIR, LOG, SOCKET = WORK + '/trial', WORK + '/log', WORK + '/socket'
CLIENTS, SUBJECTS = 4, 25  # of each client
LOG_EVERY = 50  # trials of one log: another one has other random bytes and times
SECTOR = 512
NEVER = float('inf')
ANCHOR = ['--anchor', DIR + '/anchor'] if '--anchor' in COMMAND else []


def start(log=False, at=0, torn=False):
    """The program, killed at its change number `at`; 0: not at all."""
    env = dict(os.environ, LD_PRELOAD=BUILD + '/crash_shim.so', CRASH_DIR=DIR)
    env.update({'CRASH_LOG': LOG} if log else {}, **{'CRASH_AT': str(at)} if at else {},
               **{'CRASH_TORN': '1'} if torn else {})
    if os.path.exists(LOG):
        os.unlink(LOG)
    args = [DIR + '/' + a[1:] if a[0] == '@' else a for a in COMMAND]
    null = subprocess.DEVNULL
    return subprocess.Popen(args, env=env, stdin=null, stdout=null, stderr=null)


def copy_base():
    shutil.rmtree(DIR, ignore_errors=True)
    shutil.copytree(BASE, DIR)


# ---- what is in the database

def look_at_db():
    """Opened with db.key, or what the store finds instead, and with the command's anchor."""
    db = DIR + '/db'
    if not os.path.exists(db):
        return ['none']
    try:
        d = sqlite3.connect(db)
        if d.execute('PRAGMA user_version').fetchone()[0] == 0:
            return ['none']
        plaintext = d.execute('SELECT kind FROM root').fetchone()[0] == 0
        d.close()
    except sqlite3.Error as e:
        raise Failure('the database: %s' % e) from e
    return look([BUILD + '/surfacectl', '--db', db, *ANCHOR, *['--plaintext-database'] * plaintext])


def secrets():
    """Of wrapped keys and of faces."""
    if not os.path.exists(DIR + '/db'):
        return set()
    d = sqlite3.connect(DIR + '/db')
    try:
        return {bytes(row[0][:32]) for sql in ('SELECT key FROM subjects', 'SELECT substr(face, 101, 32) FROM faces')
                for row in d.execute(sql)}
    except sqlite3.OperationalError:  # no tables
        return set()
    finally:
        d.close()


def assert_gone(what):
    """No bytes of deleted secrets are left in the database and its logs."""
    for name in os.listdir(DIR):
        if name == 'db' or name.startswith('db-'):
            with open(DIR + '/' + name, 'rb') as f:
                data = f.read()
            if any(s in data for s in gone):
                raise Failure('%s: deleted secrets are in %s' % (what, name))


# ---- what is left of changes after a loss of power

CREATE, WRITE, TRUNCATE, SYNC, SYNC_DIR, RENAME, LINK, UNLINK = range(8)  # crash_shim.c
OP = struct.Struct('<IIQQ64s64s')


class Log:
    """The folder before, and what a program has changed since, by the log of crash_shim.so."""

    def __init__(self):
        self.names, self.files, self.inode, self.changes, self.text = {}, [], {}, [], b''
        for name in os.listdir(DIR):
            path = DIR + '/' + name
            self.names[name] = self.new_file(os.stat(path).st_ino)
            with open(path, 'rb') as f:
                self.files[-1] = f.read()

    def new_file(self, inode):
        self.files.append(b'')
        self.inode[inode] = len(self.files) - 1  # another's after it is gone
        return len(self.files) - 1

    def read(self):
        with open(LOG, 'rb') as f:
            self.text = f.read()
        end = 0
        while end + OP.size <= len(self.text):
            kind, n, inode, at, name, to = OP.unpack_from(self.text, end)
            data, end = end + OP.size, end + OP.size + n
            if end > len(self.text):
                break  # killed as it was written
            c = SimpleNamespace(kind=kind, file=None, at=at, data=self.text[data:end], end=end, until=NEVER,
                                name=name.split(b'\0')[0].decode(), to=to.split(b'\0')[0].decode(),
                                names=kind in (CREATE, RENAME, LINK, UNLINK))
            if kind <= SYNC:
                c.file = self.new_file(inode) if kind == CREATE else self.inode[inode]
            if kind in (SYNC, SYNC_DIR):  # covers all before it of the same file or folder
                for b in self.changes:
                    if b.until == NEVER and (b.names if kind == SYNC_DIR else not b.names and b.file == c.file):
                        b.until = len(self.changes)
            self.changes.append(c)

    def state(self, n, some, rng):
        """DIR after the first n changes: what was not synced is lost; or with some, some of it is there:
        any sectors, and names in their order."""
        names, files = dict(self.names), [bytearray(b) for b in self.files]
        left = sum(c.names and c.until >= n for c in self.changes[:n])
        left = rng.randint(0, left) if some else 0
        for c in self.changes[:n]:
            synced = c.until < n
            if c.names:
                if synced or left > 0:
                    change_name(names, c)
                    left -= not synced
            elif synced or some:
                change_bytes(files[c.file] if c.file is not None else None, c, None if synced else rng)
        shutil.rmtree(DIR, ignore_errors=True)
        os.mkdir(DIR)
        first = {}  # name of a file: its other names are links to it, as they were
        for name, file in names.items():
            if file in first:
                os.link(DIR + '/' + first[file], DIR + '/' + name)
                continue
            first[file] = name
            with open(DIR + '/' + name, 'wb') as f:
                f.write(files[file])


def change_name(names, c):
    if c.kind == CREATE:
        names[c.name] = c.file
    elif c.name in names:
        file = names[c.name] if c.kind == LINK else names.pop(c.name)
        if c.kind != UNLINK:
            names[c.to] = file


def change_bytes(b, c, rng):
    """With rng: it was not synced.  Of a write then all, nothing, or any sectors are there."""
    if c.kind == TRUNCATE and (rng is None or rng.random() < 0.5):
        b[c.at:] = bytes(max(c.at - len(b), 0))
    if c.kind != WRITE:
        return
    how = rng.randrange(4) if rng else 0
    done = 0
    while done < len(c.data):
        part = len(c.data) if how == 0 else SECTOR - (c.at + done) % SECTOR
        if how == 0 or (how > 1 and rng.random() < 0.5):
            b.extend(bytes(max(c.at + done - len(b), 0)))
            b[c.at + done:c.at + done + len(c.data[done:done + part])] = c.data[done:done + part]
        done += part


# ---- a command

def settled(ended, t):
    if ended:
        assert_gone('it ended well')
    now = look_at_db()
    if now != after and (ended or now != before):
        raise Failure('neither before nor after: %s' % now)
    t['ended well'] += ended
    t['done' if now == after else 'as before'] += 1
    start().wait()
    now = look_at_db()
    if now != after:
        raise Failure('run again: not the contents after: %s' % now)
    if names(DIR) not in files:
        raise Failure('run again: the files are %s, and should be %s' % (names(DIR), files[0]))
    assert_gone('run again')


# ---- a daemon

class Client(threading.Thread):
    """A subject: [id, when requests were sent and their responses received, in bytes of the log]."""

    def __init__(self, number, seed):
        super().__init__()
        self.number, self.rng, self.subjects = number, random.Random(seed * CLIENTS + number), []
        self.wrong = ''

    def ask(self, method, path, wanted, body=b''):
        """The response; b'': none, or another than was wanted."""
        while not dead.is_set():
            s = socket.socket(socket.AF_UNIX)
            try:
                s.connect(SOCKET)
                break
            except OSError:  # it does not listen yet
                s.close()
                time.sleep(0.005)
        else:
            return b''
        response = b''
        try:
            s.sendall(b'%s /v1/subjects/%s HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\nContent-Type: model/x-ply\r\n'
                      b'Content-Length: %d\r\n\r\n' % (method, path.encode(), len(body)) + body)
            while more := s.recv(65536):
                response += more
        except OSError:
            pass
        s.close()
        if b'\r\n\r\n' not in response:
            return b''
        if response.split()[1] != b'%d' % wanted:
            self.wrong = '%s %s: %s' % (method, path, response)
            return b''
        return response

    def run(self):
        while len(self.subjects) < SUBJECTS and not dead.is_set():
            p = SimpleNamespace(id='c%d-%d' % (self.number, len(self.subjects)), enrolled=NEVER, erase_sent=NEVER,
                                erased=NEVER)
            self.subjects.append(p)
            if not self.ask(b'POST', p.id + '/templates', 201, SCANS[0]):
                return
            p.enrolled = log_size()
            old = self.rng.choice(self.subjects)
            if old.erased != NEVER or self.rng.random() < 0.5:
                continue
            response = self.ask(b'POST', old.id + '/verify', 200, SCANS[1])
            if not response:
                return
            if b'"match"' not in response:
                self.wrong = '%s: no match' % old.id
            old.erase_sent = log_size()
            if not self.ask(b'DELETE', old.id, 200):
                return
            old.erased = log_size()


def log_size():
    return os.stat(LOG).st_size if os.path.exists(LOG) else 0


def serve(seed, log=False, at=0, torn=False):
    """A daemon and its clients; it is ended when they are done."""
    if os.path.exists(SOCKET):
        os.unlink(SOCKET)
    daemon = start(log, at, torn)
    dead.clear()
    clients[:] = [Client(i, seed) for i in range(CLIENTS)]
    for c in clients:
        c.start()
    while daemon.poll() is None:  # until the shim or we kill it
        if not any(c.is_alive() for c in clients):
            daemon.send_signal(signal.SIGKILL if at or seed % 2 == 0 else signal.SIGTERM)
        time.sleep(0.002)
    dead.set()
    for c in clients:
        c.join()
        if c.wrong:
            raise Failure(c.wrong)
    if daemon.returncode > 0 or (at and daemon.returncode == 0):
        raise Failure('the daemon ended with %d' % daemon.returncode)


def kept(at, t):
    """Does the database agree with the responses received before length `at` of the log?"""
    there = {row[0] for row in look_at_db()}
    for p in [p for c in clients for p in c.subjects]:
        if p.enrolled <= at < p.erase_sent and p.id not in there:
            raise Failure('%s is lost' % p.id)
        if p.erased <= at and p.id in there:
            raise Failure('%s was erased and is still there' % p.id)
        t['responses confirmed'] += (p.enrolled <= at) + (p.erased <= at)


# ---- trials

def record(seed):
    copy_base()
    log = Log()
    if SCANS:
        serve(seed, log=True)
    else:
        rc = start(log=True).wait()
        if rc != 0:
            raise Failure('it ends with %d without being killed' % rc)
    log.read()
    return log


def trial(log, seed, t):
    rng, n = random.Random(seed), len(log.changes)
    if POWER:
        at, some = n if rng.randrange(4) == 0 else rng.randint(0, n), rng.randrange(3) != 0
        what = 'power lost after change %d of %d, %s of the rest is kept' % (at, n, 'some' if some else 'nothing')
    else:  # failed changes are counted and are not in the log
        at, torn = rng.randint(1, n + n // 8 + 2), rng.random() < 0.5
        what = 'killed at change %d of about %d%s' % (at, n, ', torn' if torn else '')
    try:
        if POWER:
            log.state(at, some, rng)
            if SCANS:
                return kept(log.changes[at - 1].end if at else 0, t)
            return settled(at == n, t)
        copy_base()
        serve(seed, at=at, torn=torn)
        return kept(0, t)  # without a log responses count as received at 0
    except Failure as e:
        raise Failure('%s\n%s\nseed %d' % (e, what, seed))


os.umask(0o077)  # a key's file is its owner's
SCANS = []
if COMMAND[0] == '--clients':
    SCANS = [open(path, 'rb').read() for path in COMMAND[1:3]]
    COMMAND = COMMAND[3:]
dead, clients = threading.Event(), []
before, after, gone, files, log = [], [], set(), [], None
tally = {'responses confirmed': 0} if SCANS else {'ended well': 0, 'as before': 0, 'done': 0}
try:
    for i in range(TRIALS):
        if i % LOG_EVERY == 0:
            log = record(SEED + i)
            if i == 0 and not SCANS:
                after, there = look_at_db(), secrets()
                files.append(names(DIR))
                start().wait()  # and of a second run
                files.append(names(DIR))
                copy_base()
                before, gone = look_at_db(), secrets() - there
        trial(log, SEED + i, tally)
except Failure as e:
    print('FAIL: %s' % e)
    sys.exit(1)
print('%d trials, %d changes: %s' % (TRIALS, len(log.changes), ', '.join('%d %s' % (n, k) for k, n in tally.items())))
shutil.rmtree(DIR)
