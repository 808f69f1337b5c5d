# Install and export: find_package(softfinger) gives softfinger::rendering and each module. Components are Debian's
# packages (Package.cmake): program, library, development, python.
include(CMakePackageConfigHelpers)

get_property(softfinger_targets GLOBAL PROPERTY SOFTFINGER_TARGETS)
list(APPEND softfinger_targets softfinger_c)
install(TARGETS ${softfinger_targets} EXPORT softfingerTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library NAMELINK_COMPONENT development)
# What `cmake --install` takes from the build: without it, installing fails half way.
add_custom_target(to_install DEPENDS ${softfinger_targets})
foreach(program softfinger softfinger-guard softfinger_mpi softfinger_pagmo)
  if(TARGET ${program})
    add_dependencies(to_install ${program})
  endif()
endforeach()
install(DIRECTORY src/softfinger DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development
  FILES_MATCHING PATTERN "*.hpp" PATTERN "node_modules" EXCLUDE PATTERN "page" EXCLUDE PATTERN "server" EXCLUDE PATTERN "hdf5" EXCLUDE PATTERN "config" EXCLUDE PATTERN "report" EXCLUDE PATTERN "pagmo" EXCLUDE)

install(FILES src/softfinger/softfinger.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/softfinger COMPONENT development)
file(RELATIVE_PATH softfinger_prefix_from_pc /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
string(REGEX REPLACE "/$" "" softfinger_prefix_from_pc "${softfinger_prefix_from_pc}")
configure_file(${CMAKE_CURRENT_LIST_DIR}/softfinger.pc.in ${PROJECT_BINARY_DIR}/softfinger.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/softfinger.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)

set(softfinger_cmake_dir ${CMAKE_INSTALL_LIBDIR}/cmake/softfinger)
install(EXPORT softfingerTargets NAMESPACE softfinger:: DESTINATION ${softfinger_cmake_dir} COMPONENT development)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/softfingerConfig.cmake.in
  ${PROJECT_BINARY_DIR}/softfingerConfig.cmake INSTALL_DESTINATION ${softfinger_cmake_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/softfingerConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/softfingerConfig.cmake
  ${PROJECT_BINARY_DIR}/softfingerConfigVersion.cmake DESTINATION ${softfinger_cmake_dir} COMPONENT development)

# What a newcomer runs: fingers, devices, scenes and objects as files. The build tree shows them in the same place, so
# that what it builds finds them by name as an installed program does.
file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/share/softfinger)
foreach(folder fingers devices scenes objects studies)
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/${folder} ${PROJECT_BINARY_DIR}/share/softfinger/${folder} SYMBOLIC)
endforeach()
install(DIRECTORY fingers devices scenes objects studies DESTINATION ${CMAKE_INSTALL_DATADIR}/softfinger COMPONENT program
  FILES_MATCHING PATTERN "*.toml" PATTERN "*.msh" PATTERN "*.ply" PATTERN "*.obj" PATTERN "*.stl")

if(TARGET softfinger)
  include(Package)
endif()
