# SPDX-License-Identifier: BSD-3-Clause
"""A solver reads rough meshes with their groups, and gets the capacitance that theory foresees.

A conductor at potential 1, a sphere with rough surface, stands in an earthed box. By second-order perturbation
(docs/math.md, eq. 67) roughness changes its mean capacitance; the mean of all realizations must agree, within 4
standard errors.

usage: capacitance.py SOLVER ORDER SMOOTH.msh REPORT.json, meshes of order 1 or 2
       SOLVER is skfem, ngsolve or dolfinx; exit code 77: it is not installed
"""
import json
import math
import sys

import numpy as np
from numpy.polynomial import legendre


def places_of_groups(file):
    """Of each group of faces, the places of its nodes, as meshio reads them."""
    shape = "triangle6" if "triangle6" in file.cells_dict else "triangle"
    tags = file.cell_data_dict["gmsh:physical"][shape]
    return {name: set(map(tuple, file.points[np.unique(file.cells_dict[shape][tags == tag])]))
            for name, (tag, dimension) in file.field_data.items() if dimension == 2}


def skfem_capacitance(order):
    import meshio
    import skfem
    from skfem.helpers import dot, grad
    element = {1: skfem.ElementTetP1, 2: skfem.ElementTetP2}[order]()

    @skfem.BilinearForm
    def energy(u, v, _):
        return dot(grad(u), grad(v))

    def read(path):
        mesh = skfem.Mesh.load(path)
        if mesh.boundaries:
            return mesh
        # It takes groups of straight faces only.
        facets = mesh.boundary_facets()
        corners = mesh.p.T[mesh.facets[:, facets]]  # three by facets by coordinates
        boundaries = {}
        for name, places in places_of_groups(meshio.read(path)).items():
            is_in = np.array([[tuple(x) in places for x in corner] for corner in corners]).all(0)
            boundaries[name] = facets[is_in]
        return mesh.with_boundaries(boundaries)

    def solve(path):
        mesh = read(path)
        basis = skfem.Basis(mesh, element)
        conductor = basis.get_dofs("conductor").all()
        fixed = np.union1d(conductor, basis.get_dofs("earth").all())
        potential = basis.zeros()
        potential[conductor] = 1
        stiffness = energy.assemble(basis)
        system = skfem.condense(stiffness, x=potential, D=fixed)
        potential = skfem.solve(*system, solver=skfem.solver_iter_pcg(rtol=1e-10))
        return potential @ (stiffness @ potential)

    return solve


def ngsolve_capacitance(order):
    import ngsolve
    from netgen.read_gmsh import ReadGmsh
    ngsolve.ngsglobals.msg_level = 0

    def solve(path):
        mesh = ngsolve.Mesh(ReadGmsh(str(path)))
        space = ngsolve.H1(mesh, order=order, dirichlet="conductor|earth")
        u, v = space.TnT()
        energy = ngsolve.BilinearForm(ngsolve.grad(u) * ngsolve.grad(v) * ngsolve.dx).Assemble()
        potential = ngsolve.GridFunction(space)
        potential.Set(1, definedon=mesh.Boundaries("conductor"))
        residual = (-energy.mat * potential.vec).Evaluate()
        potential.vec.data += energy.mat.Inverse(space.FreeDofs(), "sparsecholesky") * residual
        return ngsolve.Integrate(ngsolve.grad(potential) * ngsolve.grad(potential), mesh)

    return solve


def dolfinx_capacitance(order):
    import dolfinx
    import meshio
    import ufl
    from dolfinx import fem
    from dolfinx.fem.petsc import LinearProblem
    from mpi4py import MPI

    def read(path):
        """The mesh, and the facets of each group of faces."""
        file = meshio.read(path)
        is_curved = "tetra10" in file.cells_dict
        domain = ufl.Mesh(ufl.VectorElement("Lagrange", ufl.tetrahedron, 2 if is_curved else 1))
        cells = file.cells_dict["tetra10" if is_curved else "tetra"].astype(np.int64)
        # meshio orders nodes as VTK does.
        cells = cells[:, dolfinx.cpp.io.perm_vtk(dolfinx.mesh.CellType.tetrahedron, cells.shape[1])]
        mesh = dolfinx.mesh.create_mesh(MPI.COMM_SELF, cells, file.points, domain)
        facets = {
            name: dolfinx.mesh.locate_entities_boundary(
                mesh, 2, lambda x, places=places: np.array([tuple(p) in places for p in x.T]))
            for name, places in places_of_groups(file).items()}
        return mesh, facets

    def solve(path):
        mesh, facets = read(path)
        space = fem.FunctionSpace(mesh, ("Lagrange", order))

        def held(group, value):
            dofs = fem.locate_dofs_topological(space, 2, facets[group])
            return fem.dirichletbc(value, dofs, space)

        u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
        potential = LinearProblem(
            ufl.inner(ufl.grad(u), ufl.grad(v)) * ufl.dx, fem.Constant(mesh, 0.0) * v * ufl.dx,
            bcs=[held("conductor", 1.0), held("earth", 0.0)],
            petsc_options={"ksp_type": "cg", "pc_type": "jacobi", "ksp_rtol": 1e-10}).solve()
        return fem.assemble_scalar(fem.form(
            ufl.inner(ufl.grad(potential), ufl.grad(potential)) * ufl.dx))

    return solve


solvers = {"skfem": skfem_capacitance, "ngsolve": ngsolve_capacitance,
           "dolfinx": dolfinx_capacitance}


def power_of_degrees(rho, most):
    """Legendre coefficients P_l of rho(chord): the covariance is sum (2l + 1) / (4 pi) P_l P_l(cos)."""
    x, w = legendre.leggauss(4 * most)
    values = rho(np.sqrt(2 - 2 * x)) * w
    return np.array([2 * math.pi * np.sum(values * legendre.Legendre.basis(l)(x)) for l in range(most)])


def second_order_change(smooth, rms, length):
    """Of the mean capacitance, where the box is a sphere of equal capacitance."""
    alpha = smooth / (4 * math.pi)
    b = 1 / (1 - 1 / alpha)
    powers = rms**2 * power_of_degrees(lambda r: np.exp(-r * r / (2 * length * length)), 60)
    degrees = np.arange(len(powers))
    ratio = b ** -(2.0 * degrees + 1)
    growth = ((degrees + 1) + degrees * ratio) / (1 - ratio)
    return 4 * math.pi * alpha**2 * np.sum((2 * degrees + 1) / (4 * math.pi) * powers * (growth - 1))


def main(solver, order, smooth_path, report_path):
    try:
        solve = solvers[solver](int(order))
    except ImportError as error:
        print(f"not installed: {error}")
        return 77
    report = json.load(open(report_path))
    rms, length = report["request"]["rms"], report["request"]["length"][0]
    smooth = solve(smooth_path)
    alpha = smooth / (4 * math.pi)
    changes, controlled = [], []
    for realization in report["realizations"]:
        change = solve(realization["path"]) - smooth
        # The mean height grows the sphere; its effect of first order is known, and has mean 0.
        first_order = 4 * math.pi * alpha**2 * realization["mean"]
        changes.append(change)
        controlled.append(change - first_order)
    mean = np.mean(controlled)
    error = np.std(controlled, ddof=1) / math.sqrt(len(controlled))
    expected = second_order_change(smooth, rms, length)
    print(f"{solver}, order {order}: capacitance {smooth:.4f}, changed by {np.mean(changes):.4f}; "
          f"without mean heights by {mean:.4f} +- {error:.4f}; expected: {expected:.4f}")
    return 0 if abs(mean - expected) <= 4 * error else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
