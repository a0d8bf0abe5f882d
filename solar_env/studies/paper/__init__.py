"""The paper, figure by figure and claim by claim: ``python -m solar_env paper``.

Y. Li, C. Wang and W. Huang, "Dynamics analysis of planar rigid-flexible coupling deployable solar array system with
multiple revolute clearance joints", Mech. Syst. Signal Process. 117 (2019) 188-209 (below: the paper). ``cases.py``
simulates what it shows, ``figures.py`` turns that into one table a figure, ``drawings.py`` draws the tables, and
``claims.py`` turns its statements into measured figures.
"""
