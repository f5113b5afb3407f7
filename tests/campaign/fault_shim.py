"""Controls the faults of fault_shim.c by a mapped file; changes take effect immediately.

    shim = FaultShim(LIBRARY, folder, below=store_folder)
    subprocess.Popen(.., env=shim.environment())
    shim.error = errno.ENOSPC
"""

import mmap
import os
import struct

FIELDS = ("operations", "kill_at", "kill_how", "error", "delay_us", "clock_offset_ns")


class FaultShim:
    def __init__(self, library, folder, below):
        self.__dict__["library"], self.__dict__["below"] = library, below
        self.__dict__["path"] = os.path.join(folder, "faults")
        with open(self.path, "wb") as file:
            file.write(bytes(8 * len(FIELDS)))
        with open(self.path, "r+b") as file:
            self.__dict__["map"] = mmap.mmap(file.fileno(), 8 * len(FIELDS))

    def environment(self):
        return {**os.environ, "LD_PRELOAD": self.library, "FAULT_FILE": self.path, "FAULT_FOLDER": self.below}

    def __getattr__(self, name):
        if name not in FIELDS:
            raise AttributeError(name)
        return struct.unpack_from("<q", self.map, 8 * FIELDS.index(name))[0]

    def __setattr__(self, name, value):
        struct.pack_into("<q", self.map, 8 * FIELDS.index(name), value)

    def clear(self):
        for name in FIELDS:
            setattr(self, name, 0)
