"""The packages in a Debian that has nothing else: installed, tried by every example, upgraded, purged. Minutes, and needs
the network: `./dev test --all`. As root, or where users may have namespaces of their own.

    bare_root_test.py FOLDER_OF_PACKAGES SOURCE_FOLDER

Where no bare Debian can be had (no mmdebstrap, no network) it says SKIPPED and ends with 0.
"""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

PACKAGES = sorted(pathlib.Path(sys.argv[1]).resolve().glob("*.deb"))
SOURCE = pathlib.Path(sys.argv[2]).resolve()
NAMES = ["libsoftfinger-dev", "libsoftfinger0", "python3-softfinger", "softfinger", "softfinger-mpi"]

# In the root, with the packages in /packages, the later ones in /later. What may stay behind is apt's own.
TRY = r"""
set -eux
export DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8
export HOME=/tmp/home XDG_CACHE_HOME=/tmp/cache  # a user's, which no package removes
mkdir $HOME
apt-get update -q
# What they depend on first, so that all that comes and goes afterwards is theirs.
for package in /packages/*.deb; do dpkg-deb -f $package Depends; done | tr ',' '\n' | sed 's/(.*//; s/|.*//; s/:any//' | grep -v softfinger |
  sort -u | xargs apt-get install -qy --no-install-recommends
# What examples are built and run with.
apt-get install -qy --no-install-recommends gcc g++ make cmake pkgconf python3-matplotlib python3-tomlkit mono-mcs mono-runtime \
  libmono-system-core4.0-cil nodejs node-ws
everything() {
  find / -xdev \( -path /proc -o -path /dev/pts -o -path /dev/shm -o -path /tmp -o -path /packages -o -path /later -o -path /var/cache -o -path /var/lib/apt \
    -o -path /var/lib/dpkg -o -path /var/log \) -prune -o -print | sort
}
everything >/tmp/before

apt-get install -qy --no-install-recommends /packages/*.deb
dpkg --audit
cd /
try() {
  softfinger press index --steps 2 --to-mm 1 | grep -q force
  softfinger run sphere --headless --duration-s 0.2 | grep -q '^200 steps'
  python3 -c 'import softfinger; curve = softfinger.press("index", to_mm=1, steps=1); assert curve["normal_force_N"][0] > 0.1, curve'
  python3 -c 'import softfinger
with softfinger.Rendering("sphere", open_device=True) as rendering:
  rendering.step([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0.2], [0, 0, 0, 1]], 0.0)'
  softfinger complete -- run sp | grep -q sphere
}
try
pkg-config --modversion softfinger
(cd /tmp/tree && sh -eux /tmp/try_examples.sh)
apt-get install -qy --no-install-recommends /later/*.deb
dpkg-query -W -f '${Version} ${db:Status-Status}\n' NAMES | sort -u | tee /tmp/versions
grep -q '+later installed$' /tmp/versions
test $(wc -l </tmp/versions) = 1
try
apt-get purge -qy NAMES
everything >/tmp/after
diff /tmp/before /tmp/after
test -z "$(dpkg-query -W -f '${db:Status-Abbrev} ${Package}\n' '*softfinger*' 2>/dev/null)"
echo all is well
""".replace("NAMES", " ".join(NAMES))


# The emulated servos' port is a pseudo-terminal.
ENTER = 'mount -t devpts -o newinstance,ptmxmode=0666 devpts "$0/dev/pts" && exec chroot "$0" sh -c "$1"'


def skip(why):
    print(f"SKIPPED: {why}; the packages were not installed anywhere")
    sys.exit(0)


def later(package, folder):
    """The same package, of a version that comes after."""
    tree = folder / package.stem
    subprocess.run(["dpkg-deb", "--raw-extract", package, tree], check=True)
    control = tree / "DEBIAN/control"
    version = subprocess.run(["dpkg-deb", "--field", package, "Version"], check=True, capture_output=True, text=True).stdout.strip()
    control.write_text(control.read_text().replace(version, f"{version}+later"))
    subprocess.run(["dpkg-deb", "--root-owner-group", "-Znone", "--build", tree, folder], check=True, stdout=subprocess.DEVNULL)
    shutil.rmtree(tree)


def main():
    found = sorted(package.name.split("_")[0] for package in PACKAGES)
    if found != NAMES:
        sys.exit(f"{sys.argv[1]}: {', '.join(found) or 'no packages'}; must be {', '.join(NAMES)}, which ./dev package makes")
    if shutil.which("mmdebstrap") is None:
        skip("no mmdebstrap here")
    with tempfile.TemporaryDirectory(prefix="softfinger-root-") as folder:
        os.chmod(folder, 0o755)
        root = pathlib.Path(folder, "root")
        # Who is not root gets a namespace by it, and what chroot does inside as well.
        inside = [] if os.geteuid() == 0 else ["unshare", "--map-auto", "--map-root-user"]
        made = subprocess.run([*inside, "mmdebstrap", *(["--mode=root"] if inside else []), "--variant=apt", "bookworm", root], capture_output=True, text=True)
        if made.returncode != 0:
            skip(f"no bare Debian to be had: {made.stderr.strip().splitlines()[-1:]}")
        (root / "packages").mkdir()
        (root / "later").mkdir()
        shutil.copytree(SOURCE / "examples", root / "tmp/tree/examples")
        shutil.copytree(SOURCE / "clients", root / "tmp/tree/clients")
        shutil.copy(SOURCE / "tests/install/try_examples.sh", root / "tmp")
        for package in PACKAGES:
            shutil.copy(package, root / "packages")
            later(package, root / "later")
        tried = subprocess.run([*(inside or ["unshare"]), "--mount", "--pid", "--fork", f"--mount-proc={root}/proc",
                                "sh", "-c", ENTER, root, TRY], stdin=subprocess.DEVNULL)
        sys.exit(tried.returncode)


main()
