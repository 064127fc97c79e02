# Libraries that roughmesh stands on. All are permissive or weak copyleft; none is under the GPL.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(TBB REQUIRED)
find_package(fmt REQUIRED)
find_package(hwy REQUIRED CONFIG)
find_package(nlohmann_json REQUIRED)
find_path(TOMLPLUSPLUS_INCLUDE_DIR toml++/toml.h REQUIRED)
find_path(RANDOM123_INCLUDE_DIR Random123/philox.h REQUIRED)
find_path(CGAL_INCLUDE_DIR CGAL/version.h REQUIRED)
find_path(BOOST_INCLUDE_DIR boost/version.hpp REQUIRED)
find_path(XXHASH_INCLUDE_DIR xxhash.h REQUIRED)
find_path(LBFGSPP_INCLUDE_DIR LBFGS.h REQUIRED)
find_path(LAPACKE_INCLUDE_DIR lapacke.h REQUIRED)
find_library(LAPACKE_LIBRARY lapacke REQUIRED)
find_library(OPENBLAS_LIBRARY openblas REQUIRED)
find_path(MUPARSER_INCLUDE_DIR muParser.h REQUIRED)
find_library(MUPARSER_LIBRARY muparser REQUIRED)
find_path(OPENBLAS_INCLUDE_DIR cblas.h PATH_SUFFIXES openblas REQUIRED)

# Seen by the project's own sources only; the public headers need Eigen and nothing else.
add_library(roughmesh_private_dependencies INTERFACE)
target_include_directories(roughmesh_private_dependencies SYSTEM INTERFACE
  ${RANDOM123_INCLUDE_DIR} ${XXHASH_INCLUDE_DIR} ${TOMLPLUSPLUS_INCLUDE_DIR} ${LAPACKE_INCLUDE_DIR} ${OPENBLAS_INCLUDE_DIR} ${MUPARSER_INCLUDE_DIR}
  ${LBFGSPP_INCLUDE_DIR} ${CGAL_INCLUDE_DIR} ${BOOST_INCLUDE_DIR})
target_link_libraries(roughmesh_private_dependencies INTERFACE
  TBB::tbb fmt::fmt hwy::hwy nlohmann_json::nlohmann_json ${LAPACKE_LIBRARY} ${OPENBLAS_LIBRARY} ${MUPARSER_LIBRARY})

# What a program that uses the installed static library has to link; cmake/roughmesh-config.cmake.in
# finds them where that program is built.
set(roughmesh_installed_dependencies TBB::tbb fmt::fmt hwy::hwy roughmesh::lapacke roughmesh::openblas roughmesh::muparser)
