"""Labelled contacts as arrays, to train on: what `softfinger study export DIR --to contacts.h5` writes.

    python3 load_contacts.py contacts.h5

Needs h5py. Contacts are read batch by batch, so that a file larger than memory does as well.
"""

import sys

import h5py
import numpy as np


class Contacts:
    """Batches of contacts in a fixed random order: displacements of the skin, and what they come from."""

    def __init__(self, path, batch=256, seed=0):
        self.file = h5py.File(path)
        self.rest_mm = self.file["mesh/rest_nodes_mm"][:]
        self.batch = batch
        rows = np.flatnonzero(self.file["converged"][:])
        self.order = np.random.default_rng(seed).permutation(rows)

    def __len__(self):
        return -(-len(self.order) // self.batch)

    def __iter__(self):
        for begin in range(0, len(self.order), self.batch):
            rows = np.sort(self.order[begin : begin + self.batch])  # as HDF5 wants them
            factors = np.stack([self.file[f"{name}_factor"][rows] for name in ("length", "breadth", "depth")], axis=1)
            yield {
                # Of each node from where it rests in that person's finger, mm, in F.
                "displacements_mm": self.file["nodes_mm"][rows] - self.rest_mm * factors[:, None, :],
                "pressure_kPa": self.file["pressure_kPa"][rows],
                "in_contact": self.file["in_contact"][rows].astype(bool),
                "normal_force_N": self.file["normal_force_N"][rows],
                "object": self.file["object"][rows],
                "radius_mm": self.file["radius_mm"][rows],
            }


def main():
    contacts = Contacts(sys.argv[1])
    print(contacts.file.attrs["title"], "by", contacts.file.attrs["program"])
    names = contacts.file["object"].attrs["names"].split(",")
    force, touched, count = np.zeros(len(names)), np.zeros(len(names)), np.zeros(len(names))
    for batch in contacts:
        for kind in range(len(names)):
            these = batch["object"] == kind
            force[kind] += batch["normal_force_N"][these].sum()
            touched[kind] += batch["in_contact"][these].sum()
            count[kind] += these.sum()
    for kind, name in enumerate(names):
        print(f"{name:8} {count[kind]:6.0f} contacts, {force[kind] / count[kind]:.2f} N on "
              f"{touched[kind] / count[kind]:.0f} samples in the mean")


if __name__ == "__main__":
    main()
