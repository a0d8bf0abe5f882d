"""Reproduction of the paper, figure by figure and claim by claim: `solar-env study paper`.

The paper: Y. Li, C. Wang and W. Huang, "Dynamics analysis of planar rigid-flexible coupling deployable solar array
system with multiple revolute clearance joints", Mech. Syst. Signal Process. 117 (2019) 188-209. `cases` simulates the
paper's runs. `figures` lists the paper's figures by number; `kinds` defines their tables and pictures. `claims` turns
the paper's statements into measured quantities, and `survey` judges the claims. `sets` has other values of parameters
that the paper leaves open. Imports `common`. To add a claim, add a row to `CLAIMS`.
"""
