"""Serves topics with images to browsers over HTTP, as MJPEG: http://wiki.ros.org/web_video_server.

    Subscription ── Feed (the newest frame of one topic, for all its viewers) ── a viewer's loop
    GET /stream?topic=/camera/image/compressed      multipart/x-mixed-replace, newest frames only
    GET /snapshot?topic=...                         one frame
    GET /stream_viewer?topic=... , GET /            pages

A viewer has at most one frame under way: slow ones get fewer frames, and delay nobody.
"""

from __future__ import annotations

import asyncio
import html
import io
import logging
import re
import socket
from collections import Counter
from collections.abc import AsyncIterator, Coroutine
from contextlib import asynccontextmanager, suppress
from http import HTTPStatus
from typing import Any, NamedTuple
from urllib.parse import parse_qs, quote, urlsplit

import click
import h11

import fibws
from fibws.cli import node_program
from fibws.origins import AllowedOrigins, OwnHosts, machine_names
from fibws.suggestions import suggestion
from fibws.values.message_sizes import check_image

PORT = 8080
ADDRESS = "127.0.0.1"
BOUNDARY = "fibws-frame"
IMAGE, COMPRESSED = "sensor_msgs/Image", "sensor_msgs/CompressedImage"
QUALITY = 80
"""The quality of JPEG for images that are not compressed."""
MOST_VIEWERS = 100
MOST_CONNECTIONS = 2 * MOST_VIEWERS
"""More are closed at once, without an answer."""
MOST_REQUEST = 16_384
"""Bytes of a request."""
PATIENCE = 10.0
"""Seconds that a request, the first frame of a snapshot, or a write may take."""
_MODES = {
    "mono8": ("L", "L"),
    "8UC1": ("L", "L"),
    "rgb8": ("RGB", "RGB"),
    "bgr8": ("RGB", "BGR"),
    "8UC3": ("RGB", "BGR"),
    "rgba8": ("RGB", "RGBX"),
    "bgra8": ("RGB", "BGRX"),
    "8UC4": ("RGB", "BGRX"),
}
"""How Pillow reads the pixels of each encoding."""


class Refused(Exception):
    """A request is answered with an error.

    Args:
        status: the HTTP status.
        text: what is wrong, and what would be right.
    """

    def __init__(self, status: HTTPStatus, text: str) -> None:
        self.status = status
        super().__init__(text)


class Frame(NamedTuple):
    """One image as it is sent."""

    number: int
    media_type: str
    data: bytes


class ImageFeed:
    """The newest frame of one topic.

    Args:
        node: the node that subscribes.
        topic: the topic's global name.
        type_: `IMAGE` or `COMPRESSED`.
        quality: that of JPEG, 1 to 100, for an `IMAGE`.
    """

    def __init__(self, node: fibws.Node, topic: str, type_: str, quality: int) -> None:
        self.viewers = 0
        self.fault: Refused | None = None
        """Why the newest image cannot be shown."""
        self._has_ended = False
        self._has_warned = False
        self._frame: Frame | None = None
        self._news = asyncio.Event()
        self._topic, self._log = topic, node.log
        self._quality = quality
        self._subscription: fibws.Subscription[Any] = node.subscribe(topic, type_, queue_size=1)
        self._task = asyncio.create_task(self._follow(), name=f"images of {topic}")

    def close(self) -> None:
        """Unsubscribe."""
        self._task.cancel()
        self._subscription.close()

    async def newer(self, number: int) -> Frame:
        """Wait for a frame with another number than this one; 0 for the first frame.

        Raises:
            Refused: there are no more images; or the first one cannot be shown. Later ones are
                left out then.
        """
        while self._frame is None or self._frame.number == number:
            if self.fault is not None and (self._has_ended or not number):
                raise self.fault
            await self._news.wait()
        return self._frame

    async def _follow(self) -> None:
        number = 0
        try:
            async for message in self._subscription:
                number += 1
                try:
                    self._frame, self.fault = await self._encoded(number, message), None
                except Refused as fault:
                    self._leave_out(fault)
                self._announce()
        except fibws.FibwsError as error:
            self.fault = Refused(HTTPStatus.FORBIDDEN, str(error))
        finally:
            self._has_ended = True
            self._announce()

    async def _encoded(self, number: int, message: Any) -> Frame:
        """Return an image as it is sent; raise `Refused` if it cannot be shown."""
        if not hasattr(message, "format"):
            return Frame(number, "image/jpeg", await asyncio.to_thread(self._jpeg, message))
        data = bytes(message.data)
        is_png = data.startswith(b"\x89PNG")
        return Frame(number, "image/png" if is_png else "image/jpeg", data)

    def _leave_out(self, fault: Refused) -> None:
        """Leave out an image that cannot be shown; the first one is logged."""
        self.fault = fault
        if not self._has_warned:
            self._has_warned = True
            text = "%s: %s; more images that cannot be shown are not logged."
            self._log.warning(text, self._topic, fault)

    def _announce(self) -> None:
        """Wake all who wait for a frame."""
        self._news.set()
        self._news = asyncio.Event()

    def _jpeg(self, image: Any) -> bytes:
        try:
            from PIL import Image
        except ModuleNotFoundError:
            raise Refused(
                HTTPStatus.NOT_IMPLEMENTED,
                "images that are not compressed need Pillow where the server runs: "
                "pip install 'fibws[images]'",
            ) from None
        modes = _MODES.get(image.encoding)
        if modes is None:
            known = ", ".join(_MODES)
            text = f"encoding {image.encoding} cannot be shown, only {known}"
            raise Refused(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, text)
        mode, raw = modes
        size = (image.width, image.height)
        try:
            check_image(*size, image.step, len(raw), len(image.data))
            picture = Image.frombuffer(mode, size, bytes(image.data), "raw", raw, image.step, 1)
            written = io.BytesIO()
            picture.save(written, "JPEG", quality=self._quality)
        except (ValueError, OSError, OverflowError, MemoryError, SystemError) as error:
            text = f"the image of {size[0]} x {size[1]} pixels is invalid: {error}"
            raise Refused(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, text) from None
        return written.getvalue()


class Feeds:
    """The topics that somebody views.

    Args:
        node: the node that subscribes.
    """

    def __init__(self, node: fibws.Node) -> None:
        self.node = node
        self._feeds: dict[tuple[str, int], ImageFeed] = {}
        self._viewers = 0

    @asynccontextmanager
    async def view(self, query: dict[str, str]) -> AsyncIterator[ImageFeed]:
        """View the topic that a query names; it is subscribed to while somebody does.

        Raises:
            Refused: the query is invalid, or there are too many viewers.
        """
        if self._viewers == MOST_VIEWERS:
            text = f"too many viewers (limit {MOST_VIEWERS})"
            raise Refused(HTTPStatus.SERVICE_UNAVAILABLE, text)
        self._viewers += 1
        try:
            topic, type_ = await self._choose(query)
            quality = _quality(query) if type_ == IMAGE else 0
            key = (topic, quality)
            feed = self._feeds.get(key)
            if feed is None:
                feed = self._feeds[key] = ImageFeed(self.node, topic, type_, quality)
            feed.viewers += 1
            try:
                yield feed
            finally:
                feed.viewers -= 1
                if not feed.viewers:
                    feed.close()
                    del self._feeds[key]
        finally:
            self._viewers -= 1

    async def topics(self) -> dict[str, str]:
        """Return the topics with images, each with its type."""
        found = {}
        for type_ in (IMAGE, COMPRESSED):
            for topic in await self.node.graph.topics_of_type(type_):
                found[topic] = type_
        return dict(sorted(found.items()))

    async def _choose(self, query: dict[str, str]) -> tuple[str, str]:
        """Return the topic to subscribe to, and its type."""
        name = query.get("topic", "")
        if not name:
            raise Refused(HTTPStatus.BAD_REQUEST, "expected ?topic=/camera/image/compressed")
        try:
            topic = self.node.resolve(name)
        except fibws.InvalidName as error:
            raise Refused(HTTPStatus.BAD_REQUEST, str(error)) from None
        if query.get("type") == "ros_compressed" and not topic.endswith("/compressed"):
            topic += "/compressed"
        type_ = await self.node.graph.topic_type(topic)
        if type_ in (IMAGE, COMPRESSED):
            return topic, type_
        known = await self.topics()
        if type_:
            text = f"{topic} has messages of {type_}, expected {IMAGE} or {COMPRESSED}"
            raise Refused(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, text)
        hint = suggestion(topic, list(known)) or "."
        raise Refused(HTTPStatus.NOT_FOUND, f"topic {topic} is not published{hint}")


class RefusalLog:
    """Logs what is refused: of each kind the first, the tenth, the hundredth and so on.

    Args:
        log: the node's logger.
    """

    def __init__(self, log: logging.Logger) -> None:
        self._log = log
        self._counts: Counter[str] = Counter()

    def add(self, kind: str, text: str) -> None:
        """Log a refusal, if its number is due."""
        self._counts[kind] += 1
        count = self._counts[kind]
        if str(count).strip("0") == "1":
            self._log.warning("%s (refused %d times)", ascii(text)[1:-1], count)


class Viewer:
    """One connection, which has one request.

    Args:
        feeds: the topics that are viewed.
        pages: decides which pages may view them.
        refusals: logs what is refused to other pages.
        reader: receives the request.
        writer: sends the response.
    """

    def __init__(
        self,
        feeds: Feeds,
        pages: AllowedOrigins,
        refusals: RefusalLog,
        reader: asyncio.StreamReader,
        writer: asyncio.StreamWriter,
    ) -> None:
        self._feeds = feeds
        self._pages = pages
        self._refusals = refusals
        self._reader = reader
        self._writer = writer
        self._wants_body = True
        # A write waits until the frame is on its way.
        writer.transport.set_write_buffer_limits(0)

    async def serve(self) -> None:
        """Answer the request, then close the connection."""
        try:
            async with asyncio.timeout(PATIENCE):
                request = await self._request()
            await self._respond(request)
        except Refused as fault:
            await self._refuse(fault.status, str(fault))
        except h11.RemoteProtocolError as error:
            await self._refuse(HTTPStatus.BAD_REQUEST, str(error))
        except fibws.FibwsError as error:
            await self._refuse(HTTPStatus.BAD_GATEWAY, str(error))
        except (OSError, TimeoutError, EOFError):
            pass  # The viewer has gone.
        except asyncio.CancelledError:
            pass  # The server ends; asyncio would log this as an error.
        finally:
            self._writer.close()

    async def _request(self) -> h11.Request:
        connection = h11.Connection(h11.SERVER, max_incomplete_event_size=MOST_REQUEST)
        while True:
            event = connection.next_event()
            if isinstance(event, h11.Request):
                return event
            if event is not h11.NEED_DATA:
                raise EOFError
            connection.receive_data(await self._reader.read(4096))

    async def _respond(self, request: h11.Request) -> None:
        self._wants_body = request.method != b"HEAD"
        if request.method not in (b"GET", b"HEAD"):
            text = f"expected GET, got {request.method.decode()}"
            raise Refused(HTTPStatus.METHOD_NOT_ALLOWED, text)
        self._check_page(request)
        try:
            target = urlsplit(request.target.decode())
        except ValueError as error:
            raise Refused(HTTPStatus.BAD_REQUEST, str(error)) from None
        fields = {key: values[-1] for key, values in parse_qs(target.query).items()}
        match target.path:
            case "/stream":
                await self._stream(fields)
            case "/snapshot":
                await self._snapshot(fields)
            case "/stream_viewer":
                await self._send_page(f'<img src="/stream?{html.escape(target.query)}" alt="">')
            case "/":
                links = [_link(topic) for topic in await self._feeds.topics()]
                await self._send_page(f"<ul>{''.join(links)}</ul>" if links else "No images.")
            case path:
                text = f"{path} not found: see /, /stream, /snapshot and /stream_viewer"
                raise Refused(HTTPStatus.NOT_FOUND, text)

    def _check_page(self, request: h11.Request) -> None:
        """Refuse pages of other sites, and of foreign names for this machine (DNS rebinding).

        Raises:
            Refused: a header names another site.
        """
        headers = {name: value.decode("latin-1") for name, value in request.headers}
        host, origin = headers.get(b"host", ""), headers.get(b"origin")
        text = self._pages.refusal_of(origin, host) if origin is not None else None
        if text is None and not self._pages.knows_host(host):
            text = f"unknown host {host[:100]!r}: use this machine's name or address"
        if text is not None:
            self._refusals.add("page", text)
            raise Refused(HTTPStatus.FORBIDDEN, text)

    async def _snapshot(self, fields: dict[str, str]) -> None:
        async with self._feeds.view(fields) as feed:
            try:
                async with asyncio.timeout(PATIENCE):
                    frame = await feed.newer(0)
            except TimeoutError:
                text = f"no image within {PATIENCE:g} s"
                raise Refused(HTTPStatus.GATEWAY_TIMEOUT, text) from None
        await self._send(HTTPStatus.OK, frame.media_type, frame.data)

    async def _stream(self, fields: dict[str, str]) -> None:
        async with self._feeds.view(fields) as feed:
            gone = asyncio.create_task(_ended(self._reader), name="the viewer goes")
            try:
                frame = await _before(gone, feed.newer(0))
                media_type = f"multipart/x-mixed-replace; boundary={BOUNDARY}"
                await self._write(_head(HTTPStatus.OK, media_type) + f"--{BOUNDARY}".encode())
                while frame is not None and self._wants_body:
                    # The boundary behind a frame lets browsers show it at once.
                    head = f"\r\nContent-Type: {frame.media_type}\r\n"
                    head += f"Content-Length: {len(frame.data)}\r\n\r\n"
                    end = f"\r\n--{BOUNDARY}"
                    await self._write(b"".join((head.encode(), frame.data, end.encode())))
                    with suppress(Refused):  # The stream ends, since it has begun.
                        frame = await _before(gone, feed.newer(frame.number))
                        continue
                    return
            finally:
                gone.cancel()

    async def _send(self, status: HTTPStatus, media_type: str, body: bytes) -> None:
        head = _head(status, media_type, len(body))
        await self._write(head + body if self._wants_body else head)

    async def _refuse(self, status: HTTPStatus, text: str) -> None:
        with suppress(OSError, TimeoutError):
            await self._send(status, "text/plain; charset=utf-8", f"{text}\n".encode())

    async def _send_page(self, body: str) -> None:
        page = f"<!doctype html><title>Images</title>{body}\n"
        await self._send(HTTPStatus.OK, "text/html; charset=utf-8", page.encode())

    async def _write(self, data: bytes) -> None:
        self._writer.write(data)
        async with asyncio.timeout(PATIENCE):
            await self._writer.drain()


async def _ended(reader: asyncio.StreamReader) -> None:
    """Wait for the end of a connection; what is sent before is ignored."""
    with suppress(OSError):
        while await reader.read(4096):
            pass


async def _before(gone: asyncio.Task[None], newer: Coroutine[Any, Any, Frame]) -> Frame | None:
    """Wait for a frame; return None if the viewer goes before it."""
    frame = asyncio.ensure_future(newer)
    try:
        await asyncio.wait((gone, frame), return_when=asyncio.FIRST_COMPLETED)
        return None if gone.done() else frame.result()
    finally:
        frame.cancel()


def _head(status: HTTPStatus, media_type: str, length: int | None = None) -> bytes:
    headers = {
        "Content-Type": media_type,
        "Cache-Control": "no-store",
        "Connection": "close",
        "X-Content-Type-Options": "nosniff",
        "Content-Security-Policy": "default-src 'none'; img-src 'self'",
    }
    if length is not None:
        headers["Content-Length"] = str(length)
    lines = "".join(f"{name}: {value}\r\n" for name, value in headers.items())
    return f"HTTP/1.1 {status.value} {status.phrase}\r\n{lines}\r\n".encode()


def _quality(query: dict[str, str]) -> int:
    text = query.get("quality", str(QUALITY))
    if not re.fullmatch("0*([1-9][0-9]?|100)", text, re.ASCII):
        text = f"quality must be an integer from 1 to 100, got {text[:20]!r}"
        raise Refused(HTTPStatus.BAD_REQUEST, text)
    return int(text[-3:])


def _link(topic: str) -> str:
    place = f"topic={quote(topic)}"
    name = html.escape(topic)
    snapshot = f'<a href="/snapshot?{place}">snapshot</a>'
    return f'<li><a href="/stream_viewer?{place}">{name}</a> ({snapshot})</li>'


async def serve(node: fibws.Node) -> None:
    """Serve images until the node ends.

    Raises:
        ClickException: the port cannot be listened on.
    """
    address = str(await node.params.get("~address", ADDRESS))
    port = int(await node.params.get("~port", PORT))
    feeds = Feeds(node)
    pages = AllowedOrigins((), OwnHosts([address, *machine_names(socket.gethostname())]))
    refusals = RefusalLog(node.log)
    connections: set[asyncio.StreamWriter] = set()

    async def accept(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        if len(connections) == MOST_CONNECTIONS:
            text = f"Too many connections: the limit of {MOST_CONNECTIONS} is reached"
            refusals.add("connections", text)
            writer.close()
            return
        connections.add(writer)
        try:
            await Viewer(feeds, pages, refusals, reader, writer).serve()
        finally:
            connections.remove(writer)

    try:
        server = await asyncio.start_server(accept, address, port, limit=MOST_REQUEST)
    except (OSError, OverflowError) as error:
        raise click.ClickException(f"cannot listen at {address}, port {port}: {error}") from None
    async with server:
        found = server.sockets[0].getsockname()[1]
        node.log.info("Waiting for connections at http://%s:%d/", address, found)
        await node.spin()


@click.command(context_settings=node_program.SETTINGS)
@node_program.node("web_video_server", anonymous=False)
def command(node: fibws.Node) -> None:
    """Serve topics with images to browsers, as MJPEG.

    /stream?topic=TOPIC streams a topic, /snapshot?topic=TOPIC is one image, / lists the topics. The
    parameters ~port (8080) and ~address (127.0.0.1; 0.0.0.0 for other machines, which need no
    token) say where.
    """

    async def program() -> None:
        async with node:
            await serve(node)

    node_program.run(program())


if __name__ == "__main__":
    command(prog_name="python -m fibws.programs.web_video_server")
