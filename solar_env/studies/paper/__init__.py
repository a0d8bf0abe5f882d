"""The paper, figure by figure and claim by claim: `solar-env study paper`.

Y. Li, C. Wang and W. Huang, "Dynamics analysis of planar rigid-flexible coupling deployable solar array system with
multiple revolute clearance joints", Mech. Syst. Signal Process. 117 (2019) 188-209 (below: the paper). `cases`
simulates the paper's runs, `figures` has its figures by number, each of one of the `kinds`. `claims` turns statements
into measured figures, and `survey` judges them. `sets` has other values of the parameters that the paper leaves open.
Imports `common`. A further claim is a row of `CLAIMS`.
"""
