"""Python expressions that people write in options and files, with a restricted vocabulary.

Conditions on messages (``topic echo --filter``), angles in parameter files (``rad(pi/2)``) and
``$(eval ...)`` in launch files are such expressions. Python parses them, and `Expression` compiles
the syntax tree to functions: Python never runs it, so an expression reaches nothing but its names,
the operators and the methods below. None of these takes long or much memory, whatever its values.
"""

from __future__ import annotations

import ast
import operator
import re
from collections.abc import Callable, Mapping
from typing import Any, TypeAlias

from fibws.errors import FibwsError, InvalidValue

MAX_CHARACTERS = 10_000
"""Maximum length of an expression."""
MAX_BITS = 4096
"""Maximum size of an integer."""
MAX_DIGITS = 400
"""Maximum number of digits to round to."""
MAX_ITEMS = 10_000
"""Maximum size of a value: nested items, each as often as it occurs, and characters of texts."""

Names: TypeAlias = Mapping[str, Any]
"""The names that an expression may use: functions, and constants."""
Value: TypeAlias = Callable[[Any], Any]
"""Returns the value of a part of an expression, given what `Expression.value` is given."""
Variable: TypeAlias = Callable[[ast.expr], Value | None]
"""Returns the value of a variable, given a name, an attribute or an item; None for others."""


class Expression:
    """A compiled expression.

    Args:
        text: the expression.
        names: the functions and the constants that it may use.
        variable: finds its variables.

    Raises:
        InvalidValue: the text is not an expression, or uses something that is not allowed.
    """

    def __init__(
        self, text: str, names: Names, variable: Variable = lambda expression: None
    ) -> None:
        if len(text) > MAX_CHARACTERS:
            raise InvalidValue(f"too long (limit: {MAX_CHARACTERS} characters)")
        try:
            tree = ast.parse(text.strip(), mode="eval")
            self._value = _Compiler(names, variable).compile(tree.body)
        except SyntaxError as error:
            raise InvalidValue(f"{error.msg}: {text}") from None
        except (RecursionError, MemoryError):
            raise InvalidValue("nested too deeply") from None
        except FibwsError:
            raise
        except ValueError as error:  # Such as a null character.
            raise InvalidValue(str(error)) from None

    def value(self, variables: Any = None) -> Any:
        """Return the value of the expression.

        Args:
            variables: passed to the functions that ``variable`` returned.

        Raises:
            InvalidValue: an operation failed, or a value is too large.
            FibwsError: as the functions of variables raise it.
        """
        try:
            value = self._value(variables)
        except FibwsError:
            raise
        except RecursionError:
            raise InvalidValue("nested too deeply") from None
        except ValueError as error:
            raise InvalidValue(str(error)) from None
        except Exception as error:  # Operations raise what their operands' types do.
            raise InvalidValue(f"{type(error).__name__}: {error}") from None
        if callable(value):
            raise InvalidValue("the result is a function, which is not called")
        return value


class _Compiler:
    """Compiles the parts of one expression to functions."""

    def __init__(self, names: Names, variable: Variable) -> None:
        self._names = names
        self._variable = variable

    def compile(self, part: ast.expr) -> Value:
        match part:
            case ast.Constant(value=bool() | int() | float() | str() | None as constant):
                return self._apply(lambda: constant)
            case ast.Name(name) if name in self._names:
                return lambda variables: self._names[name]
            case ast.Name() | ast.Attribute() | ast.Subscript() if found := self._variable(part):
                return found
            case ast.Name(name):
                raise InvalidValue(f"unknown name {name}")
            case ast.List(items) | ast.Tuple(items):
                return self._apply(lambda *values: list(values), *items)
            case ast.Dict(keys, values) if None not in keys:
                return self._apply(_dict, *filter(None, keys), *values)
            case ast.Subscript(value, ast.Slice(lower, upper, step)):
                bounds = [bound or ast.Constant(None) for bound in (lower, upper, step)]
                return self._apply(_slice, value, *bounds)
            case ast.Subscript(value, index):
                return self._apply(_item, value, index)
        return self._operation(part)

    def _operation(self, part: ast.expr) -> Value:
        match part:
            case ast.UnaryOp(op, operand):
                return self._apply(_OPERATORS[type(op)], operand)
            case ast.BinOp(left, op, right) if type(op) in _OPERATORS:
                return self._apply(_OPERATORS[type(op)], left, right)
            case ast.BoolOp():
                return self._logical(part)
            case ast.Compare():
                return self._comparison(part)
            case ast.IfExp():
                return self._conditional(part)
            case ast.Call(ast.Name() as function, arguments, []):
                return self._apply(_call, function, *arguments)
            case ast.Call(ast.Attribute(value, name), arguments, []) if name in _METHOD_NAMES:
                return self._apply(_method(name), value, *arguments)
        raise InvalidValue(f"unsupported expression {ast.unparse(part)}")

    def _apply(self, function: Callable[..., Any], *parts: ast.expr) -> Value:
        values = [self.compile(part) for part in parts]
        return lambda variables: bounded(function(*[value(variables) for value in values]))

    def _logical(self, part: ast.BoolOp) -> Value:
        values = [self.compile(each) for each in part.values]
        deciding = isinstance(part.op, ast.Or)

        def value(variables: Any) -> Any:
            result: Any = None
            for each in values:
                result = each(variables)
                if bool(result) is deciding:
                    break
            return result

        return value

    def _comparison(self, part: ast.Compare) -> Value:
        first = self.compile(part.left)
        rest = [
            (_OPERATORS[type(op)], self.compile(each))
            for op, each in zip(part.ops, part.comparators, strict=True)
        ]

        def value(variables: Any) -> Any:
            left, result = first(variables), True
            for compare, each in rest:
                right = each(variables)
                result = compare(left, right)
                if not result:
                    break
                left = right
            return result

        return value

    def _conditional(self, part: ast.IfExp) -> Value:
        test, then, otherwise = map(self.compile, (part.test, part.body, part.orelse))
        return lambda variables: (then if test(variables) else otherwise)(variables)


def bounded(value: Any) -> Any:
    """Return the value, a tuple as a list; raise `InvalidValue` if it is too large."""
    if isinstance(value, tuple):
        value = list(value)
    if isinstance(value, int):
        _check_bits(value.bit_length())
    if isinstance(value, str | list | dict):
        _check_size(_size(value))
    return value


def _check_bits(bits: int) -> None:
    if bits > MAX_BITS:
        raise InvalidValue(f"number too large (limit: {MAX_BITS} bits)")


def _check_size(size: int, limit: int = MAX_ITEMS) -> None:
    if size > limit:
        raise InvalidValue(f"text or list too long (limit: {limit} characters and items)")


def _size(value: Any) -> int:
    """Return the number of nested items and of characters; more than `MAX_ITEMS` is a minimum."""
    size = 0
    parts = [value]
    while parts and size <= MAX_ITEMS:
        part = parts.pop()
        size += 1
        if isinstance(part, str):
            size += len(part) - 1
        elif isinstance(part, list | dict):
            size += len(part) - 1
            parts += [*part, *part.values()] if isinstance(part, dict) else part
    return size


def _item(value: Any, index: Any) -> Any:
    if not isinstance(value, str | list | dict):
        raise TypeError(f"{type(value).__name__} has no items")
    return value[index]


def _slice(value: Any, *bounds: Any) -> Any:
    return _item(value, slice(*bounds))


def _dict(*keys_and_values: Any) -> Any:
    number = len(keys_and_values) // 2
    return dict(zip(keys_and_values[:number], keys_and_values[number:], strict=True))


def _call(function: Any, *arguments: Any) -> Any:
    if not callable(function):
        raise InvalidValue(f"{function!r} is not a function")
    return function(*arguments)


def _method(name: str) -> Callable[..., Any]:
    def call(value: Any, *arguments: Any) -> Any:
        method = _METHODS.get((type(value), name))
        if method is None:
            raise InvalidValue(f"{type(value).__name__} has no method {name}()")
        return method(value, *arguments)

    return call


def _power(base: Any, exponent: Any) -> Any:
    # Powers of 1 and -1 are small, and those to a negative exponent are fractions.
    if isinstance(base, int) and isinstance(exponent, int) and abs(base) > 1:
        _check_bits(base.bit_length() * exponent)
    return base**exponent


def _shift(number: Any, bits: Any) -> Any:
    if isinstance(number, int) and isinstance(bits, int):
        _check_bits(number.bit_length() + bits)
    return number << bits


def _product(left: Any, right: Any) -> Any:
    for times, repeated in ((left, right), (right, left)):
        if isinstance(times, int) and isinstance(repeated, str | list):
            _check_size(_size(repeated) * times)
    return left * right


_WIDE_FIELD = re.compile(r"(?:\*|\d{4})[.\d*]*+[hlL]?[a-zA-Z%]")
"""A field of a format with a width of thousands of characters, or of an unknown one."""


def _modulo(left: Any, right: Any) -> Any:
    if isinstance(left, str) and _WIDE_FIELD.search(left):
        raise InvalidValue("text too long: format with a large width")
    return left % right


_OPERATORS: dict[type[ast.AST], Callable[..., Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: _product,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: _modulo,
    ast.Pow: _power,
    ast.LShift: _shift,
    ast.RShift: operator.rshift,
    ast.BitAnd: operator.and_,
    ast.BitOr: operator.or_,
    ast.BitXor: operator.xor,
    ast.UAdd: operator.pos,
    ast.USub: operator.neg,
    ast.Not: operator.not_,
    ast.Invert: operator.invert,
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.In: lambda item, container: item in container,
    ast.NotIn: lambda item, container: item not in container,
    ast.Is: operator.is_,
    ast.IsNot: operator.is_not,
}


def _replace(text: str, old: str, new: str, *count: int) -> str:
    _check_size((len(text) + 1) * (len(new) + 1), MAX_ITEMS * 100)
    return text.replace(old, new, *count)


def _join(text: str, parts: Any) -> str:
    _check_size(len(parts) * (len(text) + 1), MAX_ITEMS * 100)
    return text.join(parts)


_TEXT_METHODS = {
    *("lower", "upper", "capitalize", "title", "strip", "lstrip", "rstrip", "split", "rsplit"),
    *("splitlines", "startswith", "endswith", "find", "count", "index", "partition", "rpartition"),
    *("isdigit", "isalpha", "isalnum", "isnumeric", "islower", "isupper", "isspace"),
}
_METHODS: dict[tuple[type, str], Callable[..., Any]] = {
    **{(str, name): getattr(str, name) for name in _TEXT_METHODS},
    (str, "replace"): _replace,
    (str, "join"): _join,
    (list, "index"): list.index,
    (list, "count"): list.count,
    (dict, "get"): dict.get,
    (dict, "keys"): list,
    (dict, "values"): lambda value: list(value.values()),
    (dict, "items"): lambda value: [list(item) for item in value.items()],
}
"""The methods of values: those that neither change them nor repeat texts."""
_METHOD_NAMES = {name for _, name in _METHODS}


def _round(number: Any, digits: int | None = None) -> Any:
    if digits is not None and abs(digits) > MAX_DIGITS:
        raise InvalidValue(f"too many digits (limit: {MAX_DIGITS})")
    return round(number, digits)


FUNCTIONS: Names = {
    "list": list,
    "dict": dict,
    "str": str,
    "float": float,
    "int": int,
    "bool": bool,
    "abs": abs,
    "all": all,
    "any": any,
    "len": len,
    "map": lambda function, *items: list(map(function, *items)),
    "max": max,
    "min": min,
    "round": _round,
    "sorted": sorted,
    "sum": sum,
}
"""Python's own functions that reach nothing outside an expression."""
