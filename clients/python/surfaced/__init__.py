"""Client of surfaced: README.md beside this package, and the daemon's own /openapi.json."""

from .client import Capture, Client, SurfacedError
from .folder import Enrolled, enroll_folder

__all__ = ["Capture", "Client", "Enrolled", "SurfacedError", "enroll_folder"]
