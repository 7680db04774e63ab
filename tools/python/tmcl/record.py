"""What the generated classes of results have in common."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, ClassVar, TypeVar

R = TypeVar("R", bound="Record")


@dataclass(frozen=True)
class Record:
    """A result: its fields by name. What a newer daemon says besides is left out, and what an
    older one does not say has its default."""

    _inner: ClassVar[Mapping[str, type["Record"]]] = {}

    @classmethod
    def of(cls: type[R], said: Mapping[str, Any]) -> R:
        types = {field.name: str(field.type) for field in fields(cls)}
        return cls(
            **{name: cls._read(name, types[name], said[name]) for name in said.keys() & types}
        )

    @classmethod
    def _read(cls, name: str, kind: str, value: Any) -> Any:
        inner = cls._inner.get(name)
        if isinstance(value, list):
            return tuple(cls._read(name, kind, one) for one in value)
        # In JSON, 5 and 5.5 are numbers of one kind.
        if type(value) is int and "float" in kind:
            return float(value)
        return inner.of(value) if inner is not None and isinstance(value, dict) else value
