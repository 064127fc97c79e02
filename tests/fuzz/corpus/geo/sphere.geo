// A sphere of radius 1, its surface only.
SetFactory("OpenCASCADE");
Sphere(1) = {0, 0, 0, 1};
MeshSize {:} = 0.08;
Physical Surface("sphere") = {1};
