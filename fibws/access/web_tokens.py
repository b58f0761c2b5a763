"""JSON web tokens (RFC 7519) as proofs of principals; needs PyJWT, fibws's extra ``auth``.

``sub`` is the principal's name, and ``fibws`` its rights and limits, as in the file of tokens:

    {"sub": "teleop", "exp": 1830000000, "fibws": {"allow": {"publish": ["/cmd_vel"]}}}

Which algorithm counts is a setting and not the token's choice (RFC 8725, section 3.1).
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fibws.access.limits import Limits
from fibws.access.rights import KEYS, Principal, Rights, check_keys, check_name
from fibws.access.token_file import ANONYMOUS
from fibws.errors import AccessError, AuthenticationError

if TYPE_CHECKING:
    import jwt

ALGORITHMS = ("HS256", "EdDSA", "ES256", "RS256")
SHORTEST_SECRET = 32
"""Bytes of a key for HS256 (RFC 7518, section 3.2)."""
SHORTEST_RSA_KEY = 2048
"""Bits of a key for RS256 (RFC 7518, section 3.3)."""
CLAIM = "fibws"


class WebTokens:
    """Checks tokens that one issuer has signed.

    Args:
        path: of the key: for HS256 a secret of at least 32 bytes, otherwise a public key in PEM, or
            a set of keys (JWKS, RFC 7517) in JSON.
        algorithm: one of `ALGORITHMS`.
        audience: the value that ``aud`` must have; None if it must be absent.
        leeway: seconds by which clocks may differ.

    Raises:
        AccessError: the key is invalid or too short, or PyJWT is not installed.
    """

    def __init__(
        self, path: Path, algorithm: str, audience: str | None = None, leeway: float = 10.0
    ) -> None:
        try:
            import jwt
        except ImportError:
            raise AccessError(
                "JSON web tokens need PyJWT; install it with: pip install 'fibws[auth]'"
            ) from None
        self._jwt = jwt
        if algorithm not in ALGORITHMS:
            raise AccessError(
                "the algorithm (--jwt-algorithm) must be one of "
                f"{', '.join(ALGORITHMS)}, got {algorithm}"
            )
        self._path = path
        self._algorithm = algorithm
        self._audience = audience
        self._leeway = leeway
        self._keys: list[tuple[str | None, Any]] = []
        self._data = b""
        self.reload()

    def reload(self) -> bool:
        """Read the key again, and return whether it is another one.

        Raises:
            AccessError: it cannot be used; the old one is kept.
        """
        try:
            data = self._path.read_bytes()
        except OSError as error:
            raise AccessError(f"cannot read {self._path}: {error.strerror}") from None
        if self._algorithm == "HS256":
            self._keys = [(None, self._secret(data.rstrip(b"\r\n")))]
        elif data.lstrip().startswith(b"{"):
            self._keys = self._key_set(data)
        else:
            self._keys = [(None, self._public_key(data))]
        old, self._data = self._data, data
        return old != data

    def principal(self, token: str) -> Principal:
        """Return the principal of a token.

        Raises:
            AuthenticationError: it is not signed by a known key, expired, or for somebody else.
        """
        jwt = self._jwt
        try:
            claims = jwt.decode(
                token,
                self._key_for(token),
                algorithms=[self._algorithm],
                audience=self._audience,
                leeway=self._leeway,
                options={"require": ["sub"]},
            )
        except jwt.ExpiredSignatureError:
            raise AuthenticationError("the token expired") from None
        except (jwt.PyJWTError, ValueError) as error:
            raise AuthenticationError(f"invalid token: {self._fault(error)}") from None
        try:
            name = check_name(claims["sub"])
            if name == ANONYMOUS:
                raise AccessError(f"the name {ANONYMOUS} is for clients without a token")
            rights = claims.get(CLAIM, {})
            if not isinstance(rights, dict):
                raise AccessError(f"{CLAIM} must be an object")
            check_keys(rights, (*KEYS, "limits"), CLAIM)
            parsed = Rights.parse(rights, name=name, where=CLAIM)
            limits = Limits.parse(rights.get("limits", {}), f"{CLAIM}.limits")
        except AccessError as error:
            raise AuthenticationError(f"invalid token: {error}") from None
        expires = claims.get("exp")
        try:
            expires = None if expires is None else int(expires) + self._leeway
        except OverflowError:
            raise AuthenticationError("invalid token: exp is too large") from None
        return Principal(name, parsed, expires, limits, "JWT")

    def _fault(self, error: Exception) -> str:
        """Return why the library refuses a token."""
        jwt = self._jwt
        named = re.search(r"\((exp|nbf|iat)\)", str(error))
        match error:
            case jwt.ImmatureSignatureError():
                return f"it is not valid yet ({named[1] if named else 'nbf'})"
            case jwt.InvalidSignatureError():
                return "its signature is not by the hub's key"
            case jwt.InvalidAlgorithmError():
                return f"its algorithm (alg) must be {self._algorithm}"
            case jwt.MissingRequiredClaimError():
                return f"missing {error.claim}"
            case jwt.InvalidAudienceError():
                expected = f" but {self._audience}" if self._audience else ""
                return f"its audience (aud) is not this hub{expected}"
        if "Subject" in str(error):  # Older versions of the library have no class for it.
            return "sub must be a string"
        return f"{named[1]} must be an integer" if named else "it is not a JSON web token"

    def _key_for(self, token: str) -> Any:
        wanted = self._jwt.get_unverified_header(token).get("kid")
        if len(self._keys) == 1 and None in (wanted, self._keys[0][0]):
            return self._keys[0][1]  # A token need not name the only key.
        for id_, key in self._keys:
            if id_ == wanted:
                return key
        raise AuthenticationError("invalid token: its key (kid) is unknown")

    def _secret(self, data: bytes) -> bytes:
        if data.startswith(b"-----BEGIN") or data.lstrip().startswith(b"{"):
            raise AccessError(
                f"{self._path} is not a secret for HS256 but a key for another algorithm; set "
                f"--jwt-algorithm to {', '.join(ALGORITHMS[1:-1])} or {ALGORITHMS[-1]}"
            )
        if len(data) < SHORTEST_SECRET:
            raise AccessError(
                f"{self._path}: a key for HS256 must have at least {SHORTEST_SECRET} bytes, "
                f"got {len(data)}; create one with: openssl rand -hex {SHORTEST_SECRET}"
            )
        return data

    def _public_key(self, data: bytes) -> Any:
        return self._prepare(data)

    def _prepare(self, data: bytes) -> Any:
        algorithm: jwt.algorithms.Algorithm = self._jwt.get_algorithm_by_name(self._algorithm)
        try:
            key = algorithm.prepare_key(data)
        except (ValueError, TypeError, self._jwt.PyJWTError):
            # The library's own text names Python objects.
            raise AccessError(
                f"{self._path} is not a public key for {self._algorithm} in PEM"
                f"{_advice_on(self._path, data)}"
            ) from None
        if hasattr(key, "private_bytes"):
            raise AccessError(f"{self._path} is a private key; the hub needs the public one")
        return self._strong(key)

    def _strong(self, key: Any) -> Any:
        """Return a public key; raise `AccessError` if it is too short."""
        if self._algorithm == "RS256" and key.key_size < SHORTEST_RSA_KEY:
            raise AccessError(
                f"{self._path}: a key for RS256 must have at least {SHORTEST_RSA_KEY} bits, "
                f"got {key.key_size}; create one with: "
                "openssl genpkey -algorithm RSA -pkeyopt rsa_keygen_bits:3072"
            )
        return key

    def _key_set(self, data: bytes) -> list[tuple[str | None, Any]]:
        fault = f"{self._path} is not a set of keys (JWKS)"
        try:
            document = json.loads(data)
        except json.JSONDecodeError as error:
            place = f"line {error.lineno}, column {error.colno}"
            raise AccessError(f"{fault}: invalid JSON ({place})") from None
        except (ValueError, RecursionError):
            raise AccessError(f"{fault}: invalid JSON") from None
        if "kty" in document:
            raise AccessError(f'{fault} but one key; write {{"keys": [KEY]}}')
        try:
            keys = self._jwt.PyJWKSet.from_dict(document).keys
        except (ValueError, TypeError, AttributeError, self._jwt.PyJWTError):
            raise AccessError(f'{fault}: it needs "keys", a list with valid public keys') from None
        found = [
            (each.key_id, self._strong(each.key))
            for each in keys
            if each.algorithm_name == self._algorithm
        ]
        if not found:
            raise AccessError(f"{self._path} has no key for {self._algorithm}")
        return found


def _advice_on(path: Path, data: bytes) -> str:
    if b"-----BEGIN CERTIFICATE-----" not in data:
        return ""
    return f" but a certificate; extract its key with: openssl x509 -pubkey -noout -in {path}"
