"""Exported MCAP files, read by the format's own library: the numbers of the recording to the last bit.

    mcap_test.py PROGRAM SOURCE_FOLDER NODE FOLDER_WITH_read_mcap.mjs
"""

import json
import math
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest

import recordings

PROGRAM, ROOT = str(pathlib.Path(sys.argv[1]).resolve()), pathlib.Path(sys.argv[2]).resolve()
NODE, READER = sys.argv[3], pathlib.Path(sys.argv[4])


def read(*files):
    run = subprocess.run([NODE, READER / "read_mcap.mjs", *files], capture_output=True, text=True, check=False)
    if run.returncode:
        raise AssertionError(run.stderr)
    return json.loads(run.stdout)


def nanoseconds(stamp):
    return stamp["sec"] * 10**9 + stamp["nanosec"]


def vector(xyz):
    return [float(xyz[axis]) for axis in "xyz"]


def pose(transform):
    rotation = transform["transform"]["rotation"]
    return [*vector(transform["transform"]["translation"]), *(rotation[axis] for axis in "wxyz")]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def skin_of_mesh(file):
    """Triangles of the group skin of a Gmsh 2.2 file; samples are its nodes, by number."""
    lines = file.read_text().splitlines()
    at = lines.index("$PhysicalNames")
    names = [line.split() for line in lines[at + 2 : at + 2 + int(lines[at + 1])]]
    group = next(number for _, number, name in names if name == '"skin"')
    at = lines.index("$Elements")
    elements = [line.split() for line in lines[at + 2 : at + 2 + int(lines[at + 1])]]
    triangles = [[int(n) for n in e[-3:]] for e in elements if e[1] == "2" and e[3] == group]
    at = {node: sample for sample, node in enumerate(sorted({n for t in triangles for n in t}))}
    return [[at[node] for node in triangle] for triangle in triangles]


class Exported(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        folder = pathlib.Path(cls.temporary.name)
        cls.recordings = [recordings.record_one_finger(PROGRAM, ROOT, folder),
                          recordings.record_two_fingers(PROGRAM, ROOT, folder),
                          recordings.record_button(PROGRAM, ROOT, folder),
                          recordings.record_sponge(PROGRAM, ROOT, folder)]
        files = [recording.with_suffix(".mcap") for recording in cls.recordings]
        for recording, file in zip(cls.recordings, files):
            recordings.run(PROGRAM, "export", recording, "--to", file)
        cls.one, cls.two, cls.button, cls.sponge = read(*files)
        cls.steps, cls.two_steps, *_ = (recordings.rows(r, "steps", "step, finger") for r in cls.recordings)
        cls.ticks, cls.two_ticks, *_ = (recordings.rows(r, "ticks", "step, finger, tick") for r in cls.recordings)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def messages(self, file, topic):
        messages = file["channels"][topic]["messages"]
        self.assertEqual([m["time"] for m in messages], sorted(m["time"] for m in messages))
        return messages

    def transforms(self, file):
        """[(parent, child, pose)], in order."""
        found = []
        for message in self.messages(file, "/tf"):
            for transform in message["value"]["transforms"]:
                self.assertEqual(nanoseconds(transform["header"]["stamp"]), message["time"])
                found.append((transform["header"]["frame_id"], transform["child_frame_id"], pose(transform)))
        return found

    def test_file_says_what_it_is(self):
        self.assertEqual(self.one["profile"], "ros2")
        self.assertRegex(self.one["library"], r"^softfinger \d")
        self.assertGreater(self.one["chunks"], 1)
        self.assertEqual(self.one["wrenches_within"], 101)
        self.assertEqual({topic: c["schema"] for topic, c in self.one["channels"].items()},
                         {"/tf": "tf2_msgs/msg/TFMessage", "/wrench": "geometry_msgs/msg/WrenchStamped",
                          "/joints": "sensor_msgs/msg/JointState", "/skin": "sensor_msgs/msg/PointCloud2",
                          "/events": "rcl_interfaces/msg/Log"})
        self.assertEqual(sorted(self.two["channels"]), ["/events", "/joints", "/tf", "/wrench"])
        facts = self.one["metadata"]["softfinger"]
        self.assertEqual(facts["device"], str(ROOT / "devices/thimble-3rrs.toml"))
        self.assertEqual(facts["simulation_rate_Hz"], "1000")
        self.assertEqual(self.two["metadata"]["softfinger"]["ring.finger"], "ring")

    def test_poses(self):
        transforms = self.transforms(self.one)
        bones = [p for parent, child, p in transforms if (parent, child) == ("world", "index")]
        self.assertEqual(bones, [[s["bone_" + k] for k in ("x_m", "y_m", "z_m", "qw", "qx", "qy", "qz")]
                                 for s in self.steps])
        tracked = [p for parent, child, p in transforms if (parent, child) == ("world", "index_tracked")]
        self.assertEqual(tracked, [[s[k] for k in ("x_m", "y_m", "z_m", "qw", "qx", "qy", "qz")]
                                   for s in self.steps if s["valid"]])
        self.assertEqual(len(tracked), len(self.steps) - len(recordings.LOST))
        self.assertEqual(self.messages(self.one, "/tf")[-1]["time"], round(self.steps[-1]["time_s"] * 1e9))

    def test_platforms_are_where_the_device_is_sent(self):
        platforms = [p for parent, child, p in self.transforms(self.one) if (parent, child) == ("index", "index_platform")]
        self.assertEqual(len(platforms), len(self.ticks))
        # Of this device pitch and roll hardly lift the platform's centre, travel does.
        travel = [recordings.doubles(t["configuration"])[2] for t in self.ticks]
        self.assertGreater(max(travel) - min(travel), 1e-3)
        heights = [p[2] for p in platforms]
        for (h0, t0), (h1, t1) in zip(zip(heights, travel), zip(heights[1:], travel[1:])):
            self.assertAlmostEqual(abs(h1 - h0), abs(t1 - t0), delta=2e-5)

    def test_objects_that_move_and_what_happens_to_them(self):
        objects = recordings.rows(self.recordings[2], "objects", "step, object")
        self.assertGreater(len(objects), 1600)
        transforms = self.transforms(self.button)
        moved = [p for parent, child, p in transforms if (parent, child) == ("world", "object_button")]
        self.assertEqual(moved, [[o[k] for k in ("x_m", "y_m", "z_m", "qw", "qx", "qy", "qz")] for o in objects])
        joints = [m["value"] for m in self.messages(self.button, "/joints") if m["value"]["name"] == ["object_button"]]
        self.assertEqual([joint["position"] for joint in joints], [[o["joint"]] for o in objects])
        self.assertLess(min(o["joint"] for o in objects), -1e-3)
        events = recordings.rows(self.recordings[2], "events", "step, number")
        told = [(m["time"], m["value"]["msg"]) for m in self.messages(self.button, "/events")]
        self.assertEqual([time for time, _ in told], [round(event["time_s"] * 1e9) for event in events])
        self.assertEqual(told[0][1], f"impact: button and index, {events[0]['impulse_N_s']:.3g} N s")
        self.assertTrue(any(text.startswith("click: button") for _, text in told), told)

    def test_nodes_of_soft_objects(self):
        self.assertEqual([topic for topic in self.sponge["channels"] if topic.endswith("/nodes")], ["/object_sponge/nodes"])
        states = recordings.rows(self.recordings[3], "object_states", "step, object")
        clouds = self.messages(self.sponge, "/object_sponge/nodes")
        self.assertEqual(len(clouds), 501)
        self.assertEqual([m["time"] for m in clouds], [1_000_000 * s["step"] for s in states])
        for message, state in list(zip(clouds, states))[::100]:
            cloud = message["value"]
            self.assertEqual([(f["name"], f["offset"], f["datatype"]) for f in cloud["fields"]], [("x", 0, 8), ("y", 8, 8), ("z", 16, 8)])
            self.assertEqual((cloud["header"]["frame_id"], cloud["point_step"]), ("world", 24))
            nodes = recordings.doubles(state["nodes"])
            self.assertEqual(struct.unpack(f"<{3 * cloud['width']}d", bytes.fromhex(cloud["data"])), nodes)

    def test_forces(self):
        wrenches = self.messages(self.one, "/wrench")
        self.assertEqual(len(wrenches), len(self.steps))
        self.assertGreater(sum(s["normal_force_N"] > 0.01 for s in self.steps), 100)
        self.assertGreater(sum(s["tangential_force_N"] > 0.01 for s in self.steps), 50)
        for message, step in zip(wrenches, self.steps):
            force = [step["normal_force_N"] * step[f"normal_{k}"] + step[f"tangential_{k}_N"] for k in "xyz"]
            wrench = message["value"]["wrench"]
            self.assertEqual(vector(wrench["force"]), force)
            self.assertEqual(vector(wrench["torque"]), cross([step[f"centroid_{k}_m"] for k in "xyz"], force))
            self.assertEqual(message["value"]["header"]["frame_id"], "index")
        # What the table does to the finger is upwards.
        self.assertGreater(wrenches[-1]["value"]["wrench"]["force"]["z"], 0.1)

    def test_joints(self):
        states = [m["value"] for m in self.messages(self.one, "/joints")]
        self.assertEqual([s["position"] for s in states], [list(recordings.doubles(t["joints"])) for t in self.ticks])
        self.assertEqual(states[0]["name"], ["index_joint_1", "index_joint_2", "index_joint_3"])

    def test_skin(self):
        states = recordings.rows(self.recordings[0], "states", "step")
        clouds = self.messages(self.one, "/skin")
        self.assertEqual(len(clouds), len(states))
        triangles = skin_of_mesh(ROOT / "fingers/index.msh")
        touching = 0
        for message, state in list(zip(clouds, states))[::60]:
            cloud = message["value"]
            self.assertEqual([(f["name"], f["offset"], f["datatype"]) for f in cloud["fields"]],
                             [("x", 0, 8), ("y", 8, 8), ("z", 16, 8), ("pressure", 24, 8), ("contact", 32, 2)])
            points = list(struct.iter_unpack("<4dB", bytes.fromhex(cloud["data"])))
            self.assertEqual(len(points), cloud["width"])
            numbers = recordings.doubles(state["samples"])
            samples = [numbers[i : i + 8] for i in range(0, len(numbers), 8)]
            self.assertEqual([(*p[:3], p[4]) for p in points], [(*s[:3], s[7]) for s in samples])
            touching += sum(p[4] for p in points)
            areas = [[0.0] * 3 for _ in samples]
            for corners in triangles:
                a, b, c = (samples[k][:3] for k in corners)
                area = cross([b[k] - a[k] for k in range(3)], [c[k] - a[k] for k in range(3)])
                for sample in corners:
                    areas[sample] = [whole + part / 6 for whole, part in zip(areas[sample], area)]
            for point, sample, area in zip(points, samples, areas):
                expected = -sum(f * n for f, n in zip(sample[4:7], area)) / sum(n * n for n in area)
                self.assertTrue(math.isclose(point[3], expected, rel_tol=1e-9, abs_tol=1e-6), (point[3], expected))
        self.assertGreater(touching, 20)

    def test_events(self):
        events = self.messages(self.one, "/events")
        self.assertEqual([(e["time"], e["value"]["msg"]) for e in events],
                         [(round(m[2] * 1e9), m[4]) for m in recordings.MESSAGES])
        self.assertEqual({(e["value"]["level"], e["value"]["name"]) for e in events}, {(20, "softfinger")})

    def test_several_fingers_have_their_names(self):
        bones = [(child, p[:3]) for parent, child, p in self.transforms(self.two) if child in ("index", "ring")]
        names = ["index", "ring"]
        self.assertEqual(bones, [(names[s["finger"]], [s["bone_x_m"], s["bone_y_m"], s["bone_z_m"]]) for s in self.two_steps])
        children = {(parent, child) for parent, child, _ in self.transforms(self.two)}
        self.assertIn(("ring", "ring_platform"), children)
        self.assertEqual([m["value"]["header"]["frame_id"] for m in self.messages(self.two, "/wrench")][:2], names)
        joints = [m["value"] for m in self.messages(self.two, "/joints")]
        self.assertEqual([(j["name"][0], j["position"]) for j in joints],
                         [(names[t["finger"]] + "_joint_1", list(recordings.doubles(t["joints"]))) for t in self.two_ticks])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
