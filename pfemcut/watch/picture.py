"""The current field as a picture, drawn once a frame."""

from __future__ import annotations

import hashlib
import io
import math
import threading
import tomllib
from pathlib import Path

import matplotlib

matplotlib.use("Agg")  # No display on a cluster.

import matplotlib.pyplot as plt  # noqa: E402

from pfemcut.output.directory import INPUTS  # noqa: E402
from pfemcut.output.drawing import cutting_zone  # noqa: E402
from pfemcut.output.figures import FIELDS, colour_scale, draw_field  # noqa: E402
from pfemcut.output.vtu import FieldsError, read_collection, read_last_frame  # noqa: E402

FIELD_NAMES = tuple((field.name, field.title) for field in FIELDS)
DOTS_PER_INCH = 100


class FieldPictures:
    """Pictures of the last frame in an output directory; each is kept until there is another frame."""

    def __init__(self, directory: Path) -> None:
        self._directory = directory
        given = tomllib.loads((directory / INPUTS).read_text(encoding="utf-8"))
        self._depth = float(given.get("cutting", {}).get("depth", math.nan))
        self._kept: dict[str, tuple[bytes, bytes]] = {}
        # matplotlib's pyplot is not made for threads.
        self._drawing = threading.Lock()

    def png(self, name: str) -> bytes:
        """Return the picture of a field.

        Raises
        ------
        FieldsError
            If there is no frame yet, or it is damaged or without elements.
        """
        field = next(field for field in FIELDS if field.name == name)
        with self._drawing:
            written = self._last_frame()
            if name in self._kept and self._kept[name][0] == written:
                return self._kept[name][1]
            frame = read_last_frame(self._directory)
            if frame.cells.shape[0] == 0:
                raise FieldsError("the last frame has no elements to draw")
            view = cutting_zone(frame, self._depth)
            figure = draw_field(frame, field, view, colour_scale(frame, field, view, {}))
            buffer = io.BytesIO()
            figure.savefig(buffer, format="png", dpi=DOTS_PER_INCH)
            plt.close(figure)
            self._kept[name] = (written, buffer.getvalue())
            return buffer.getvalue()

    def _last_frame(self) -> bytes:
        """A digest of the files of the last frame.

        Neither step nor times of the files tell it: a run that starts anew, or is resumed, writes the same step again,
        perhaps within a tick of the file system's clock.
        """
        entries = read_collection(self._directory)
        last = max((entry.step for entry in entries), default=-1)
        digest = hashlib.blake2b(str(last).encode())
        for entry in entries:
            if entry.step == last:
                try:
                    digest.update((self._directory / entry.file).read_bytes())
                except OSError as error:
                    raise FieldsError(f"{self._directory / entry.file}: can't be read ({error})") from error
        return digest.digest()
