"""The hub's tests.

Some tests name risks of misbehaving clients:

- R1 and R2, a client that stops reading: websocket/test_stuck_consumer.py.
- R3, a flooding publisher, and R4, a dead subscriber: websocket/test_flooder.py (R4 also in
  websocket/test_closing.py).
- R5, fragments, and R6, huge announced lengths: websocket/test_connection.py and
  websocket/test_large_messages.py.
- R7, frames behind the request: websocket/test_handshake.py.
- R8, long flushes to a thousand subscribers, is accepted: test_server.py checks that all get all.
"""
