"""Runs pfemcut on another system: in a root of Debian 13 below out/elsewhere, which debootstrap fills.

python scripts/elsewhere.py debian13 [COMMAND ...]     Debian 13 with its packages
python scripts/elsewhere.py wheels [COMMAND ...]       Debian 13's Python with dolfinx, PETSc and MPI as wheels
python scripts/elsewhere.py container [COMMAND ...]    the steps of the Containerfile, one by one, without an engine

The commands start in a copy of this tree as an ordinary user (``make test`` if none is given); in the container they
are arguments of ``pfemcut`` (a short cut if none are given) and start in an empty folder, as a user whom the image
doesn't know.

Needs root, debootstrap, and Debian's keyring (package debian-archive-keyring, of 2023 or later) on a system with apt.
The mirror is that of this system's apt (or ``--mirror``), pip's index and the certificates are this system's too.
What is mounted in a root is so for the command only, in a name space of its own: nothing stays mounted.
"""

from __future__ import annotations

import argparse
import os
import shlex
import shutil
import ssl
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

HERE = Path(__file__).resolve().parent.parent
SUITE = "trixie"
KEYRING = Path("/usr/share/keyrings/debian-archive-keyring.gpg")
CERTIFICATES = Path("/etc/ssl/certs/ca-certificates.crt")
PASSED_ON = (
    "http_proxy",
    "https_proxy",
    "no_proxy",
    "PIP_INDEX_URL",
    "PIP_EXTRA_INDEX_URL",
    "PIP_TRUSTED_HOST",
)
PATH = "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin"
STRANGER = 12345  # an id of which a container's list of users knows nothing
CUT = (
    ("examples", "--copy", "aisi4340_demo", "."),
    ("run", "case.toml", "-o", "out", "--travel", "0.01 mm"),
)
# Everything that is mounted goes with the name space, also if this is killed.
CHROOT = """\
mount --make-rprivate /
mount -t proc proc "$ROOT/proc"
mount --bind /sys "$ROOT/sys"
mount -o remount,bind,ro "$ROOT/sys"
mount --bind /dev "$ROOT/dev"
mount -t tmpfs -o mode=1777 tmpfs "$ROOT/dev/shm"
exec chroot --userspec="$AS" "$ROOT" /usr/bin/env --ignore-environment "$@"
"""


def main() -> int:
    """Run a command elsewhere; its exit status."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("system", choices=("debian13", "wheels", "container"))
    parser.add_argument("command", nargs=argparse.REMAINDER)
    parser.add_argument("--mirror", help="of Debian; that of this system's apt if not given")
    parser.add_argument("--roots", type=Path, default=HERE / "out" / "elsewhere", help="where the roots lie")
    options = parser.parse_args()
    require(os.geteuid() == 0, "needs root (chroot and mount)")
    require(shutil.which("debootstrap") is not None, "needs debootstrap: apt-get install debootstrap")
    require(KEYRING.exists(), f"needs {KEYRING}: apt-get install debian-archive-keyring")
    root = new_root(options.roots.resolve(), options.system, options.mirror)
    prepare(root)
    if options.system == "container":
        return container(root, [options.command] if options.command else CUT)
    return tested(root, options.system, options.command or ["make", "test"])


def require(condition: bool, complaint: str) -> None:
    """End with the complaint if the condition does not hold."""
    if not condition:
        sys.exit(f"elsewhere: {complaint}")


def output_of(*command: str) -> str:
    """What a command prints; nothing if it fails."""
    return subprocess.run(command, capture_output=True, text=True).stdout.strip()


def new_root(roots: Path, name: str, mirror: str | None) -> Path:
    """The root of that name; a copy of one that debootstrap filled, if it is not there yet."""
    base, root = roots / f"{SUITE}-base", roots / name
    if not mark(base).exists():
        if mirror is None:
            # Of a Debian: a system of another origin has other packages at its mirror.
            lines = output_of(
                "apt-get", "indextargets", "--format", "$(REPO_URI)", "Created-By: Packages", "Label: Debian"
            )
            require(lines != "", "apt knows no mirror of Debian (apt-get update, or --mirror URL)")
            mirror = lines.splitlines()[0]
        shutil.rmtree(base, ignore_errors=True)
        base.mkdir(parents=True)
        say(f"debootstrap of {SUITE}")
        subprocess.run(
            ["debootstrap", "--variant=minbase", f"--keyring={KEYRING}", "--include=ca-certificates"]
            + [SUITE, str(base), mirror],
            check=True,
            stdout=subprocess.DEVNULL,
        )
        # As in images for containers: a root that breaks is made anew.
        (base / "etc/dpkg/dpkg.cfg.d/unsafe-io").write_text("force-unsafe-io\n", encoding="utf-8")
        mark(base).touch()
    if not mark(root).exists():
        shutil.rmtree(root, ignore_errors=True)
        subprocess.run(["cp", "--archive", "--reflink=auto", str(base), str(root)], check=True)
    return root


def mark(root: Path) -> Path:
    """The file that says that a root has all it needs; without it the root is made anew."""
    return root.with_name(f"{root.name}.complete")


def prepare(root: Path) -> None:
    """Let a root trust and find on the network what this system does."""
    for name in ("hosts", "resolv.conf"):
        shutil.copy(Path("/etc", name), root / "etc" / name)
    trusted = os.environ.get("PIP_CERT") or ssl.get_default_verify_paths().cafile
    if trusted is not None and Path(trusted).exists():
        shutil.copy(trusted, root / CERTIFICATES.relative_to("/"))
    proxy = output_of("apt-config", "dump", "Acquire::http::Proxy")
    (root / "etc/apt/apt.conf.d/90proxy").write_text(f"{proxy}\n", encoding="utf-8")


def network() -> dict[str, str]:
    """The variables by which pip finds its index."""
    found = {name: os.environ[name] for name in PASSED_ON if name in os.environ}
    index = output_of(sys.executable, "-m", "pip", "config", "get", "global.index-url")
    return ({"PIP_INDEX_URL": index} if index else {}) | found | {"PIP_CERT": str(CERTIFICATES)}


def inside(
    root: Path, command: str, *, user: str = "0:0", folder: str = "/", variables: Mapping[str, str]
) -> int:
    """Run a line of shell in a root and return its exit status."""
    environment = {"PATH": PATH, "LANG": "C.UTF-8", "HOME": "/root"} | network() | variables
    return subprocess.run(
        ["unshare", "--mount", "--pid", "--fork", "--kill-child", "bash", "-euc", CHROOT, "chroot"]
        + [f"{name}={value}" for name, value in environment.items()]
        + ["sh", "-c", f"cd {shlex.quote(folder)} && {command}"],
        env=os.environ | {"ROOT": str(root), "AS": user},
    ).returncode


def copy_tree(to: Path, owner: int) -> None:
    """Copy this tree, without what git ignores, beside the environment and the results that lie there."""
    to.mkdir(parents=True, exist_ok=True)
    for old in to.iterdir():
        if old.is_dir() and not old.is_symlink() and old.name not in (".venv", "out"):
            shutil.rmtree(old)
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=HERE,
        check=True,
        capture_output=True,
    ).stdout
    names = [name for name in listed.decode().split("\0") if name and (HERE / name).exists()]
    for name in names:
        (to / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(HERE / name, to / name)
    subprocess.run(["chown", "--recursive", f"{owner}:{owner}", str(to)], check=True)


def tested(root: Path, system: str, command: Sequence[str]) -> int:
    """Install what the system needs, and run the command as an ordinary user."""
    home = "/home/tester"
    variables = {"DOLFINX": "wheel"} if system == "wheels" else {}
    if not (root / home[1:]).exists():
        require(
            inside(root, f"useradd --uid 1000 --create-home --home-dir {home} tester", variables={}) == 0, ""
        )
    copy_tree(root / home[1:] / "pfemcut", 1000)
    folder = f"{home}/pfemcut"
    ready = inside(root, "scripts/setup.sh --packages", folder=folder, variables=variables)
    require(ready == 0, "the packages can't be installed")
    mark(root).touch()
    say(f"{shlex.join(command)} on {system}")
    variables |= {"HOME": home, "OMP_NUM_THREADS": "1"}
    return inside(root, shlex.join(command), user="1000:1000", folder=folder, variables=variables)


@dataclass
class Image:
    """What the steps of a Containerfile have set."""

    user: str = "root"
    folder: str = "/"
    variables: dict[str, str] = field(default_factory=dict)


def container(root: Path, calls: Sequence[Sequence[str]]) -> int:
    """Take the steps of the Containerfile in a root, then call pfemcut as an engine would with ``--user``."""
    image = Image()
    lines = (HERE / "Containerfile").read_text(encoding="utf-8").replace("\\\n", "").splitlines()
    for line in (line for line in lines if line and not line.startswith("#")):
        say(line)
        word, rest = line.split(maxsplit=1)
        if word == "RUN":
            require(inside_image(root, image, rest) == 0, "that failed")
        elif word == "COPY":
            copy_into(root, image, shlex.split(rest))
        elif word == "USER":
            image.user = rest
        elif word == "WORKDIR":
            image.folder = rest
            if not (root / rest[1:]).exists():
                (root / rest[1:]).mkdir(parents=True)
        elif word == "ENV":
            image.variables |= dict(item.split("=", 1) for item in shlex.split(rest))
        else:
            require(word in ("FROM", "ENTRYPOINT", "CMD"), f"unknown step {word}")
    mark(root).touch()
    # Stands for the folder that `--volume` mounts.
    cases = root / image.folder[1:]
    shutil.rmtree(cases)
    cases.mkdir()
    os.chown(cases, STRANGER, STRANGER)
    image.user = str(STRANGER)
    for arguments in calls:
        command = shlex.join(["pfemcut", *arguments])
        say(f"{command} as user {STRANGER}")
        status = inside_image(root, image, command)
        if status != 0:
            return status
    return 0


def inside_image(root: Path, image: Image, command: str) -> int:
    """Run a line of shell as the image's user in its folder."""
    known = {"root": ("0:0", "/root")}
    for line in (root / "etc/passwd").read_text(encoding="utf-8").splitlines():
        name, _, user, group, _, home, _ = line.split(":")
        known[name] = (f"{user}:{group}", home)
    # An engine sets the home of a stranger to the root.
    user, home = known.get(image.user, (f"{image.user}:{image.user}", "/"))
    return inside(
        root,
        command,
        user=user,
        folder=image.folder,
        variables={"HOME": home, "PATH": PATH} | image.variables,
    )


def copy_into(root: Path, image: Image, words: Sequence[str]) -> None:
    """``COPY [--chown=USER] SOURCE TARGET``, of one file or of the tree."""
    owner = next((word.split("=")[1] for word in words if word.startswith("--chown=")), "root")
    source, target = (word for word in words if not word.startswith("--"))
    to = root / target[1:] if target.startswith("/") else root / image.folder[1:] / target
    if source == ".":
        copy_tree(to, 0)
    else:
        to.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(HERE / source, to)
    require(inside(root, f"chown -R {owner} /{to.relative_to(root)}", variables={}) == 0, "chown failed")


def say(line: str) -> None:
    """Print a line at once."""
    print(f"elsewhere: {line}", flush=True)


if __name__ == "__main__":
    sys.exit(main())
