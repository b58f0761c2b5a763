"""The hub's own tests.

What clients may do to the hub, and to each other through it, is not much. Some tests name the risks
that trials met with:

- R1 and R2, one who stops reading: test_stuck_consumer.py.
- R3, a flooder, and R4, a dead subscriber: test_flooder.py (and R4 in test_closing.py).
- R5, fragments, and R6, lengths without measure: test_connection.py (and R6 in
  test_splitter_fuzz.py).
- R7, frames behind the request: test_handshake.py.
- R8, a long flush to a thousand listeners, is accepted: nothing is to be tested but that all of
  them hear all (test_server.py).
- R9 is about measuring; that coalescing adds no delay is tested in test_server.py.
"""
