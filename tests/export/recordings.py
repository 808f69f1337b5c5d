"""Recordings to export, and what is in them, read as SQLite and by nothing of softfinger's.

Their fingers are pressed on a table and drawn along. Of the one with the whole state some steps have lost tracking, and people were told
three lines.
"""

import sqlite3
import struct
import subprocess

MESSAGES = [(1, 3, 0.003, 0.5, "stopped by pedal, at once"), (2, 40, 0.04, 0.75, 'said "no" \u00e4'),
            (3, 250, 0.25, 1.25, "released")]
LOST = range(100, 121)  # steps


def run(program, *arguments):
    return subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, check=True)


FINGER = """[[finger]]
name = "{name}"
model = "{root}/fingers/index.toml"
device = "{root}/devices/{device}.toml"
[[finger.waypoint]]
time_s = 0
position_mm = [0, {y}, 9.5]
[[finger.waypoint]]
time_s = 0.2
position_mm = [1, {y}, 6.5]
rotation_vector_deg = [0, 8, 3]
[[finger.waypoint]]
time_s = 0.3
position_mm = [2, {y}, 6.5]
rotation_vector_deg = [0, 8, 3]
"""
TABLE = '[[object]]\nshape = "plane"\n'


def record(program, file, fingers, *more):
    scene = file.with_suffix(".toml")
    scene.write_text("".join(fingers) + TABLE)
    run(program, "run", scene, "--headless", "--as-fast-as-possible", "--record", file, *more)
    return file


def record_one_finger(program, root, folder):
    """With the whole state."""
    file = record(program, folder / "one.sqlite",
                  [FINGER.format(name="index", device="thimble-3rrs", y=0, root=root)], "--record-state")
    recording = sqlite3.connect(file)
    with recording:
        recording.executemany("insert into messages values (?, ?, ?, ?, ?)", MESSAGES)
        recording.execute("update steps set valid = 0 where step between ? and ?", (LOST[0], LOST[-1]))
    recording.close()
    return file


def record_two_fingers(program, root, folder):
    """With other devices: joints of the one turn, the other's slides."""
    return record(program, folder / "two.sqlite",
                  [FINGER.format(name="index", device="thimble-3rrs", y=0, root=root),
                   FINGER.format(name="ring", device="disk-linear", y=40, root=root)])


def record_button(program, root, folder):
    """Objects that move: a button that a finger presses until it clicks."""
    file = folder / "button.sqlite"
    run(program, "run", root / "scenes/button.toml", "--headless", "--as-fast-as-possible", "--duration-s", "1.6", "--record", file)
    return file


def record_sponge(program, root, folder):
    """Something soft between two fingers, with the whole state."""
    file = folder / "sponge.sqlite"
    run(program, "run", root / "scenes/sponge.toml", "--headless", "--as-fast-as-possible", "--duration-s", "0.5", "--record", file,
        "--record-state")
    return file


def rows(file, table, order):
    """The rows of a table, by name of their columns."""
    recording = sqlite3.connect(file)
    recording.row_factory = sqlite3.Row
    found = recording.execute(f"select * from {table} order by {order}").fetchall()
    recording.close()
    return found


def doubles(blob):
    """The numbers of a blob, little-endian."""
    return struct.unpack(f"<{len(blob) // 8}d", blob)
