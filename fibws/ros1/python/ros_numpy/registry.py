"""Which function converts messages of a class, or arrays into them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

Function = TypeVar("Function", bound=Callable[..., Any])

_to_numpy: dict[tuple[type[Any], bool], Callable[..., Any]] = {}
_from_numpy: dict[tuple[type[Any], bool], Callable[..., Any]] = {}


def converts_to_numpy(msgtype: type[Any], plural: bool = False) -> Callable[[Function], Function]:
    """Decorate the function that `numpify` calls for a class of messages.

    Args:
        plural: whether it is for lists of them.
    """

    def decorate(function: Function) -> Function:
        _to_numpy[msgtype, plural] = function
        return function

    return decorate


def converts_from_numpy(msgtype: type[Any], plural: bool = False) -> Callable[[Function], Function]:
    """Decorate the function that `msgify` calls for a class of messages."""

    def decorate(function: Function) -> Function:
        _from_numpy[msgtype, plural] = function
        return function

    return decorate


def numpify(msg: Any, *args: Any, **kwargs: Any) -> Any:
    """Return the array of a message, or of a list of messages.

    Args:
        msg: the message.
        args, kwargs: for the function of its class.

    Raises:
        ValueError: it cannot be converted.
    """
    if msg is None:
        return None
    is_list = isinstance(msg, list | tuple)
    if is_list and not msg:
        raise ValueError("cannot convert an empty list")
    class_ = type(msg[0] if is_list else msg)
    function = _to_numpy.get((class_, is_list))
    if function is None:
        kind = f"lists of {class_.__name__}" if is_list else class_.__name__
        known = ", ".join(sorted(each.__name__ for each, plural in _to_numpy if plural == is_list))
        raise ValueError(f"unable to convert message {kind}; known are {known}")
    return function(msg, *args, **kwargs)


def msgify(msg_type: type[Any], numpy_obj: Any, *args: Any, **kwargs: Any) -> Any:
    """Return the message of an array.

    Args:
        msg_type: its class.
        numpy_obj: the array.
        args, kwargs: for the function of the class.

    Raises:
        ValueError: there is no such function, or the array does not fit.
    """
    function = _from_numpy.get((msg_type, kwargs.pop("plural", False)))
    if function is None:
        known = ", ".join(sorted(each.__name__ for each, _ in _from_numpy))
        raise ValueError(f"unable to build message {msg_type.__name__}; known are {known}")
    return function(numpy_obj, *args, **kwargs)
