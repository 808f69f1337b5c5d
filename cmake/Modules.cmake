# softfinger_module(NAME [MODULES m...] [LIBRARIES l...])
#
# One static library softfinger_NAME, alias softfinger::NAME, of every source beside this list.
# MODULES repeats the module's line of the table in docs/architecture.md (checked by
# tools/check_layers); LIBRARIES are third-party and stay out of the module's headers.
function(softfinger_module name)
  cmake_parse_arguments(arg "" "" "MODULES;LIBRARIES" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  file(GLOB headers CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.hpp)
  set(target softfinger_${name})
  if(sources)
    add_library(${target} STATIC ${sources} ${headers})
    set(scope PUBLIC)
    _softfinger_private_libraries(libraries ${arg_LIBRARIES})
    target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:softfinger_compiler> ${libraries})
    softfinger_precompile_headers(${target} library)
  else()
    add_library(${target} INTERFACE)
    set(scope INTERFACE)
  endif()
  add_library(softfinger::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(${target} ${scope}
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  if(NOT name STREQUAL base)
    list(PREPEND arg_MODULES base)
  endif()
  list(TRANSFORM arg_MODULES PREPEND softfinger_ OUTPUT_VARIABLE modules)
  target_link_libraries(${target} ${scope} Eigen3::Eigen ${modules})
  target_compile_features(${target} ${scope} cxx_std_20)
  set_property(GLOBAL APPEND PROPERTY SOFTFINGER_TARGETS ${target})
endfunction()

# Libraries of headers only are needed to build a module, not to link with it once installed.
function(_softfinger_private_libraries result)
  set(headers_only Boost::headers nlohmann_json::nlohmann_json)
  set(libraries "")
  foreach(library IN LISTS ARGN)
    if(library IN_LIST headers_only)
      set(library $<BUILD_INTERFACE:${library}>)
    endif()
    list(APPEND libraries ${library})
  endforeach()
  set(${result} ${libraries} PARENT_SCOPE)
endfunction()

# softfinger_test(NAME [LIBRARIES l...]): tests/NAME/*.cpp as one GoogleTest program NAME_test.
function(softfinger_test name)
  cmake_parse_arguments(arg "" "" "LIBRARIES" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${name}/*.cpp)
  if(NOT sources)
    return()
  endif()
  add_executable(${name}_test ${sources})
  target_link_libraries(${name}_test PRIVATE ${arg_LIBRARIES} softfinger_compiler GTest::gmock GTest::gtest_main)
  softfinger_precompile_headers(${name}_test test)
  target_compile_definitions(${name}_test PRIVATE
    SOFTFINGER_SOURCE_DIR="${PROJECT_SOURCE_DIR}" SOFTFINGER_PROGRAM="${PROJECT_BINARY_DIR}/softfinger")
  # Two builds that are tested at once must not write over each other's files.
  set(temporary ${CMAKE_CURRENT_BINARY_DIR}/temporary)
  file(MAKE_DIRECTORY ${temporary})
  gtest_discover_tests(${name}_test TEST_PREFIX "${name}." NO_PRETTY_VALUES DISCOVERY_TIMEOUT 60
    PROPERTIES LABELS ${name} TIMEOUT 300 ENVIRONMENT TEST_TMPDIR=${temporary})
endfunction()
