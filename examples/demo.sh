#!/usr/bin/env bash
# A rough gold sphere in a box of air, three realizations, from a geometry script to checked meshes.
# usage: examples/demo.sh path/to/roughmesh OUTPUT_FOLDER
set -euo pipefail
roughmesh=$1
folder=$2
mkdir -p "$folder"

echo "1. mesh the smooth geometry with gmsh: examples/gold_sphere.geo"
gmsh -3 -format msh41 -v 1 examples/gold_sphere.geo -o "$folder/gold_sphere.msh"

echo "2. what it can carry"
"$roughmesh" info "$folder/gold_sphere.msh" --group surface --rms 2 --length 10 --unit nm

echo
echo "3. roughen it: rms 2 nm, correlation length 10 nm"
"$roughmesh" roughen "$folder/gold_sphere.msh" -o "$folder/rough_{realization}.msh" \
  --group surface --rms 2 --length 10 --realizations 3 --unit nm --report "$folder/rough.report.json"
"$roughmesh" roughen "$folder/gold_sphere.msh" -o "$folder/rough_0.vtu" \
  --group surface --rms 2 --length 10 --unit nm --quiet

echo
echo "4. check: gmsh reads each mesh and finds its groups"
for k in 0 1 2; do
  gmsh -check -v 2 "$folder/rough_$k.msh"
  for group in gold air surface outer; do
    grep -q "\"$group\"" "$folder/rough_$k.msh" || { echo "rough_$k.msh: group $group lost" >&2; exit 1; }
  done
done

echo
echo "made:"
for file in gold_sphere.msh rough_0.msh rough_1.msh rough_2.msh rough_0.vtu rough_0.report.json rough.report.json; do
  echo "  $folder/$file"
done
