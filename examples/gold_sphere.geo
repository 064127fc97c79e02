// A gold sphere of radius 50 nm in a box of air. Unit: nm.
SetFactory("OpenCASCADE");
Box(1) = {-150, -150, -150, 300, 300, 300};
Sphere(2) = {0, 0, 0, 50};
// Cuts the box along the sphere: volume 2 is the sphere, volume 3 what is left of the box.
BooleanFragments{ Volume{1}; Delete; }{ Volume{2}; Delete; }

gold[] = {2};
air[] = {3};
surface[] = Abs(Boundary{ Volume{2}; });
outer[] = Abs(Boundary{ Volume{3}; });
outer[] -= surface[];
Physical Volume("gold") = gold[];
Physical Volume("air") = air[];
Physical Surface("surface") = surface[];
Physical Surface("outer") = outer[];

// 4 nm on the sphere (correlation length 10 nm over 2.5), growing to 40 nm at the box.
Field[1] = Distance;
Field[1].SurfacesList = {surface[]};
Field[1].Sampling = 200;
Field[2] = Threshold;
Field[2].InField = 1;
Field[2].SizeMin = 4;
Field[2].SizeMax = 40;
Field[2].DistMin = 4;
Field[2].DistMax = 100;
Background Field = 2;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.MeshSizeFromCurvature = 0;
Mesh.Algorithm3D = 10;
