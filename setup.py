"""Brings the case files of demos/ into the package as its examples; everything else is in pyproject.toml."""

from setuptools import find_packages, setup

setup(
    packages=[*find_packages(include=["meshing*", "pfemcut*"]), "pfemcut.examples"],
    package_dir={"pfemcut.examples": "demos"},
)
