"""Message classes from a definition's full text, as connections and bags carry it.

Source: genpy.dynamic of ROS 1.
"""

from __future__ import annotations

from fibws.errors import InterfaceError
from fibws.interfaces.catalogue import TextDefinitions
from genpy.classes import make_class
from genpy.errors import MsgGenerationException
from genpy.message import Message

__all__ = ["MsgGenerationException", "generate_dynamic"]


def generate_dynamic(core_type: str, msg_cat: str) -> dict[str, type[Message]]:
    """Return the classes of a type and of all types nested in it, by their names.

    They are independent of the definitions that are installed, whose types may have changed.

    Args:
        core_type: the type, ``std_msgs/Header``.
        msg_cat: its definition, followed by those of the nested types, each after a line of 80
            ``=`` and one with its name (``MSG: package/Type``): a class's ``_full_text``.

    Raises:
        MsgGenerationException: the text is invalid, or lacks a nested type.
    """
    classes: dict[str, type[Message]] = {}
    try:
        definitions = TextDefinitions(core_type, msg_cat)

        def find(name: str) -> type[Message]:
            definition = definitions.message(name)
            if definition.type not in classes:
                classes[definition.type] = make_class(
                    definition, "msg", definition.name, definitions, find
                )
            return classes[definition.type]

        for name in definitions.types:
            find(name)
    except InterfaceError as error:
        raise MsgGenerationException(str(error)) from None
    return classes
