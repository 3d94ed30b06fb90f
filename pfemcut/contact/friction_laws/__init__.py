"""Friction laws, one a module; a module dropped in here is found by itself and its law usable by name."""

from __future__ import annotations

import operator
import sys
from functools import reduce
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field

from pfemcut.contact.friction_laws.base import LawModel
from pfemcut.laws import discovered

LAWS = discovered(sys.modules[__name__], LawModel)
"""The friction laws by name."""

if TYPE_CHECKING:
    FrictionTable = LawModel
else:
    FrictionTable: Any = Annotated[reduce(operator.or_, LAWS.values()), Field(discriminator="law")]
    """Type of a ``[contact.friction]`` table: the union of all laws, told apart by ``law``."""
