"""An exported HDF5 file, read by h5py: what the CSV files have, and the numbers of the recording to the last bit.

    hdf5_test.py PROGRAM SOURCE_FOLDER
"""

import csv
import math
import pathlib
import sys
import tempfile
import unittest

import h5py
import numpy as np

import recordings

PROGRAM, ROOT = str(pathlib.Path(sys.argv[1]).resolve()), pathlib.Path(sys.argv[2]).resolve()
MM, DEG, MS = 1e-3, math.pi / 180.0, 1e-3
SUFFIXES = {"N_s": "N s", "mm_per_s": "mm/s", "deg_per_s": "deg/s", "mm2": "mm2", "mm": "mm", "deg": "deg", "ms": "ms", "us": "us", "s": "s", "N": "N"}


class Exports:
    """A recording, its CSV files and its HDF5 file, open."""

    def __init__(self, record, folder):
        self.recording = record(PROGRAM, ROOT, folder)
        self.csv = folder / f"{self.recording.stem}-csv"
        file = self.recording.with_suffix(".h5")
        for to in (self.csv, file):
            recordings.run(PROGRAM, "export", self.recording, "--to", to)
        self.h5 = h5py.File(file, "r")


class Exported(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        folder = pathlib.Path(cls.temporary.name)
        cls.one = Exports(recordings.record_one_finger, folder)
        cls.two = Exports(recordings.record_two_fingers, folder)
        cls.button = Exports(recordings.record_button, folder)
        cls.sponge = Exports(recordings.record_sponge, folder)

    @classmethod
    def tearDownClass(cls):
        cls.one.h5.close()
        cls.two.h5.close()
        cls.button.h5.close()
        cls.sponge.h5.close()
        cls.temporary.cleanup()

    def assertSameBits(self, found, expected):
        self.assertGreater(len(expected), 0)
        found, expected = np.asarray(found), np.asarray(expected, float)
        self.assertEqual(found.dtype, np.float64)
        np.testing.assert_array_equal(found, expected)

    def check_table(self, group, file):
        with file.open(newline="", encoding="utf-8") as stream:
            header, *rows = csv.reader(stream)
        self.assertEqual(set(group), set(header))
        for name, texts in zip(header, zip(*rows) if rows else [()] * len(header)):
            with self.subTest(f"{file.stem}/{name}"):
                column = group[name]
                self.assertEqual(column.shape, (len(rows),))
                if h5py.check_string_dtype(column.dtype):
                    self.assertEqual(column.attrs["unit"], "")
                    self.assertEqual(list(column.asstr()[:]), list(texts))
                    continue
                unit = next((u for u in SUFFIXES if name.endswith("_" + u)), None)
                of_kind = {"objects/joint": "mm or deg"}.get(f"{file.stem}/{name}", "1")
                self.assertEqual(column.attrs["unit"], SUFFIXES[unit] if unit else of_kind)
                self.assertEqual(["" if math.isnan(v) else f"{v:.12g}" for v in column[:]], list(texts))

    def check_tables(self, exports, least):
        files = sorted(exports.csv.glob("*.csv"))
        self.assertEqual([file.stem for file in files], sorted(exports.h5))
        self.assertGreaterEqual(len(files), least)
        for file in files:
            self.check_table(exports.h5[file.stem], file)

    def test_one_finger_has_the_tables_of_the_csv(self):
        self.check_tables(self.one, 11)
        self.assertEqual([m for m in self.one.h5["messages/message"].asstr()], [m[4] for m in recordings.MESSAGES])
        lost = np.isnan(self.one.h5["pose/x_mm"][:])
        self.assertEqual(list(np.flatnonzero(lost)), list(recordings.LOST))

    def test_several_fingers_have_their_names(self):
        self.check_tables(self.two, 9)
        names = self.two.h5["contact/finger"].asstr()[:4]
        self.assertEqual(list(names), ["index", "ring", "index", "ring"])
        self.assertIn("rendering", self.two.h5["command/state"].asstr()[:])

    def test_objects_that_move_and_what_happens_to_them(self):
        self.check_tables(self.button, 9)
        objects = recordings.rows(self.button.recording, "objects", "step, object")
        self.assertSameBits(self.button.h5["objects/z_mm"], [o["z_m"] / MM for o in objects])
        self.assertSameBits(self.button.h5["objects/joint"], [o["joint"] / MM for o in objects])
        self.assertIn("click", self.button.h5["events/kind"].asstr()[:])

    def test_steps_to_the_last_bit(self):
        steps = recordings.rows(self.one.recording, "steps", "step")
        tables = self.one.h5
        self.assertGreater(sum(step["normal_force_N"] > 0.01 for step in steps), 100)
        self.assertSameBits(tables["contact/time_s"], [s["time_s"] for s in steps])
        self.assertSameBits(tables["bone/z_mm"], [s["bone_z_m"] / MM for s in steps])
        self.assertSameBits(tables["bone/qy"], [s["bone_qy"] for s in steps])
        self.assertSameBits(tables["contact/normal_force_N"], [s["normal_force_N"] for s in steps])
        self.assertSameBits(tables["contact/contact_area_mm2"], [s["contact_area_m2"] / 1e-6 for s in steps])
        self.assertSameBits(tables["contact/centroid_x_mm"],
                            [s["centroid_x_m"] / MM if s["contact_samples"] else np.nan for s in steps])
        self.assertSameBits(tables["timing/step_ms"], [s["cpu_s"] / MS for s in steps[1:]])
        tracked = [s["y_m"] / MM if s["valid"] else np.nan for s in steps]
        self.assertSameBits(tables["pose/y_mm"], tracked)

    def test_ticks_to_the_last_bit(self):
        ticks = recordings.rows(self.one.recording, "ticks", "step, tick")
        tables = self.one.h5
        self.assertSameBits(tables["configuration/time_s"], [t["time_s"] for t in ticks])
        for k, name in enumerate(("pitch_deg", "roll_deg", "travel_mm")):
            scale = DEG if name.endswith("deg") else MM
            for column, key in ((name, "configuration"), ("wanted_" + name, "wanted")):
                expected = [recordings.doubles(t[key])[k] / scale for t in ticks]
                self.assertGreater(len(set(expected)), 3)
                self.assertSameBits(tables["configuration/" + column], np.add(expected, 0.0))
        self.assertSameBits(tables["joints/joint_2_deg"], [recordings.doubles(t["joints"])[1] / DEG for t in ticks])
        self.assertEqual(list(tables["command/state"].asstr()), [t["state"] for t in ticks])

    def test_states_to_the_last_bit(self):
        states = recordings.rows(self.one.recording, "states", "step")
        nodes = np.concatenate([np.reshape(recordings.doubles(s["nodes"]), (-1, 3)) for s in states])
        samples = np.concatenate([np.reshape(recordings.doubles(s["samples"]), (-1, 8)) for s in states])
        self.assertGreater(samples[:, 7].sum(), 100)
        for k, axis in enumerate("xyz"):
            self.assertSameBits(self.one.h5[f"nodes/{axis}_mm"], nodes[:, k] / MM)
            self.assertSameBits(self.one.h5[f"samples/{axis}_mm"], samples[:, k] / MM)
            self.assertSameBits(self.one.h5[f"samples/force_{axis}_N"], samples[:, 4 + k])
        gaps = samples[:, 3] / MM
        self.assertSameBits(self.one.h5["samples/gap_mm"], np.where(np.isfinite(gaps), gaps, np.nan))
        self.assertSameBits(self.one.h5["samples/in_contact"], samples[:, 7])

    def test_nodes_of_soft_objects_to_the_last_bit(self):
        self.assertIn("object_nodes", self.sponge.h5)
        self.assertNotIn("object_nodes", self.button.h5)
        self.check_table(self.sponge.h5["object_nodes"], self.sponge.csv / "object_nodes.csv")
        states = recordings.rows(self.sponge.recording, "object_states", "step, object")
        nodes = [np.reshape(recordings.doubles(s["nodes"]), (-1, 3)) for s in states]
        self.assertEqual(len(nodes), 501)
        self.assertGreater(np.abs(nodes[-1] - nodes[0]).max(), 1e-4)
        table = self.sponge.h5["object_nodes"]
        for k, axis in enumerate("xyz"):
            self.assertSameBits(table[f"{axis}_mm"], np.add(np.concatenate(nodes)[:, k] / MM, 0.0))
        self.assertSameBits(table["node"], np.tile(np.arange(len(nodes[0])), len(nodes)))
        self.assertSameBits(table["time_s"], np.repeat([s["step"] / 1000.0 for s in states], len(nodes[0])))
        self.assertEqual(set(table["object"].asstr()[:]), {"sponge"})

    def test_attributes_say_what_was_run(self):
        one, two = self.one.h5.attrs, self.two.h5.attrs
        meta = {row["key"]: row["value"] for row in recordings.rows(self.one.recording, "meta", "key")}
        for key in ("program_version", "instruction_set", "scene", "simulation_rate_Hz"):
            self.assertEqual(one[key], meta[key], key)
        self.assertEqual(one["scene"], str(self.one.recording.with_suffix(".toml")))
        self.assertEqual(one["complete"], 1.0)
        self.assertEqual(one["device"], str(ROOT / "devices/thimble-3rrs.toml"))
        self.assertEqual(one["device_rate_Hz"], 30.0)
        self.assertEqual(two["ring.finger"], "ring")
        self.assertNotIn("device", two)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
