// Two blocks, one on the other, with nodes of their own where they touch; all hexahedra.
//   gmsh two_blocks.geo -3 -format msh41 -o two_blocks_41.msh
//   gmsh two_blocks.geo -3 -format msh41 -bin -o two_blocks_41b.msh
//   gmsh two_blocks.geo -3 -format msh22 -o two_blocks_22.msh
//   gmsh two_blocks.geo -3 -format msh22 -bin -o two_blocks_22b.msh
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 200, 100, 50};
Box(2) = {20, 0, 50, 160, 100, 80};
Mesh.TransfiniteTri = 0;
Transfinite Curve {1:24} = 3;
Transfinite Surface {1:12};
Recombine Surface {1:12};
Transfinite Volume {1:2};
Physical Volume("lower", 7) = {1};
Physical Volume("upper") = {2};
Physical Surface("base") = {5};
Physical Surface("bed of lower") = {6};
Physical Surface("bed of upper") = {11};
Physical Surface(40) = {12};
Physical Curve("edge") = {1};
Physical Point("corner") = {1};
