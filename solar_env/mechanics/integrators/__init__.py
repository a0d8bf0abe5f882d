"""Methods of integration, and what they share: step control, events, history, recording.

Imports `equations` and the rooms below. A method is one file and one row of its table: settings, arrays and one step.
The driver around it controls steps, lands on events and records, and knows no method by name.
"""
