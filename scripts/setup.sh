#!/usr/bin/env bash
# Installs what is missing and makes .venv: Debian's dolfinx and friends with apt, the rest with pip.
# Safe to repeat; called by `make setup`. With --packages only what needs root: Debian's packages.
# DOLFINX=wheel takes dolfinx with PETSc and MPI, numba, gmsh and h5py from wheels too (Python 3.12 or later).
set -euo pipefail
cd "$(dirname "$0")/.."

fail() { echo "setup: $*" >&2; exit 1; }

DOLFINX=${DOLFINX:-debian}
[ "$DOLFINX" = debian ] || [ "$DOLFINX" = wheel ] || fail "DOLFINX is $DOLFINX, not debian or wheel"

# 1. Debian packages. The dolfinx JIT needs a C compiler and Python's headers; the wheel of gmsh, libraries of a desktop.
packages=(python3-venv python3-dev gcc libc6-dev make)
if [ "$DOLFINX" = debian ]; then
    packages+=(
        python3-dolfinx python3-petsc4py python3-mpi4py openmpi-bin python3-gmsh gmsh libopenblas0-pthread
        python3-h5py python3-numba python3-scipy
    )
else
    packages+=(libgl1 libglu1-mesa libxcursor1 libxft2 libxinerama1 libxrender1)
fi
command -v dpkg-query >/dev/null || fail "needs Debian 12 or 13 or a system with its packages (no dpkg-query here)"
missing=()
for package in "${packages[@]}"; do
    state=$(dpkg-query -W -f='${Status}' "$package" 2>/dev/null || true)
    [ "$state" = "install ok installed" ] || missing+=("$package")
done
if [ "${#missing[@]}" -gt 0 ]; then
    [ "$(id -u)" -eq 0 ] || fail "these Debian packages are missing: ${missing[*]}
setup: install them as root, then repeat:
setup:   apt-get update && apt-get install --no-install-recommends ${missing[*]}"
    echo "setup: installing ${missing[*]}"
    export DEBIAN_FRONTEND=noninteractive
    apt-get update || echo "setup: warning: apt-get update failed; trying with the lists at hand" >&2
    apt-get install -y --no-install-recommends "${missing[@]}"
fi
[ "${1:-}" != --packages ] || exit 0

# 2. MUMPS is several times faster with OpenBLAS than with the reference BLAS.
system=/usr/bin/python3
triplet=$("$system" -c 'import sysconfig; print(sysconfig.get_config_var("MULTIARCH"))')
case $DOLFINX,$(readlink -f "/usr/lib/$triplet/libblas.so.3" || true) in
    wheel,* | *openblas*) ;;
    *) echo "setup: warning: libblas is not OpenBLAS, solves will be slow; as root run:" >&2
       echo "setup:   update-alternatives --config libblas.so.3-$triplet" >&2 ;;
esac

# 3. Virtual environment of the system's interpreter, whatever environment is active or python3 comes first on PATH.
# Packages of the user's home (pip --user) are kept out: a newer numpy there breaks Debian's binaries.
unset VIRTUAL_ENV PYTHONHOME PYTHONPATH PIP_TARGET PIP_PREFIX PIP_USER PIP_REQUIRE_VIRTUALENV
export PYTHONNOUSERSITE=1
if [ "$DOLFINX" = debian ]; then
    shared=true options=(--system-site-packages) extras=dev
else
    shared=false options=() extras=dev,wheels
    "$system" -c 'import sys; sys.exit(sys.version_info < (3, 12))' \
        || fail "the wheel of dolfinx needs Python 3.12 or later; $system is $("$system" --version)"
fi
wanted=$("$system" -c 'import os, sys; print(os.path.realpath(sys.executable))')
found=$(.venv/bin/python -c 'import os, sys; print(os.path.realpath(sys.executable))' 2>/dev/null || true)
if [ "$found" != "$wanted" ] || ! grep -q "^include-system-site-packages = $shared" .venv/pyvenv.cfg \
    || ! .venv/bin/python -m pip --version >/dev/null 2>&1; then
    "$system" -m venv --clear "${options[@]}" .venv
fi

# Also for those who run .venv/bin/pfemcut themselves.
for folder in .venv/lib/python3.*/site-packages; do
    echo 'import site; site.ENABLE_USER_SITE = False' > "$folder/nouser.pth"
done

# 4. Python packages, with numpy held at the version that Debian's binaries were built with.
: > .venv/constraints.txt
[ "$DOLFINX" = wheel ] || "$system" -c 'import numpy; print(f"numpy=={numpy.__version__}")' > .venv/constraints.txt
.venv/bin/python -m pip install --quiet --disable-pip-version-check --constraint .venv/constraints.txt --editable ".[$extras]"

# 5. Everything together in one process, before anybody waits for a run.
.venv/bin/python - <<'CHECK' || fail "the installed packages do not work together (see above)"
from mpi4py import MPI  # first: the libraries of wheels find MPI through it
import dolfinx, gmsh, h5py, numba, numpy, petsc4py, pythoncdt, scipy
import pfemcut.cli.main
from pfemcut.case.cutting import cutting_problem
from pfemcut.case.load import load_case
from pfemcut.pfem.method import PfemMethod
# Compiles forms and kernels, so that a compiler that does not work shows here and the first run need not wait.
method = PfemMethod.start(cutting_problem(*load_case("demos/aisi4340_demo/case.toml")))
for _ in range(3):
    method.advance()
print(f"setup: ready with dolfinx {dolfinx.__version__}, petsc4py {petsc4py.__version__}, numpy {numpy.__version__}")
CHECK
