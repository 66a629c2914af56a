# What find_package(Isochor) finds in an installed tree.
include(CMakePackageConfigHelpers)

set(ISOCHOR_PACKAGE_DIR "${CMAKE_INSTALL_LIBDIR}/cmake/Isochor")
set(ISOCHOR_PACKAGE_BINARY_DIR "${PROJECT_BINARY_DIR}/cmake")

install(EXPORT isochor-targets NAMESPACE isochor:: FILE IsochorTargets.cmake
        DESTINATION "${ISOCHOR_PACKAGE_DIR}")
configure_package_config_file(
  "${PROJECT_SOURCE_DIR}/cmake/IsochorConfig.cmake.in"
  "${ISOCHOR_PACKAGE_BINARY_DIR}/IsochorConfig.cmake"
  INSTALL_DESTINATION "${ISOCHOR_PACKAGE_DIR}")
# Before 1.0 a minor version may change names.
write_basic_package_version_file("${ISOCHOR_PACKAGE_BINARY_DIR}/IsochorConfigVersion.cmake"
  COMPATIBILITY SameMinorVersion)
install(FILES
  "${ISOCHOR_PACKAGE_BINARY_DIR}/IsochorConfig.cmake"
  "${ISOCHOR_PACKAGE_BINARY_DIR}/IsochorConfigVersion.cmake"
  "${PROJECT_SOURCE_DIR}/cmake/FindFLINT.cmake"
  "${PROJECT_SOURCE_DIR}/cmake/IsochorOpenCascade.cmake"
  DESTINATION "${ISOCHOR_PACKAGE_DIR}")
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION "${CMAKE_INSTALL_DOCDIR}")
