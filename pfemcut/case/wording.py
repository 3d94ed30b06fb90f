"""What a key of the schema takes, in the words of the case-file reference."""

from __future__ import annotations

from types import UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from annotated_types import Ge, Gt, Le, Lt, MinLen
from pydantic import BaseModel
from pydantic.fields import FieldInfo

RANGES: tuple[tuple[type, str, str], ...] = (
    (Gt, "gt", "> {}"),
    (Ge, "ge", "≥ {}"),
    (Lt, "lt", "< {}"),
    (Le, "le", "≤ {}"),
)


def allowed(field: FieldInfo) -> str:
    """Kind and range of the values that a key takes, as Markdown."""
    words = choices(field.annotation)
    if words:
        return ", ".join(f'`"{word}"`' for word in words)
    limits = [
        text.format(f"{getattr(limit, name):g}")
        for kind, name, text in RANGES
        for limit in field.metadata
        if isinstance(limit, kind)
    ]
    if any(isinstance(limit, MinLen) for limit in field.metadata):
        limits.append("not empty")
    return ", ".join([kind_of(field.annotation), *limits])


def default(field: FieldInfo) -> str:
    """What a key is if it is not given, as Markdown."""
    if field.is_required():
        return "required"
    value = field.default
    if value is None or value == ():
        return "–"
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    if isinstance(value, tuple):
        return f"`{list(value)}`"
    return f'`"{value}"`' if isinstance(value, str) else f"`{value:g}`"


def choices(annotation: Any) -> tuple[Any, ...]:
    """The words that a key takes; empty if it is not such a key."""
    if get_origin(annotation) is Literal:
        return get_args(annotation)
    return ()


def inner_types(annotation: Any) -> tuple[Any, ...]:
    """The types in an annotation, without unions, tuples and metadata around them."""
    if get_origin(annotation) is Annotated:
        return inner_types(get_args(annotation)[0])
    if get_origin(annotation) in (tuple, Union, UnionType):
        return tuple(inner for each in get_args(annotation) for inner in inner_types(each))
    return (annotation,)


def kind_of(annotation: Any) -> str:
    """The kind of value that an annotation stands for."""
    names = {float: "number", int: "whole number", bool: "true or false", str: "text", dict: "table"}
    if get_origin(annotation) is tuple:
        return "list of numbers" if str not in inner_types(annotation) else "list of texts"
    if get_origin(annotation) in (Union, UnionType):
        kinds = [kind_of(each) for each in get_args(annotation) if each is not type(None)]
        return " or ".join(dict.fromkeys(kinds))
    if get_origin(annotation) is Annotated:
        return kind_of(get_args(annotation)[0])
    kind = get_origin(annotation) or annotation
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        # A piecewise linear function; larger tables have a section of their own.
        lists = [
            f"{key} = […]"
            for key, field in kind.model_fields.items()
            if get_origin(field.annotation) is tuple
        ]
        return f"table `{{ {', '.join(lists)} }}`" if len(lists) == len(kind.model_fields) else "table"
    return names[kind]
