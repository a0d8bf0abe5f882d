"""Studies of speed, accuracy, stability and design: each measures, writes a table, and draws plots from the table.

A study is a folder with modules that measure and draw, a results page `README.md`, and a folder `figures`. The study's
command is in `solar_env.commands`. `common` holds shared parts, `peers` runs other programs for comparison, and
`precision` lists integration methods. A study may import only these three; `design` also imports `loads`.
"""
