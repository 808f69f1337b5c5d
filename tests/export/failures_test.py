"""Exports that cannot be: one line, and nothing half-written. And what exports take of memory.

    failures_test.py PROGRAM SOURCE_FOLDER
"""

import os
import pathlib
import sqlite3
import subprocess
import sys
import tempfile
import unittest

import recordings

PROGRAM, ROOT = str(pathlib.Path(sys.argv[1]).resolve()), pathlib.Path(sys.argv[2]).resolve()
TARGETS = ["run.h5", "run.mcap", "csv"]


class Failures(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        cls.recording = recordings.record_one_finger(PROGRAM, ROOT, cls.folder)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def setUp(self):
        self.before = sorted(self.folder.iterdir())

    def export(self, to, *, recording=None, blocks=None):
        """Status and the line it said; `blocks`: KiB that a file may have."""
        limit = f"ulimit -f {blocks}; " if blocks is not None else ""
        run = subprocess.run(["bash", "-c", limit + 'exec "$@"', "-", PROGRAM, "export", recording or self.recording,
                              "--to", to], capture_output=True, text=True, check=False, cwd=self.folder)
        self.assertEqual(run.stdout, "")
        self.assertEqual(run.stderr.count("\n"), run.stderr != "", run.stderr)
        return run.returncode, run.stderr

    def refused(self, to, status, *words, **how):
        found, said = self.export(to, **how)
        self.assertEqual(found, status, said)
        for word in words:
            self.assertIn(word, said)
        self.assertEqual(sorted(self.folder.iterdir()), self.before)

    def test_no_room(self):
        for target in TARGETS:
            for blocks in (0, 1, 64, 512):
                with self.subTest(target, blocks=blocks):
                    self.refused(target, 1, target, "cannot be written", blocks=blocks)

    def test_no_folder(self):
        for target in TARGETS[:2]:
            self.refused("nowhere/" + target, 1, "nowhere/" + target, "is its folder there")
        (self.folder / "a-file").write_text("")
        self.before = sorted(self.folder.iterdir())
        for target in TARGETS:
            found, said = self.export("a-file/" + target)
            self.assertIn(found, (1, 2))
            self.assertIn("a-file/" + target, said)

    def test_unknown_endings(self):
        for name in ("run.hdf", "run.csv", "run.h5.gz"):
            self.refused(name, 2, name, ".h5 (HDF5)", ".mcap (MCAP)", "CSV")
        for folder in ("run.of.today/", "."):
            with tempfile.TemporaryDirectory() as other:
                to = f"{other}/{folder}"
                self.assertEqual(self.export(to)[0], 0)
                self.assertTrue(pathlib.Path(to, "contact.csv").is_file())

    def test_nothing_is_written_over(self):
        for target in TARGETS[:2]:
            file = self.folder / target
            file.write_text("mine")
            self.before = sorted(self.folder.iterdir())
            self.refused(target, 2, target, "exists already")
            self.assertEqual(file.read_text(), "mine")
            file.unlink()
            self.before = sorted(self.folder.iterdir())

    def test_no_recording(self):
        other = self.folder / "no.sqlite"
        other.write_bytes(self.recording.read_bytes()[:5000])
        self.before = sorted(self.folder.iterdir())
        for target in TARGETS:
            self.refused(target, 2, "no.sqlite", recording=other)
            self.refused(target, 2, "nothing.sqlite", recording="nothing.sqlite")
        other.unlink()

    def test_damage_in_the_middle(self):
        other = self.folder / "spoilt.sqlite"
        other.write_bytes(self.recording.read_bytes())
        database = sqlite3.connect(other)
        with database:
            database.execute("update steps set finger = 7 where step = 200")
        database.close()
        self.before = sorted(self.folder.iterdir())
        for target in TARGETS:
            self.refused(target, 2, "spoilt.sqlite", recording=other)
        other.unlink()

    def test_names_that_hdf5_cannot_hold(self):
        other = self.folder / "names.sqlite"
        other.write_bytes(self.recording.read_bytes())
        database = sqlite3.connect(other)
        with database:
            database.execute("update fingers set configuration_names = 'time_s,roll_deg,travel_mm'")
        database.close()
        self.before = sorted(self.folder.iterdir())
        self.refused("run.h5", 2, "names.sqlite", "names", recording=other)
        other.unlink()

    def test_a_finger_that_cannot_be_built_again_costs_its_platform_alone(self):
        other = self.folder / "older.sqlite"
        other.write_bytes(self.recording.read_bytes())
        database = sqlite3.connect(other)
        with database:
            database.execute("update files set content = 'kind = \"of another time\"' where path like '%thimble%'")
        database.close()
        with tempfile.TemporaryDirectory() as folder:
            found, said = self.export(folder + "/run.mcap", recording=other)
            self.assertEqual(found, 0)
            self.assertIn("without platforms in /tf", said)
            self.assertIn("thimble-3rrs.toml", said)
            self.assertGreater(os.path.getsize(folder + "/run.mcap"), 10**6)
        other.unlink()

    def test_memory_does_not_grow_with_the_run(self):
        """Five thousand steps and twenty-five thousand."""
        files = [self.long_recording(f"{times}.sqlite", times) for times in (16, 80)]
        for target in ("x.h5", "x.mcap", "x"):
            peaks = []
            for file in files:
                with tempfile.TemporaryDirectory() as folder:
                    pid = os.posix_spawn(PROGRAM, [PROGRAM, "export", str(file), "--to", f"{folder}/{target}"], os.environ)
                    _, status, used = os.wait4(pid, 0)
                    self.assertEqual(status, 0)
                    size = sum(f.stat().st_size for f in pathlib.Path(folder).rglob("*"))
                    peaks.append(used.ru_maxrss / 1024)
            self.assertGreater(size, 4e5)
            self.assertLess(peaks[1] - peaks[0], 2.0, f"MB more for {target}: {peaks}, of {size / 1e6} MB")
        for file in files:
            file.unlink()

    def long_recording(self, name, times):
        """The recording many times over, without its states."""
        file = self.folder / name
        file.write_bytes(self.recording.read_bytes())
        database = sqlite3.connect(file)
        with database:
            columns = [row[1] for row in database.execute("pragma table_info(steps)")][2:]
            names = ", ".join(columns)
            database.execute(
                f"with recursive k(n) as (select 1 union all select n + 1 from k where n < {times}) "
                f"insert into steps(step, finger, {names}) select step + 301 * n, finger, {names} from steps, k")
            database.execute("delete from states")
            database.execute("update meta set value = 0 where key = 'with_state'")
        database.close()
        return file


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
