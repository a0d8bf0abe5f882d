"""The paper, figure by figure and claim by claim: `solar-env study paper`.

Y. Li, C. Wang and W. Huang, "Dynamics analysis of planar rigid-flexible coupling deployable solar array system with
multiple revolute clearance joints", Mech. Syst. Signal Process. 117 (2019) 188-209 (below: the paper). `cases`
simulates what it shows, `figures` has its figures by number, each of one of the `kinds`, `claims` turns its statements
into measured figures, `survey` judges them, and `sets` has other readings of what the paper leaves open. Imports
`common`. A further claim is a row of `CLAIMS`.
"""
