"""clients/unity is laid out as Unity's manual says (docs.unity3d.com/Manual/cus-layout.html), and its copies are up to date.

    package_test.py SOURCE_FOLDER
"""

import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

ROOT = pathlib.Path(sys.argv[1]).resolve()
PACKAGE, SOURCE = ROOT / "clients/unity", ROOT / "clients/csharp/src"


def seen_by_unity(package):
    """Files and folders but for those below a folder ending with ~; samples are copied from there with what lies beside them."""
    for path in sorted(package.rglob("*")):
        hidden = [part for part in path.relative_to(package).parts if part.endswith("~")]
        if path.suffix != ".meta" and (not hidden or hidden == ["Samples~"] and path.name != "Samples~"):
            yield path


class Package(unittest.TestCase):
    def test_everything_has_a_meta_file_and_a_guid_of_its_own(self):
        guids = {}
        for path in seen_by_unity(PACKAGE):
            meta = path.with_name(path.name + ".meta")
            self.assertTrue(meta.exists(), meta)
            text = meta.read_text()
            self.assertTrue(text.startswith("fileFormatVersion: 2\nguid: "), meta)
            guid = re.search(r"^guid: ([0-9a-f]{32})$", text, re.M)[1]
            self.assertNotIn(guid, guids, f"{path} and {guids.get(guid)}")
            guids[guid] = path
            self.assertEqual("folderAsset: yes" in text, path.is_dir(), meta)
        self.assertGreater(len(guids), 40)
        self.assertEqual(len(guids), len(list(PACKAGE.rglob("*.meta"))), "a .meta of nothing")

    def test_the_manifest_names_what_is_there(self):
        manifest = json.loads((PACKAGE / "package.json").read_text())
        self.assertRegex(manifest["name"], r"^[a-z0-9-]+(\.[a-z0-9-]+)+$")
        self.assertRegex(manifest["version"], r"^\d+\.\d+\.\d+$")
        self.assertRegex(manifest["unity"], r"^\d{4}\.\d$")
        self.assertIn(f"project(softfinger VERSION {manifest['version']} ", (ROOT / "CMakeLists.txt").read_text())
        self.assertIn(f"## [{manifest['version']}]", (PACKAGE / "CHANGELOG.md").read_text())
        for sample in manifest["samples"]:
            self.assertTrue(list((PACKAGE / sample["path"]).glob("*.cs")), sample)
        self.assertEqual({pathlib.Path(sample["path"]).name for sample in manifest["samples"]},
                         {path.name for path in (PACKAGE / "Samples~").iterdir() if path.is_dir()})
        for name in ("README.md", "LICENSE.md", "Documentation~/softfinger.md"):
            self.assertTrue((PACKAGE / name).read_text(), name)

    def test_assemblies_refer_to_each_other(self):
        assemblies = {path: json.loads(path.read_text()) for path in PACKAGE.rglob("*.asmdef")}
        names = {assembly["name"] for assembly in assemblies.values()}
        self.assertEqual(names, {"Softfinger", "Softfinger.Unity", "Softfinger.Unity.Tests"})
        for path, assembly in assemblies.items():
            self.assertEqual(path.stem, assembly["name"])
            own = {name for name in assembly["references"] if not name.startswith("Unity")}
            self.assertLessEqual(own, names - {assembly["name"]})
        # The client needs no engine: what Unity compiles without it says so.
        client = next(assembly for assembly in assemblies.values() if assembly["name"] == "Softfinger")
        self.assertTrue(client["noEngineReferences"] and client["allowUnsafeCode"])
        for path in SOURCE.rglob("*.cs"):
            self.assertNotIn("UnityEngine", path.read_text(), path)

    def test_the_tool_sees_what_is_behind_and_repairs_it(self):
        with tempfile.TemporaryDirectory() as folder:
            copy = pathlib.Path(folder)
            for name in ("clients/unity", "clients/csharp/src"):
                shutil.copytree(ROOT / name, copy / name)
            (copy / "tools").mkdir()
            for name in ("LICENSE", "tools/unity_package"):
                shutil.copy(ROOT / name, copy / name)

            def tool(*arguments):
                return subprocess.run([sys.executable, copy / "tools/unity_package", *arguments], capture_output=True, text=True)

            self.assertEqual(tool("--check").stdout, "")
            self.assertEqual(tool("--check").returncode, 0)
            pose = copy / "clients/csharp/src/Pose.cs"
            pose.write_text(pose.read_text() + "\n")
            (copy / "clients/csharp/src/New.cs").write_text("class New { }\n")
            (copy / "clients/csharp/src/Errors.cs").unlink()
            (copy / "clients/unity/Runtime/Frames.cs.meta").unlink()
            before = tool("--check")
            self.assertEqual(before.returncode, 1)
            for what in ("copy Pose.cs", "copy New.cs", "remove Runtime/Softfinger/Errors.cs", "write Runtime/Frames.cs.meta"):
                self.assertIn(what, before.stdout)
            self.assertEqual(tool().returncode, 0)
            self.assertEqual(tool("--check").returncode, 0)
            mirror = copy / "clients/unity/Runtime/Softfinger"
            self.assertEqual((mirror / "Pose.cs").read_bytes(), pose.read_bytes())
            self.assertTrue((mirror / "New.cs.meta").exists() and not (mirror / "Errors.cs.meta").exists())
            # GUIDs are what projects refer to: a file that was lost gets its own again.
            self.assertEqual((copy / "clients/unity/Runtime/Frames.cs.meta").read_text(), (PACKAGE / "Runtime/Frames.cs.meta").read_text())

    def test_copies_are_equal(self):
        mirror = PACKAGE / "Runtime/Softfinger"
        sources = {path.relative_to(SOURCE): path.read_bytes() for path in SOURCE.rglob("*.cs")}
        self.assertGreater(len(sources), 10)
        self.assertEqual(sources, {path.relative_to(mirror): path.read_bytes() for path in mirror.rglob("*.cs")})

    @unittest.skipUnless(shutil.which("npm"), "npm")
    def test_npm_packs_all_of_it(self):
        packed = json.loads(subprocess.run(["npm", "pack", "--dry-run", "--json", "--offline"], cwd=PACKAGE, capture_output=True, text=True, check=True).stdout)
        self.assertEqual({file["path"] for file in packed[0]["files"]},
                         {path.relative_to(PACKAGE).as_posix() for path in PACKAGE.rglob("*") if path.is_file()})

    def test_the_project_of_net_is_read(self):
        project = xml.etree.ElementTree.parse(ROOT / "clients/csharp/Softfinger.csproj").getroot()
        self.assertEqual(project.find("PropertyGroup/LangVersion").text, "7.2")
        self.assertEqual([item.get("Include") for item in project.findall("ItemGroup/Compile")], ["src/**/*.cs"])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
