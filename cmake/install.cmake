# The installed package: `find_package(roughmesh)` gives the target roughmesh::roughmesh.
include(CMakePackageConfigHelpers)

install(TARGETS roughmesh EXPORT roughmesh_targets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
if(ROUGHMESH_BUILD_APP)
  install(TARGETS roughmesh_app RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
install(DIRECTORY include/roughmesh DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})

set(roughmesh_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/roughmesh)
install(EXPORT roughmesh_targets NAMESPACE roughmesh:: DESTINATION ${roughmesh_package_dir})
configure_package_config_file(cmake/roughmesh-config.cmake.in
  ${PROJECT_BINARY_DIR}/roughmesh-config.cmake INSTALL_DESTINATION ${roughmesh_package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/roughmesh-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/roughmesh-config.cmake
  ${PROJECT_BINARY_DIR}/roughmesh-config-version.cmake DESTINATION ${roughmesh_package_dir})
