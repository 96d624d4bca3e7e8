"""Digests of all files below this folder: `digest.py [making]`. HDF5 files by dataset and attribute, others whole."""
import hashlib
import os
import sys

import h5py
import numpy as np

MAKING = {"program_version", "inputs", "parameters"}
making = "making" in sys.argv[1:]


def digest(value):
    value = np.asarray(value)
    return hashlib.sha256(str(value.dtype).encode() + str(value.shape).encode() + value.tobytes()).hexdigest()[:16]


def attributes(where, item):
    for name in sorted(item.attrs):
        if making or name not in MAKING:
            print(digest(item.attrs[name]), f"{where}@{name}")


def state(path):
    with h5py.File(path) as file:
        attributes(path + ":", file)

        def visit(name, item):
            where = f"{path}:{name}"
            attributes(where, item)
            if isinstance(item, h5py.Dataset):
                print(digest(item[()]), where)

        file.visititems(visit)


for folder, folders, files in os.walk("."):
    folders.sort()
    for name in sorted(files):
        path = os.path.join(folder, name)
        if name.endswith(".hdf"):
            state(path)
        else:
            with open(path, "rb") as stream:
                print(hashlib.sha256(stream.read()).hexdigest()[:16], path)
