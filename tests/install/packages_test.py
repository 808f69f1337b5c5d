"""What the Debian packages hold and say: made of the build as it is, neither stripped nor compressed nor with the
libraries' packages looked up, which takes most of the time; `./dev test --all` installs those of ./dev package.

    packages_test.py BUILD_FOLDER SOURCE_FOLDER
"""

import gzip
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

BUILD, SOURCE = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
FASTER = {"CPACK_STRIP_FILES": "OFF", "CPACK_DEBIAN_PACKAGE_SHLIBDEPS": "OFF", "CPACK_DEBIAN_COMPRESSION_TYPE": "none"}
HOLDS = {
    "softfinger": {
        "usr/bin/softfinger", "usr/bin/softfinger-guard", "usr/lib/udev/rules.d/60-softfinger.rules",
        "usr/share/applications/softfinger.desktop", "usr/share/bash-completion/completions/softfinger",
        "usr/share/fish/vendor_completions.d/softfinger.fish", "usr/share/man/man1/softfinger-guard.1.gz",
        "usr/share/man/man1/softfinger.1.gz", "usr/share/zsh/vendor-completions/_softfinger",
    },
    "libsoftfinger0": {"libsoftfinger.so.0", "softfinger-pagmo.so"},
    "softfinger-mpi": {"softfinger-mpi.so"},
    "libsoftfinger-dev": {*(f"usr/share/doc/libsoftfinger-dev/examples/{name}" for name in ("c_program/touch.c", "own_program/CMakeLists.txt")), "usr/include/softfinger/rendering.hpp", "usr/include/softfinger/softfinger.h",
                          "libsoftfinger.so", "libsoftfinger_rendering.a", "softfinger.pc", "softfingerConfig.cmake"},
    "python3-softfinger": {f"usr/lib/python3/dist-packages/softfinger/{file.name}"
                           for file in (SOURCE / "python/softfinger").iterdir() if file.is_file()} |
                           {f"usr/share/doc/python3-softfinger/examples/{file.relative_to(SOURCE / 'examples')}"
                            for folder in ("python_program", "notebooks") for file in (SOURCE / "examples" / folder).glob("*.*")},
}


def run(*command, **options):
    return subprocess.run(command, check=True, capture_output=True, text=True, **options).stdout


def read_fields(package):
    """{field: value}; lines that go on begin with a space."""
    return dict(re.findall(r"(?m)^(\S+): ((?:.*\n?)(?: .*\n?)*)", run("dpkg-deb", "--field", package)))


def names_in(package):
    """Paths below /, and of libraries the name alone, whose folder is the machine's."""
    paths = {line.split()[5].removeprefix("./") for line in run("dpkg-deb", "--contents", package).splitlines()}
    return {path for path in paths if not path.endswith("/")} | {pathlib.PurePath(path).name for path in paths if "/lib" in path}


@unittest.skipUnless(shutil.which("dpkg-deb"), "no dpkg-deb here")
class Packages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        run("cpack", "--config", BUILD / "CPackConfig.cmake", "-B", cls.folder.name,
            *(word for key, value in FASTER.items() for word in ("-D", f"{key}={value}")))
        files = list(pathlib.Path(cls.folder.name).glob("*.deb"))
        cls.packages = {file.name.split("_")[0]: file for file in files}
        cls.names = {name: names_in(file) for name, file in cls.packages.items()}
        cls.fields = {name: read_fields(file) for name, file in cls.packages.items()}

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_each_holds_what_it_is_for(self):
        self.assertEqual(set(self.packages), set(HOLDS))
        for package, files in HOLDS.items():
            about = {f"usr/share/doc/{package}/{name}" for name in ("copyright", "changelog.gz", "changelog.Debian.gz")}
            self.assertEqual((files | about) - self.names[package], set(), package)

    def test_no_two_hold_the_same(self):
        for one in self.names:
            for other in self.names:
                if one < other:
                    both = {path for path in self.names[one] & self.names[other] if "/" in path}
                    self.assertEqual(both, set(), f"{one} and {other}")

    def test_all_that_ships_is_there(self):
        for folder in ("scenes", "devices", "fingers", "objects", "studies"):
            files = [path for path in (SOURCE / folder).rglob("*") if path.suffix in (".toml", ".msh", ".ply", ".obj", ".stl")]
            self.assertGreater(len(files), 1)
            for file in files:
                self.assertIn(f"usr/share/softfinger/{file.relative_to(SOURCE)}", self.names["softfinger"])

    def test_dependencies(self):
        version = self.fields["softfinger"]["Version"].strip()
        for package in ("libsoftfinger-dev", "python3-softfinger"):
            self.assertIn(f"libsoftfinger0 (= {version})", self.fields[package]["Depends"])
        self.assertRegex(self.fields["python3-softfinger"]["Depends"], r"python3:any, python3-numpy")
        self.assertEqual(self.fields["python3-softfinger"]["Architecture"].strip(), "all")
        self.assertIn("softfinger", self.fields["libsoftfinger0"]["Recommends"])
        found = re.findall(r"find_dependency\((\w+)", (SOURCE / "cmake/softfingerConfig.cmake.in").read_text())
        needs = self.fields["libsoftfinger-dev"]["Depends"].lower()
        self.assertGreater(len(found), 5)
        for name in set(found) - {"Threads", "PkgConfig"}:
            self.assertIn({"OpenSSL": "libssl"}.get(name, name.lower()), needs)

    def test_the_loader_learns_of_the_library(self):
        control = subprocess.run(["dpkg-deb", "--ctrl-tarfile", self.packages["libsoftfinger0"]], check=True, capture_output=True).stdout
        shlibs = subprocess.run(["tar", "-xO", "./shlibs", "./triggers"], input=control, check=True, capture_output=True, text=False).stdout.decode()
        self.assertRegex(shlibs, r"^libsoftfinger 0 libsoftfinger0 ")
        self.assertIn("activate-noawait ldconfig", shlibs)

    def test_a_synopsis_of_its_own(self):
        synopses = {fields["Description"].splitlines()[0] for fields in self.fields.values()}
        self.assertEqual(len(synopses), len(HOLDS))
        for text in synopses:
            self.assertLess(len(text), 80)
            self.assertNotIn("CMake", text)


class Files(unittest.TestCase):
    @unittest.skipUnless(shutil.which("man"), "no man here")
    def test_manual_pages_are_what_troff_takes(self):
        for name, least in (("softfinger", 200), ("softfinger-guard", 10)):
            page = BUILD / f"packages-in/{name}.1.gz"
            read = subprocess.run(["man", "--warnings", "-l", page], capture_output=True, text=True, stdin=subprocess.DEVNULL,
                                  env={"PATH": "/usr/bin:/bin", "LC_ALL": "C.UTF-8", "MANWIDTH": "80"})
            self.assertEqual((read.returncode, read.stderr), (0, ""))
            self.assertGreater(len(read.stdout.splitlines()), least)

    def test_the_manual_has_every_flag_and_the_version(self):
        text = gzip.decompress((BUILD / "packages-in/softfinger.1.gz").read_bytes()).decode().replace("\\-", "-")
        self.assertIn(run(BUILD / "softfinger", "--version").strip(), text)
        flags = set(re.findall(r"(?m)^  (--[\w-]+)", run(BUILD / "softfinger", "help", "run")))
        self.assertGreater(len(flags), 15)
        for flag in flags:
            self.assertIn(f".TP\n\\fB{flag}\\fR", text)

    def test_bash_asks_the_program(self):
        def offered(*words):
            script = (f"PATH={BUILD}:$PATH; source {SOURCE}/packages/completion/softfinger.bash; "
                      f"COMP_WORDS=(softfinger \"$@\"); COMP_CWORD=$#; _softfinger softfinger; printf '%s\\n' \"${{COMPREPLY[@]}}\"")
            return run("bash", "-c", script, "bash", *words).split()

        self.assertIn("--duration-s", offered("run", "--"))
        self.assertEqual(offered("run", "sph"), ["sphere"])
        self.assertEqual(offered("export", ""), [])

    @unittest.skipUnless(shutil.which("fish"), "no fish here")
    def test_fish_asks_the_program(self):
        script = f"set PATH {BUILD} $PATH; source {SOURCE}/packages/completion/softfinger.fish; complete -C $argv[1]"
        self.assertEqual(run("fish", "--no-config", "-c", script, "softfinger run sph").split(), ["sphere"])
        self.assertIn("--limits\tHow limits enter", run("fish", "--no-config", "-c", script, "softfinger match x --lim"))

    @unittest.skipUnless(shutil.which("zsh"), "no zsh here")
    def test_zsh_asks_the_program(self):
        # What zsh has for completion functions while somebody types.
        script = (f"PATH={BUILD}:$PATH; _describe() {{ print -l -- ${{(P)2}} }}; _files() {{ print any file }}; "
                  f"complete_it() {{ words=(softfinger \"$@\"); CURRENT=$#words; source {SOURCE}/packages/completion/_softfinger }}; "
                  f"complete_it \"$@\"")
        self.assertEqual(run("zsh", "-fc", script, "zsh", "run", "sph"), "sphere\n")
        self.assertEqual(run("zsh", "-fc", script, "zsh", "run", "--dur"), "--duration-s:end after this time, s\n")
        self.assertEqual(run("zsh", "-fc", script, "zsh", "export", ""), "any file\n")

    def test_boards_belong_to_who_sits_there(self):
        rules = [line for line in (SOURCE / "packages/60-softfinger.rules").read_text().splitlines() if line and line[0] != "#"]
        given = [rule for rule in rules if 'TAG+="uaccess"' in rule]
        self.assertGreater(len(given), 3)
        for rule in rules:
            self.assertNotIn("MODE", rule)
            self.assertNotIn("GROUP", rule)
        for rule in given:
            self.assertRegex(rule, r'KERNEL=="cpu_dma_latency"|ATTRS\{idVendor\}=="[0-9a-f]{4}", ATTRS\{idProduct\}=="[0-9a-f]{4}(\|[0-9a-f]{4})*"')

    @unittest.skipUnless(shutil.which("desktop-file-validate"), "no desktop-file-validate here")
    def test_the_desktop_entry_is_one(self):
        run("desktop-file-validate", SOURCE / "packages/softfinger.desktop")


unittest.main(argv=sys.argv[:1])
