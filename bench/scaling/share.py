#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Simulates a file server of low bandwidth for a folder, by FUSE, to compare with model.py.

    bench/scaling/share.py FOLDER MOUNT MB_A_SECOND NAMES_A_SECOND LOG [--cached]

Every read waits for its share of the bandwidth, and every lookup for its share of lookups; LOG gets totals of bytes
and names at the end. The system's cache is disabled, as if every reader were on another machine; with --cached all
readers share one. Needs the package fusepy and libfuse2.
"""
import errno
import json
import os
import sys
import threading
import time

import fuse


class Rate:
    """A queue that serves requests one by one at a fixed rate."""

    def __init__(self, rate):
        self.rate, self.free, self.lock, self.amount = rate, 0.0, threading.Lock(), 0

    def take(self, amount):
        with self.lock:
            self.amount += amount
            self.free = max(self.free, time.monotonic()) + amount / self.rate
            end = self.free
        time.sleep(max(0.0, end - time.monotonic()))


class Server(fuse.Operations):
    def __init__(self, root, bytes_s, names_s, log, cached):
        self.root, self.bytes, self.names, self.log, self.cached = root, Rate(bytes_s), Rate(names_s), log, cached

    def real(self, path):
        return os.path.join(self.root, path.lstrip("/"))

    def getattr(self, path, fh=None):
        self.names.take(1)
        try:
            status = os.lstat(self.real(path))
        except OSError as error:
            raise fuse.FuseOSError(error.errno or errno.ENOENT) from error
        return {key: getattr(status, key) for key in ("st_mode", "st_size", "st_mtime", "st_nlink", "st_uid", "st_gid", "st_ino")}

    def readdir(self, path, fh):
        return [".", "..", *os.listdir(self.real(path))]

    def open(self, path, info):
        self.names.take(1)
        info.fh = os.open(self.real(path), os.O_RDONLY)
        info.direct_io, info.keep_cache = not self.cached, self.cached
        return 0

    def read(self, path, size, offset, info):
        data = os.pread(info.fh, size, offset)
        self.bytes.take(len(data))
        return data

    def release(self, path, info):
        os.close(info.fh)
        return 0

    def destroy(self, path):
        with open(self.log, "w") as log:
            json.dump({"bytes": self.bytes.amount, "names": self.names.amount}, log)


if __name__ == "__main__":
    if len(sys.argv) not in (6, 7):
        sys.exit(__doc__)
    folder, mount, megabytes, names, log = sys.argv[1:6]
    fuse.FUSE(Server(os.path.abspath(folder), float(megabytes) * 1e6, float(names), os.path.abspath(log), "--cached" in sys.argv), mount,
              foreground=True, raw_fi=True, ro=True, attr_timeout=0 if "--cached" not in sys.argv else 1, entry_timeout=0 if "--cached" not in sys.argv else 1,
              max_read=131072)
