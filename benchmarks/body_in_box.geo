// A body with edges in a box, for real_parts.py: gmsh body_in_box.geo -setnumber body 2 -3 -o body.msh. Body 1 is a cube,
// 2 a cylinder, 3 an L-shaped block, 4 a wedge of 30 degrees. Mesh size s on it, c at the corners of the box.
SetFactory("OpenCASCADE");
DefineConstant[ body = {1, Name "body"}, s = {0.14, Name "s"}, c = {0.4, Name "c"} ];
Box(1) = {-2, -2, -2, 4, 4, 4};
If (body == 1)
  Box(2) = {-0.7, -0.7, -0.7, 1.4, 1.4, 1.4};
ElseIf (body == 2)
  Cylinder(2) = {0, 0, -0.7, 0, 0, 1.4, 0.7};
ElseIf (body == 3)
  Box(3) = {-0.8, -0.8, -0.7, 1.6, 0.8, 1.4};
  Box(4) = {-0.8, -0.8, -0.7, 0.8, 1.6, 1.4};
  BooleanUnion(2) = { Volume{3}; Delete; }{ Volume{4}; Delete; };
Else
  Wedge(2) = {-1, -0.3, -0.7, 2, 2 * Tan(Pi / 6), 1.4, 0};
EndIf
BooleanFragments{ Volume{1}; Delete; }{ Volume{2}; Delete; }
MeshSize{ PointsOf{ Volume{:}; } } = c;
MeshSize{ PointsOf{ Volume{2}; } } = s;
Physical Volume("inside") = {2};
Physical Volume("outside") = {3};
surface() = Boundary{ Volume{2}; };
Physical Surface("surface") = {surface()};
