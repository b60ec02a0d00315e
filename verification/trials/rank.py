#!/usr/bin/env python3
"""Gives the sums of the density profile in a file of results sixteen axes, with the digest that a whole file has. usage: rank.py FILE.h5"""

import pathlib
import sys

import h5py

from fuzz import DIGEST, crc64

file = pathlib.Path(sys.argv[1])
whole = file.read_bytes()
file.write_bytes(whole[:whole.rindex(DIGEST)])
with h5py.File(file, "r+") as result:
    sums = result["observables/density_profile/sum"][()]
    del result["observables/density_profile/sum"]
    result["observables/density_profile/sum"] = sums.reshape(sums.shape + (1,) * 14)
data = file.read_bytes()
file.write_bytes(data + DIGEST + b"%016x\n" % crc64(data))
