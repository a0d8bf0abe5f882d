"""Time integration: one file a method, one driver for all.

``settings.py`` has what a user chooses, in plain Python; ``methods.py`` the table with every method's kernels;
``driver.py`` the loop of a run and of lanes; ``adaptive.py`` the steps that land on events, with ``acceptance.py`` and
``events.py``;
``step.py`` the arrays of a step; ``history.py`` and ``recording.py`` what a mechanism and a run remember. May import
the equations and what lies below them.

To add a method, write its module, with a subclass of ``step.AdaptiveSettings``, a function that makes its arrays and
the kernels that ``methods.AdaptiveKernels`` lists; its settings are a class of ``settings.py``, and its row in
``methods.METHODS`` says which order it has. Command line, warm-up, batches and the tests of every method follow.
"""
