#!/usr/bin/env bash
# The rough surfaces of Loth, Kiel, Busch, Kristensen, "Surface roughness in finite element meshes" (2020):
# the sphere of figure 1, the line of figure 2, the four spheres of figure 3, as meshes and tables.
# usage: examples/paper.sh path/to/roughmesh OUTPUT_FOLDER
set -euo pipefail
roughmesh=$1
folder=$2
realizations=3
tables=$(dirname "$0")/paper_tables.py
mkdir -p "$folder"

# usage: sphere_script SIZE; a unit sphere whose edges have this length
sphere_script() {
  cat <<GEO
SetFactory("OpenCASCADE");
Sphere(1) = {0, 0, 0, 1};
Physical Surface("sphere") = {1};
Mesh.MeshSizeMin = $1;
Mesh.MeshSizeMax = $1;
GEO
}

# usage: roughen INPUT NAME RMS LENGTH; by the paper's method, the same heights as .msh, which solvers read, and .vtu
roughen() {
  local extension
  for extension in msh vtu; do
    "$roughmesh" roughen "$1" -o "$folder/$2_{realization}.$extension" --rms "$3" --length "$4" \
      --method cholesky --realizations "$realizations" --report "$folder/$2.report.json" --quiet
  done
}

# usage: sphere NAME RMS LENGTH SIZE, each over the radius
sphere() {
  echo "sphere $1: Rq/r = $2, l/r = $3, h/r = $4"
  sphere_script "$4" >"$folder/$1.geo"
  roughen "$folder/$1.geo" "$1" "$2" "$3"
  python3 "$tables" heights "$folder/$1" sphere
}

# The paper gives n = 100 and l/c = 0.03 and leaves open whether the line closes and where its ends are: here it
# is open, with nodes from 0 to c = 1 at equal distances. Its amplitude is normalized, here to Rq/c = 0.01.
line() {
  echo "line: n = 100, l/c = 0.03"
  python3 "$tables" line 100 "$folder/line.msh"
  roughen "$folder/line.msh" line 0.01 0.03
  python3 "$tables" heights "$folder/line" line
}

sphere figure1 0.05 0.15 0.05
line
sphere figure3_fine_low 0.04 0.1 0.04
sphere figure3_fine_high 0.08 0.1 0.04
sphere figure3_coarse_low 0.04 0.2 0.08
sphere figure3_coarse_high 0.08 0.2 0.08
echo
python3 "$tables" summary "$folder" figure1 line figure3_fine_low figure3_fine_high figure3_coarse_low \
  figure3_coarse_high
