"""Material files: their schema, the library, and the way from a table to a :class:`Material` and back."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import resources
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import (
    BaseModel,
    Discriminator,
    Field,
    Strict,
    Tag,
    ValidationError,
    model_validator,
)

from pfemcut.input_table import InputTable
from pfemcut.inputs import InputError, explained, nearest, read_toml
from pfemcut.materials.hardening import LAWS, HardeningTable
from pfemcut.materials.material import Material, Property

Positive = Annotated[float, Field(gt=0)]
NotNegative = Annotated[float, Field(ge=0)]


class _Table(InputTable):
    temperature: Annotated[tuple[Positive, ...], Strict(False)] = Field(
        description="Increasing temperatures (K)"
    )
    value: Annotated[tuple[NotNegative, ...], Strict(False)] = Field(
        description="Values of the property at the temperatures"
    )

    @model_validator(mode="after")
    def _is_a_function(self) -> Self:
        if len(self.temperature) != len(self.value):
            raise ValueError(f"given {len(self.temperature)} temperatures and {len(self.value)} values")
        if not self.temperature:
            raise ValueError("given an empty table, must have one temperature or more")
        if any(after <= before for before, after in pairwise(self.temperature)):
            raise ValueError(f"given temperatures {list(self.temperature)}, must increase")
        return self

    def property(self) -> Property:
        return Property(self.temperature, self.value)


class PropertyTable(_Table):
    """A property that may be zero, as ``{temperature = [...], value = [...]}``."""


class PositiveTable(_Table):
    """A property that must be positive, as ``{temperature = [...], value = [...]}``."""

    value: Annotated[tuple[Positive, ...], Strict(False)] = Field(
        description="Values of the property at the temperatures"
    )


def _form(value: Any) -> str:
    return "table" if isinstance(value, Mapping | BaseModel) else "number"


PositiveProperty = Annotated[
    Annotated[Positive, Tag("number")] | Annotated[PositiveTable, Tag("table")], Discriminator(_form)
]
NotNegativeProperty = Annotated[
    Annotated[NotNegative, Tag("number")] | Annotated[PropertyTable, Tag("table")], Discriminator(_form)
]


class MaterialTable(InputTable):
    """Schema of a material file. Properties that depend on temperature may be given as a table."""

    name: str = Field(default="", description="Name for reports")
    source: str = Field(default="", description="Where the values come from")
    checked: str = Field(
        default="", description="Against what the values were checked, and which of them were not"
    )
    notes: Annotated[tuple[str, ...], Strict(False)] = Field(
        default=(), description="What a user must know: misprints, choices that are not in the sources"
    )
    young_modulus: float = Field(gt=0, description="Young's modulus (MPa)")
    poisson_ratio: float = Field(gt=-1, lt=0.5, description="Poisson's ratio (dimensionless)")
    density: float = Field(gt=0, lt=1e-6, description="Density (tonne/mm³; steel has 7.8e-9)")
    expansion: NotNegativeProperty = Field(
        description="Linear thermal expansion, secant from the reference temperature (1/K); a number or a table"
    )
    capacity: PositiveProperty = Field(description="Specific heat (mm²/(s² K)); a number or a table")
    conductivity: PositiveProperty = Field(description="Thermal conductivity (N/(s K)); a number or a table")
    reference_temperature: float = Field(
        default=293.15, gt=0, description="Stress-free temperature theta_0 (K)"
    )
    taylor_quinney: float = Field(
        default=0.9, ge=0, le=1, description="Fraction chi of plastic power that heats"
    )
    hardening: HardeningTable = Field(description="Hardening law and its constants")
    sources: dict[str, str] = Field(
        default={},
        description="Where each value comes from, by its key; `hardening` stands for the whole law",
    )

    @model_validator(mode="before")
    @classmethod
    def _share_reference_temperature(cls, table: Any) -> Any:
        """Hand the material's reference temperature to a law that needs one and was given none."""
        if not isinstance(table, Mapping) or not isinstance(table.get("hardening"), Mapping):
            return table
        hardening = dict(table["hardening"])
        law = LAWS.get(hardening.get("law", ""))
        if law is not None and "reference_temperature" in law.model_fields:
            default = cls.model_fields["reference_temperature"].default
            hardening.setdefault("reference_temperature", table.get("reference_temperature", default))
        return {**table, "hardening": hardening}

    @model_validator(mode="after")
    def _sources_name_values(self) -> Self:
        known = [*VALUES, "hardening", *(f"hardening.{key}" for key in type(self.hardening).model_fields)]
        unknown = [key for key in self.sources if key not in known]
        if unknown:
            raise ValueError(f"sources: unknown key '{unknown[0]}'{nearest(unknown[0], known)}")
        return self

    def material(self) -> Material:
        """The material that solvers use."""
        return Material(
            name=self.name or "unnamed",
            source=self.source,
            young_modulus=self.young_modulus,
            poisson_ratio=self.poisson_ratio,
            density=self.density,
            expansion=_property(self.expansion),
            capacity=_property(self.capacity),
            conductivity=_property(self.conductivity),
            reference_temperature=self.reference_temperature,
            taylor_quinney=self.taylor_quinney,
            hardening=self.hardening,
            sources=tuple(self.sources.items()),
            checked=self.checked,
            notes=self.notes,
        )


VALUES = tuple(
    key
    for key in MaterialTable.model_fields
    if key not in ("name", "source", "checked", "notes", "hardening", "sources")
)
"""Keys of a material file that have a value with a source, apart from the hardening law's."""


def _property(given: float | _Table) -> Property:
    return given.property() if isinstance(given, _Table) else Property((0.0,), (given,))


def library_names() -> list[str]:
    """Names of the library's materials."""
    folder = resources.files("pfemcut.materials") / "library"
    return sorted(
        entry.name.removesuffix(".toml") for entry in folder.iterdir() if entry.name.endswith(".toml")
    )


def load_material(
    spec: str | Mapping[str, Any], base_directory: Path, section: str = "workpiece.material"
) -> Material:
    """The material that a case file asks for.

    Parameters
    ----------
    spec
        A library name, a path to a TOML file (relative ones start at ``base_directory``), or an inline table.
        A table may name either as its ``base`` and give only what differs.
    base_directory
        Folder of the case file.
    section
        TOML path of the material in the case file, for messages.

    Raises
    ------
    InputError
        If there is no such material or it is not valid.
    """
    if isinstance(spec, str):
        table, origin = _named(spec, base_directory, section)
        section = ""
    else:
        table, origin = _merged(spec, base_directory, section), ""
    try:
        return MaterialTable.model_validate(table).material()
    except ValidationError as error:
        problems = explained(error, MaterialTable, section)
        raise InputError(f"{origin}: {line}" if origin else line for line in problems) from None


def _merged(spec: Mapping[str, Any], base_directory: Path, section: str) -> dict[str, Any]:
    own = {key: value for key, value in spec.items() if key != "base"}
    if "base" not in spec:
        return own
    if not isinstance(spec["base"], str):
        raise InputError(
            [f"[{section}] base: given {spec['base']!r}, must be a material's name or file in quotes"]
        )
    base, _ = _named(spec["base"], base_directory, section)
    given, inherited = own.get("hardening"), base.get("hardening")
    sources = base.get("sources", {})
    other_law: list[str] = []
    if isinstance(given, Mapping) and isinstance(inherited, Mapping):
        if given.get("law", inherited.get("law")) == inherited.get("law"):
            own["hardening"] = {**inherited, **given}
        else:
            sources = {key: text for key, text in sources.items() if not key.startswith("hardening")}
            other_law = ["hardening"]
    changed = _changed(own, given)
    if isinstance(own.get("sources", {}), Mapping):
        own["sources"] = {**sources, **changed, **own.get("sources", {})}
    differing = ", ".join([*other_law, *changed])
    if differing and isinstance(base.get("checked"), str):
        own.setdefault("checked", f"{base['checked']} Changed, and not checked: {differing}.".strip())
    return {**base, **own}


def _changed(own: Mapping[str, Any], hardening: Any) -> dict[str, str]:
    """What stands as the source of values given in place of the base's."""
    keys = [key for key in own if key in VALUES]
    if isinstance(hardening, Mapping):
        keys += [f"hardening.{key}" for key in hardening if key != "law"]
    return dict.fromkeys(keys, "given in place of the base's value")


def _named(name: str, base_directory: Path, section: str) -> tuple[dict[str, Any], str]:
    """Table of a library material or of a material file, and the file's name for messages."""
    if name in library_names():
        text = resources.files("pfemcut.materials") / "library" / f"{name}.toml"
        with resources.as_file(text) as path:
            return read_toml(path), f"material '{name}'"
    path = base_directory / name
    if name.endswith(".toml") or path.is_file():
        return read_toml(path), str(path)
    hint = nearest(name, library_names())
    raise InputError([f"{_spoken(section)}unknown material '{name}'{hint} (or a path to a .toml file)"])


def _spoken(section: str) -> str:
    table, _, key = section.rpartition(".")
    return f"[{table}] {key}: " if table else ""


def material_table(material: Material) -> dict[str, Any]:
    """The inline table that :func:`load_material` turns into the same material."""

    def form(given: Property) -> Any:
        if len(given.values) == 1:
            return given.values[0]
        return {"temperature": list(given.temperatures), "value": list(given.values)}

    hardening = material.hardening
    if not isinstance(hardening, BaseModel):
        raise TypeError(f"hardening law {type(hardening).__name__} can't be written to a file")
    return {
        "name": material.name,
        "source": material.source,
        "checked": material.checked,
        "notes": list(material.notes),
        "young_modulus": material.young_modulus,
        "poisson_ratio": material.poisson_ratio,
        "density": material.density,
        "expansion": form(material.expansion),
        "capacity": form(material.capacity),
        "conductivity": form(material.conductivity),
        "reference_temperature": material.reference_temperature,
        "taylor_quinney": material.taylor_quinney,
        "hardening": hardening.model_dump(),
        "sources": dict(material.sources),
    }
