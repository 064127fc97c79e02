// A conducting sphere of radius 1 in an earthed box; only the space between them is meshed.
SetFactory("OpenCASCADE");
DefineConstant[ s = {0.16, Name "s"}, c = {0.8, Name "c"}, order = {1, Name "order"} ];
Box(1) = {-2.5, -2.5, -2.5, 5, 5, 5};
Sphere(2) = {0, 0, 0, 1};
BooleanDifference{ Volume{1}; Delete; }{ Volume{2}; Delete; }
sides() = Boundary{ Volume{1}; };
sphere() = Surface In BoundingBox{-1.1, -1.1, -1.1, 1.1, 1.1, 1.1};
sides() -= sphere();
MeshSize{ PointsOf{ Surface{sides()}; } } = c;
MeshSize{ PointsOf{ Surface{sphere()}; } } = s;
Mesh.ElementOrder = order;
Physical Volume("air") = {1};
Physical Surface("conductor") = {sphere()};
Physical Surface("earth") = {sides()};
