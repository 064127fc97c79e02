#!/usr/bin/env bash
# Runs README's C++ program and its `roughen` line on a small particle: both make the same ten meshes.
# usage: readme_example.sh PROGRAM README.md ROUGHMESH; exit code 77: gmsh is missing
set -euo pipefail
program=$1 readme=$2 roughmesh=$3
command -v gmsh >/dev/null || exit 77
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

cat > particle.geo <<'GEO'
SetFactory("OpenCASCADE");
Sphere(1) = {0, 0, 0, 50};
Physical Volume("gold") = {1};
Physical Surface("surface") = Boundary{ Volume{1}; };
Mesh.MeshSizeMin = 12;
Mesh.MeshSizeMax = 12;
GEO
gmsh -3 -format msh41 -v 1 particle.geo -o particle.msh

"$program"
mkdir from_library && mv rough_*.msh from_library
line=$(grep -E '^ +roughmesh roughen ' "$readme" | head -n 1)
eval "${line/roughmesh/\"\$roughmesh\"}"
for k in 0 1 2 3 4 5 6 7 8 9; do
  cmp "rough_$k.msh" "from_library/rough_$k.msh"
done
test -s rough_.report.json
