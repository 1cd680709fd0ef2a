# c
Vertex 7 0 0 0
Vertex 3 1 0 0
Tet 0 7 3 9 -2
Vertex 9 0 1 0
Vertex -2 0 0 1e-3
