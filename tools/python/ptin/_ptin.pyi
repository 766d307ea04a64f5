# SPDX-License-Identifier: GPL-3.0-or-later
# The extension module takes and gives plain values, which the package ptin puts into types.
from typing import Any

def __getattr__(name: str) -> Any: ...
