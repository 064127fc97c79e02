// Sphere of radius 1 in a box, for bench_untangle: gmsh sphere_in_box.geo -setnumber s 0.0445 -setnumber c 0.125
// -3 -o sphere.msh. Mesh size s on the sphere, c at the corners of the box.
SetFactory("OpenCASCADE");
DefineConstant[ s = {0.14, Name "s"}, c = {0.34, Name "c"} ];
Box(1) = {-2, -2, -2, 4, 4, 4};
Sphere(2) = {0, 0, 0, 1};
BooleanFragments{ Volume{1}; Delete; }{ Volume{2}; Delete; }
MeshSize{ PointsOf{ Volume{:}; } } = c;
MeshSize{ PointsOf{ Volume{2}; } } = s;
Physical Volume("inside") = {2};
Physical Volume("outside") = {3};
sphere() = Boundary{ Volume{2}; };
Physical Surface("surface") = {sphere()};
