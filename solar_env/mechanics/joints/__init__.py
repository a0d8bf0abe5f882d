"""What acts in a joint: contact and friction in the bearing, wear, springs, stops and latches.

Imports `arrays` and `numerics`, and no body. A contact law or a friction law is one file and one row of its table;
the tests over the tables compare its slopes with differences and its impacts with its own figures.
"""
