"""Debian's rostopic and genpy, run by the system's Python, for comparison.

Each line of input is JSON, ``[function, arguments]``; each line of output is a JSON value.
"""

# mypy: ignore-errors
from __future__ import annotations

import base64
import contextlib
import io
import json
import sys

import genpy
import genpy.dynamic
import rostopic

CLASSES = {}
BUILTIN = {"time": genpy.Time, "duration": genpy.Duration}

# Debian has the messages of two packages only.
genpy.message.get_message_class = lambda name: BUILTIN.get(name) or CLASSES.get(name)


def message_class(type_, full_text):
    if type_ not in CLASSES:
        CLASSES.update(genpy.dynamic.generate_dynamic(type_, full_text))
    return CLASSES[type_]


def message(type_, full_text, value):
    """Return a message that was serialized and deserialized."""
    found = message_class(type_, full_text)()
    fill(found, value)
    stream = io.BytesIO()
    found.serialize(stream)
    return message_class(type_, full_text)().deserialize(stream.getvalue())


def fill(found, value):
    for name, type_ in zip(found.__slots__, found._get_types(), strict=True):
        base, bracket, _ = type_.partition("[")
        each = value[name]
        if bracket and base in ("uint8", "char"):
            setattr(found, name, base64.b64decode(each))
        elif bracket:
            setattr(found, name, [element(base, one) for one in each])
        else:
            setattr(found, name, element(base, each))


def element(type_, value):
    if type_ == "time":
        return genpy.Time(value["secs"], value["nsecs"])
    if type_ == "duration":
        return genpy.Duration(value["secs"], value["nsecs"])
    if "/" in type_:
        found = CLASSES[type_]()
        fill(found, value)
        return found
    return float("nan") if value is None else value


def echo(type_, full_text, value, noarr=False, nostr=False, width=None, offset=None):
    show = rostopic.CallbackEcho("/x", None).custom_strify_message
    return show(
        message(type_, full_text, value),
        time_offset=None if offset is None else genpy.Time(0, offset),
        fixed_numeric_width=width,
        value_transform=rostopic.create_value_transform(nostr, noarr),
    )


def field(type_, full_text, value, path):
    picked = rostopic.msgevalgen(path)(message(type_, full_text, value))
    return rostopic.CallbackEcho("/x", None).custom_strify_message(picked)


def plot(type_, full_text, value, now, noarr=False, nostr=False, offset=None):
    found = message(type_, full_text, value)
    chosen = rostopic.create_field_filter(nostr, noarr)
    has_header = getattr(found, "_has_header", False)
    row = rostopic._str_plot(
        found,
        time_offset=None if offset is None else genpy.Time(0, offset),
        current_time=None if has_header else genpy.Time(0, now),
        field_filter=chosen,
    )
    return ["%" + rostopic._str_plot_fields(found, "field", chosen), row]


def read(type_, full_text, words):
    import yaml

    found = message_class(type_, full_text)()
    try:
        genpy.message.fill_message_args(found, [yaml.safe_load(word) for word in words])
        found.serialize(io.BytesIO())
    except (genpy.MessageException, ValueError, TypeError) as error:
        return {"fault": str(error)}
    return {"text": str(found)}


def printed(function, *arguments):
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        function(*arguments)
    return out.getvalue()


def hz(topics):
    rates = rostopic.ROSTopicHz(-1)
    for topic, deltas in topics.items():
        rates.set_times(deltas, topic=topic)
        rates.set_msg_tn(1.0, topic=topic)
    return printed(rates.print_hz, list(topics))


def delay(delays):
    found = rostopic.ROSTopicDelay(-1)
    found.delays, found.msg_tn = delays, 1.0
    return printed(found.print_delay)


def bw(sizes, times, now):
    found = rostopic.ROSTopicBandwidth()
    found.sizes, found.times = sizes, times
    rostopic.time.time = lambda: now
    return printed(found.print_bw)


def listed(published, subscribed, publishers_only, subscribers_only, verbose):
    rostopic._master_get_topic_types = lambda master: []
    return printed(
        rostopic._sub_rostopic_list,
        None,
        published,
        subscribed,
        publishers_only,
        subscribers_only,
        verbose,
    )


def info(topic, type_, publishers, subscribers):
    rostopic._master_get_topic_types = lambda master: [(topic, type_)]
    rostopic.get_topic_list = lambda master: (
        [(topic, type_, publishers)] if publishers else [],
        [(topic, type_, subscribers)] if subscribers else [],
    )
    rostopic.get_api = lambda master, node: "address"
    return printed(rostopic._rostopic_info, topic)


for line in sys.stdin:
    question, arguments = json.loads(line)
    print(json.dumps(globals()[question](**arguments)), flush=True)
