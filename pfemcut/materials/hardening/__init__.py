"""Hardening laws, one a module; a module dropped in here is found by itself and its law usable by name."""

from __future__ import annotations

import operator
import sys
from functools import reduce
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field

from pfemcut.laws import discovered
from pfemcut.materials.hardening.base import LawModel

LAWS = discovered(sys.modules[__name__], LawModel)
"""The hardening laws by name."""

if TYPE_CHECKING:
    HardeningTable = LawModel
else:
    HardeningTable: Any = Annotated[reduce(operator.or_, LAWS.values()), Field(discriminator="law")]
    """Type of a ``[hardening]`` table: the union of all laws, told apart by ``law``."""
