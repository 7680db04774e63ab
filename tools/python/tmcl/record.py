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
        known = {field.name for field in fields(cls)}
        return cls(**{name: cls._read(name, said[name]) for name in said.keys() & known})

    @classmethod
    def _read(cls, name: str, value: Any) -> Any:
        inner = cls._inner.get(name)
        if isinstance(value, list):
            return tuple(cls._read(name, one) for one in value)
        return inner.of(value) if inner is not None and isinstance(value, dict) else value
