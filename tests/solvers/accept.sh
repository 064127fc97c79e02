#!/usr/bin/env bash
# Fifty rough spheres in a box, read and solved by a finite element solver.
# usage: accept.sh SOLVER ORDER MESH_ORDER path/to/roughmesh; exit code 77: solver, gmsh or meshio is not installed
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
solver=$1
order=$2
mesh_order=$3
roughmesh=$(realpath "$4")
python=$here/../../build/solvers/bin/python
[ -x "$python" ] && [ "$solver" != dolfinx ] || python=/usr/bin/python3
command -v gmsh >/dev/null && [ -x "$python" ] || exit 77
"$python" -c "import $solver, meshio, numpy" 2>/dev/null || exit 77

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
# ngsolve reads MSH 2.2 only.
gmsh -3 -v 1 -setnumber order "$mesh_order" -format "$([ "$solver" = ngsolve ] && echo msh22 || echo msh41)" \
  "$here/sphere_in_box.geo" -o smooth.msh
"$roughmesh" roughen smooth.msh -o 'rough_{realization:02}.msh' --group conductor \
  --rms 0.05 --length 0.6 --realizations 50 --report report.json --quiet
"$python" "$here/capacitance.py" "$solver" "$order" smooth.msh report.json | tail -1
