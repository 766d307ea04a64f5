# SPDX-License-Identifier: GPL-3.0-or-later
"""ptin: progressive TINs larger than memory.

A terrain is one file that answers questions from the disk: heights, profiles, contours, lines of sight, viewsheds, meshes
and rasters of any part, each exact, or within an error that you name and that the answer certifies.

>>> import ptin
>>> with ptin.open("dem.ptin") as t:
...     t.locate((378000, 3804000)).z
947.5253908634186
"""

from .construct import build
from .errors import (
    Cancelled,
    Corruption,
    Error,
    InvalidArgument,
    IoError,
    NotFound,
    ResourceExhausted,
    UnsupportedVersion,
)
from .results import (
    Areas,
    Bounded,
    Clearance,
    Heights,
    Highest,
    Isolines,
    LinePlace,
    Mesh,
    Place,
    Profile,
    Raster,
    Report,
    Sight,
    State,
    Transform,
    Viewshed,
    Volume,
)
from .terrain import Terrain, open
from ._ptin import __version__

__all__ = [
    "Areas",
    "Bounded",
    "Cancelled",
    "Clearance",
    "Corruption",
    "Error",
    "Heights",
    "Highest",
    "InvalidArgument",
    "IoError",
    "Isolines",
    "LinePlace",
    "Mesh",
    "NotFound",
    "Place",
    "Profile",
    "Raster",
    "Report",
    "ResourceExhausted",
    "Sight",
    "State",
    "Terrain",
    "Transform",
    "UnsupportedVersion",
    "Viewshed",
    "Volume",
    "build",
    "open",
]
