# What a system wants besides the program: manual pages, completion, rules for boards; and the Debian packages that
# `./dev package` makes of it all (CPack).
set(packages ${PROJECT_SOURCE_DIR}/packages)
set(data ${CMAKE_INSTALL_DATADIR})
find_program(SOFTFINGER_GZIP gzip REQUIRED)

# softfinger_compressed(OUTPUT DEPENDS d... COMMAND c...): what the command prints, as Debian's policy wants it: the
# same bytes whenever and wherever it is made.
function(softfinger_compressed output)
  cmake_parse_arguments(arg "" "" "DEPENDS;COMMAND" ${ARGN})
  list(JOIN arg_COMMAND "' '" command)
  add_custom_command(OUTPUT ${output}
    COMMAND sh -c "'${command}' > '${output}.plain' && '${SOFTFINGER_GZIP}' -9nc '${output}.plain' > '${output}'"
    DEPENDS ${arg_DEPENDS} VERBATIM)
endfunction()

install(FILES ${packages}/60-softfinger.rules DESTINATION lib/udev/rules.d COMPONENT program)
install(FILES ${packages}/softfinger.desktop DESTINATION ${data}/applications COMPONENT program)
install(FILES ${packages}/completion/softfinger.bash DESTINATION ${data}/bash-completion/completions RENAME softfinger
  COMPONENT program)
install(FILES ${packages}/completion/_softfinger DESTINATION ${data}/zsh/vendor-completions COMPONENT program)
install(FILES ${packages}/completion/softfinger.fish DESTINATION ${data}/fish/vendor_completions.d COMPONENT program)

set(pages ${PROJECT_BINARY_DIR}/packages-in)
file(MAKE_DIRECTORY ${pages})
softfinger_compressed(${pages}/softfinger-guard.1.gz DEPENDS ${packages}/softfinger-guard.1
  COMMAND cat ${packages}/softfinger-guard.1)
set(manuals ${pages}/softfinger-guard.1.gz)
if(NOT CMAKE_CROSSCOMPILING)
  # The program writes its own.
  softfinger_compressed(${pages}/softfinger.1.gz DEPENDS softfinger COMMAND $<TARGET_FILE:softfinger> manual)
  list(APPEND manuals ${pages}/softfinger.1.gz)
endif()
install(FILES ${manuals} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "softfinger maintainers <maintainers@softfinger.example>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_STRIP_FILES ON)
# What CPack takes for none; else it would stand before each package's own synopsis.
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_NAME} built using CMake")
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER ${CPACK_PACKAGE_CONTACT})
set(CPACK_DEBIAN_PACKAGE_SOURCE softfinger)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS ON)
configure_file(${packages}/changelog.in ${pages}/changelog @ONLY)
softfinger_compressed(${pages}/changelog.Debian.gz DEPENDS ${pages}/changelog COMMAND cat ${pages}/changelog)
softfinger_compressed(${pages}/changelog.gz DEPENDS ${PROJECT_SOURCE_DIR}/CHANGELOG.md
  COMMAND cat ${PROJECT_SOURCE_DIR}/CHANGELOG.md)
set(changelogs ${pages}/changelog.Debian.gz ${pages}/changelog.gz)
# The live page is in the program, and what it is made of has licences of its own.
set(page ${PROJECT_BINARY_DIR}/src/softfinger/viewer/page)
set(licences "")
if(SOFTFINGER_LIVE_PAGE)
  set(licences ${page}/node_modules/three/LICENSE ${page}/node_modules/uplot/LICENSE
    ${page}/node_modules/@fontsource-variable/inter/LICENSE
    ${page}/node_modules/@webxr-input-profiles/assets/LICENSE.md)
endif()
add_custom_command(OUTPUT ${pages}/copyright
  COMMAND ${CMAKE_COMMAND} "-DLICENCES=${licences}" -DBEGIN=${packages}/copyright -DOUTPUT=${pages}/copyright
    -P ${PROJECT_SOURCE_DIR}/cmake/write_copyright.cmake
  DEPENDS ${packages}/copyright ${PROJECT_SOURCE_DIR}/cmake/write_copyright.cmake softfinger VERBATIM)
add_custom_target(documents ALL DEPENDS ${manuals} ${changelogs} ${pages}/copyright)
add_dependencies(to_install documents)

# softfinger_package(COMPONENT NAME SECTION SYNOPSIS TEXT)
macro(softfinger_package component name section synopsis text)
  string(TOUPPER ${component} key)
  list(APPEND CPACK_COMPONENTS_ALL ${component})
  set(CPACK_DEBIAN_${key}_PACKAGE_NAME ${name})
  set(CPACK_DEBIAN_${key}_PACKAGE_SECTION ${section})
  set(CPACK_DEBIAN_${key}_DESCRIPTION "${synopsis}\n${about}\n${text}")
  install(FILES ${pages}/copyright ${changelogs} DESTINATION ${data}/doc/${name} COMPONENT ${component}
    EXCLUDE_FROM_ALL)
endmacro()

set(about "A soft finger pad touches virtual objects, and a small device under the
real finger answers with the same contact.")
softfinger_package(program softfinger science "tactile rendering for wearable fingertip haptics"
  "The program, the guard that owns the ports of devices, scenes, devices,
fingers and the live page.")
softfinger_package(library libsoftfinger0 libs "tactile rendering for wearable fingertip haptics (library)"
  "The shared library with its C interface. Devices need the guard, and names of
shipped files the files, of the package softfinger.")
softfinger_package(development libsoftfinger-dev libdevel "tactile rendering for wearable fingertip haptics (development)"
  "Headers for C and C++, static libraries, CMake and pkg-config files.")
softfinger_package(python python3-softfinger python "tactile rendering for wearable fingertip haptics (Python 3)"
  "The package softfinger for Python: poses and results as numpy arrays.")

if(TARGET softfinger_mpi)
  softfinger_package(mpi softfinger-mpi science "tactile rendering for wearable fingertip haptics (studies by MPI)"
    "What the program loads under mpirun, so that a study runs on many processors
and machines.")
  set(CPACK_COMPONENT_MPI_DEPENDS program)
  set(CPACK_DEBIAN_MPI_PACKAGE_RECOMMENDS openmpi-bin)
endif()

# Programs to begin with, where Debian has such.
foreach(example c_program own_program)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples/${example} DESTINATION ${data}/doc/libsoftfinger-dev/examples
    COMPONENT development EXCLUDE_FROM_ALL)
endforeach()
foreach(example python_program notebooks)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples/${example} DESTINATION ${data}/doc/python3-softfinger/examples
    COMPONENT python EXCLUDE_FROM_ALL PATTERN "__pycache__" EXCLUDE)
endforeach()

# The library starts a guard for each device, and takes shipped files by name.
set(CPACK_DEBIAN_LIBRARY_PACKAGE_RECOMMENDS softfinger)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA ${packages}/libsoftfinger0/triggers)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY ">=")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "libsoftfinger-dev, python3-softfinger")
set(CPACK_COMPONENT_DEVELOPMENT_DEPENDS library)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SHLIBDEPS OFF)
# As softfingerConfig.cmake finds them.
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libassimp-dev, libeigen3-dev, libfmt-dev, libsqlite3-dev, libssl-dev, libtomlplusplus-dev, libxxhash-dev, pkg-config, zlib1g-dev")
# softfinger::export and softfinger::study alone.
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS "libhdf5-dev, libmuparser-dev")
set(CPACK_COMPONENT_PYTHON_DEPENDS library)
set(CPACK_DEBIAN_PYTHON_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3:any, python3-numpy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "python3-tomlkit, softfinger")
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA
  "${packages}/python3-softfinger/postinst;${packages}/python3-softfinger/prerm")
include(CPack)
