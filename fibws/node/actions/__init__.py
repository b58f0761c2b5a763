"""Actions: goals that take time, give feedback, and can be canceled.

    Actions ─┬─ ActionServer ── ServerGoal ── Record
             └─ ActionClient ── ClientGoal

Both have a subclass for goals over topics (`topics`) and one for goals over operations
(`operations`). The base classes (`server`, `client`) decide what happens to a goal; the subclasses
only translate it from and to messages or operations. `status` has the states of goals.

This package imports none of its modules: programs that need only `status` load fast.
"""
