"""Compression of chunks, with bounds for what comes out of hostile files."""

from __future__ import annotations

from typing import Any, Protocol

from fibws.errors import BagError, BagFormatError, UnsupportedBag

MAX_SIZE = 256 * 2**20
"""Maximum size of an uncompressed chunk, unless its compressed data is large, too."""
MAX_RATIO = 64
"""A chunk may be larger than `MAX_SIZE` if it is at most so many times its compressed data."""
MAX_START = 64 * 2**20
"""Maximum size of what is restored of a damaged chunk, whose size cannot be trusted; likewise."""

METHODS = ("none", "bz2", "lz4")
"""The compression methods of .bag files."""


class _Decompressor(Protocol):
    @property
    def eof(self) -> bool: ...
    @property
    def unused_data(self) -> bytes | None: ...
    def decompress(self, data: bytes, max_length: int = -1) -> bytes: ...


def compress(data: bytes | bytearray, method: str) -> bytes | bytearray:
    """Return compressed data.

    Args:
        method: ``none``, ``bz2`` or ``lz4``.

    Raises:
        UnsupportedBag: the package for the method is not installed.
    """
    if method == "bz2":
        import bz2

        return bz2.compress(data)
    if method == "lz4":
        frame = _lz4_frame()
        # roslz4 reads independent blocks with a checksum of their content only.
        return bytes(
            frame.compress(
                data,
                block_size=frame.BLOCKSIZE_MAX256KB,
                block_linked=False,
                content_checksum=True,
                store_size=False,
            )
        )
    return data


def check_method(method: str) -> None:
    """Check that data can be compressed by a method.

    Raises:
        BagError: the method is unknown.
        UnsupportedBag: the package for it is not installed.
    """
    if method not in METHODS:
        raise BagError(
            f"compression {method!r} does not exist in .bag, expected {', '.join(METHODS)}"
        )
    if method == "lz4":
        _lz4_frame()


def decompress(data: bytes, method: str, size: int, place: str) -> bytes:
    """Return uncompressed data of exactly ``size`` bytes.

    Args:
        place: names the chunk in errors.

    Raises:
        BagFormatError: the data is damaged, or its size is another one.
        UnsupportedBag: the method is unknown, or its package is not installed.
    """
    if size > max(MAX_SIZE, MAX_RATIO * len(data)):
        raise BagFormatError(
            f"{place}: {len(data)} bytes claim to be {size} bytes uncompressed; the limit is "
            f"{MAX_SIZE // 2**20} MiB or {MAX_RATIO} times as many"
        )
    if method == "none":
        found = data
    else:
        found, fault = _decompress(data, method, size + 1, place)
        if fault:
            raise BagFormatError(f"{place}: {fault}")
    if len(found) != size:
        more = "more" if len(found) > size else f"only {len(found)}"
        raise BagFormatError(f"{place}: expected {size} bytes uncompressed, found {more}")
    return found


def decompress_all(data: bytes, method: str, place: str) -> bytes:
    """Return uncompressed data whose size is not known; raise as `decompress`."""
    limit = max(MAX_SIZE, MAX_RATIO * len(data))
    found, fault = _decompress(data, method, limit + 1, place)
    if fault or len(found) > limit:
        raise BagFormatError(f"{place}: {fault or f'more than {limit} bytes uncompressed'}")
    return found


def decompress_start(data: bytes, method: str, place: str) -> bytes:
    """Return the uncompressed start of data that was cut off; empty if nothing can be read."""
    if method == "none":
        return data
    return _decompress(data, method, max(MAX_START, MAX_RATIO * len(data)), place)[0]


def _decompress(data: bytes, method: str, limit: int, place: str) -> tuple[bytes, str]:
    """Return at most ``limit`` bytes, and what is wrong with the data; empty if nothing is."""
    if method == "zstd":
        return _decompress_zstd(data, limit, place)
    parts = []
    size, rest = 0, data
    while rest and size < limit:
        decompressor = _decompressor(method, place)
        try:
            # In steps, so that damaged data still gives what comes before the damage.
            for begin in range(0, len(rest), _STEP):
                step = rest[begin : begin + _STEP]
                while part := decompressor.decompress(step, min(_OUTPUT, limit - size)):
                    parts.append(part)
                    size += len(part)
                    step = b""
                    if decompressor.eof or size >= limit:
                        break
                if decompressor.eof or size >= limit:
                    break
        except (OSError, RuntimeError, ValueError, EOFError) as error:
            return b"".join(parts), f"invalid {method} data ({error})"
        if size >= limit:
            break
        if not decompressor.eof:
            return b"".join(parts), f"incomplete {method} data"
        rest = (decompressor.unused_data or b"") + rest[begin + _STEP :]
    return b"".join(parts), ""


_STEP = 64 * 1024
_OUTPUT = 2**20
"""Maximum output of a step; lz4 allocates as much."""


def zstandard(place: str) -> Any:
    """Return the package zstandard.

    Raises:
        UnsupportedBag: it is not installed.
    """
    try:
        import zstandard
    except ImportError:
        fault = f"{place}: zstd needs the package zstandard: pip install 'fibws[mcap]'"
        raise UnsupportedBag(fault, "compression") from None
    return zstandard


def _decompress_zstd(data: bytes, limit: int, place: str) -> tuple[bytes, str]:
    package = zstandard(place)
    parts = []
    size = 0
    try:
        with package.ZstdDecompressor().stream_reader(data, read_across_frames=True) as reader:
            while size < limit and (part := reader.read(min(_OUTPUT, limit - size))):
                parts.append(part)
                size += len(part)
    except package.ZstdError as error:
        return b"".join(parts), f"invalid zstd data ({error})"
    return b"".join(parts), ""


def _decompressor(method: str, place: str) -> _Decompressor:
    if method == "bz2":
        import bz2

        return bz2.BZ2Decompressor()
    if method == "lz4":
        found: _Decompressor = _lz4_frame().LZ4FrameDecompressor()
        return found
    raise UnsupportedBag(f"{place}: unknown compression {method!r}", "compression")


def _lz4_frame() -> Any:
    try:
        import lz4.frame
    except ImportError:
        fault = "lz4 compression needs the package lz4: pip install 'fibws[bags]'"
        raise UnsupportedBag(fault, "compression") from None
    return lz4.frame
