"""Actions: goals that take their time, tell how far they have come, and can be canceled.

    ActionServer ── ServerGoal ── Record                ActionClient ── ClientGoal
      over topics or over operations                      over topics or over operations
                    └───────────────── Actions, a part of the session ─┘

A server decides what becomes of a goal; its subclasses only tell the graph, each in its own way.
"""
