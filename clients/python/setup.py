# Not a pyproject.toml: with one, pip downloads the tools that build the package, and this one is
# to be installed from its folder without a network, with pip and setuptools as Debian 12 has them.
from setuptools import setup

setup(
    name="surfaced",
    version="0.2.0",
    description="Client of surfaced, which verifies people by the shape of their face",
    license="MIT",
    python_requires=">=3.11",
    packages=["surfaced"],
    package_data={"surfaced": ["py.typed"]},
)
