"""What h5py reads in the golden files: `values.py FOLDER > FOLDER/values.txt`, run once, when a version is frozen. A line
per column: file, group, column, units, rows, first value, last value, sum of the finite values (of names: the words)."""
import os
import sys

import h5py
import numpy as np


def columns(group, path=""):
    for name in sorted(group):
        if name == "VTKHDF":  # hard links to columns that stand elsewhere
            continue
        item = group[name]
        if isinstance(item, h5py.Dataset):
            yield path, name, item
        else:
            yield from columns(item, f"{path}/{name}" if path else name)


folder = sys.argv[1]
for name in sorted(os.listdir(folder)):
    if not name.endswith(".hdf"):
        continue
    with h5py.File(os.path.join(folder, name)) as file:
        for group, column, item in columns(file):
            values, units = item[()], item.attrs["units"].decode().replace(" ", "_")
            head = f"{name} {group} {column} {units} {len(values)}"
            if values.dtype.kind == "S":
                print(head, values[0].decode(), values[-1].decode(), "0")
            else:
                total = float(np.sum(values[np.isfinite(values)].astype(np.float64)))
                print(head, repr(float(values[0])), repr(float(values[-1])), repr(total))
