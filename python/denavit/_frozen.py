"""Objects that wrap native ones: made by functions of the package, immutable, equal if their contents are equal."""

from __future__ import annotations

from collections.abc import Hashable
from typing import ClassVar, Self


class Frozen:
    """A value of slots that are set once; a subclass states in `_made_by` how it is made and in `_key` its contents."""

    __slots__ = ()
    _made_by: ClassVar[str]

    def __init__(self, *_: object) -> None:
        raise TypeError(self._made_by)

    @classmethod
    def _with(cls, **slots: object) -> Self:
        self = object.__new__(cls)
        for name, value in slots.items():
            object.__setattr__(self, name, value)
        return self

    def _key(self) -> Hashable:
        raise NotImplementedError

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"a {type(self).__name__} is immutable; {name} cannot be set")

    def __delattr__(self, name: str) -> None:
        raise AttributeError(f"a {type(self).__name__} is immutable; {name} cannot be deleted")

    def __eq__(self, other: object) -> bool:
        return self._key() == other._key() if isinstance(other, type(self)) else NotImplemented

    def __hash__(self) -> int:
        return hash(self._key())
