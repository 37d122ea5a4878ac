"""Signatures of functions that take the options of a table: editors and mypy have
them from the types, `help` and notebooks from here."""
from __future__ import annotations

import inspect
from typing import Any, Callable, TypeVar

from . import _options

F = TypeVar("F", bound=Callable[..., Any])


def takes(keys: Any, **usual: Any) -> Callable[[F], F]:
    """Of a function with `**options: Unpack[keys]`, some with other defaults."""
    defaults = {**_options.DEFAULTS, **usual}

    def finish(function: F) -> F:
        signature = inspect.signature(function)
        own = list(signature.parameters.values())[:-1]
        named = {each.name for each in own}
        more = [inspect.Parameter(
            name, inspect.Parameter.KEYWORD_ONLY, annotation=kind.__forward_arg__,
            default=defaults.get(name))
            for name, kind in keys.__annotations__.items() if name not in named]
        function.__signature__ = signature.replace(  # type: ignore[attr-defined]
            parameters=own + more)
        return function
    return finish
