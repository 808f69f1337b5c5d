# Builds from nothing parse Eigen, the standard library and a target's own headers once instead of once a
# file: headers are precompiled, and all sources of a target are compiled as one. Off by default: compiler caches and
# editors are better served without, and a header that forgets an include shows.
option(SOFTFINGER_QUICK_BUILD "Precompile headers and compile sources together" OFF)

# Most of what tests cost is to compile them.
set(SOFTFINGER_TEST_OPTIONS $<$<CONFIG:Release>:-O1>)
if(SOFTFINGER_QUICK_BUILD)
  # Failures are told with the name of their file, not with its path: so tests are the same in every checkout, and
  # what one has compiled is in the compiler cache for all.
  list(APPEND SOFTFINGER_TEST_OPTIONS -Wno-builtin-macro-redefined -D__FILE__=__FILE_NAME__)
endif()

# Not with Clang: CMake hands it precompiled headers by paths that a compiler cache takes for another program in another
# checkout, and where all of a target is one compilation there is little to share.
set(SOFTFINGER_PRECOMPILE ${SOFTFINGER_QUICK_BUILD})
if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  set(SOFTFINGER_PRECOMPILE OFF)
endif()

# softfinger_quick_build(TARGET KIND): for modules (KIND library), tests (KIND test) or other programs (KIND program).
# All modules, and all tests, share one precompiled header, which therefore knows no definition that any of them lacks.
function(softfinger_quick_build target kind)
  if(SOFTFINGER_QUICK_BUILD)
    if(SOFTFINGER_PRECOMPILE AND NOT kind STREQUAL "program")
      target_precompile_headers(${target} REUSE_FROM softfinger_${kind}_headers)
    endif()
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 0)
  endif()
endfunction()

if(SOFTFINGER_QUICK_BUILD)
  # GCC takes 1 GB before it first looks for memory to use again, which is a tenth of its time.
  add_compile_options($<$<COMPILE_LANG_AND_ID:CXX,GNU>:--param=ggc-min-expand=200>
    $<$<COMPILE_LANG_AND_ID:CXX,GNU>:--param=ggc-min-heapsize=1048576>)
endif()
if(SOFTFINGER_PRECOMPILE)
  set(headers
    <Eigen/Core> <Eigen/Geometry>
    <algorithm> <array> <atomic> <chrono> <cmath> <cstdint> <filesystem> <functional> <map> <memory> <optional>
    <span> <string> <string_view> <thread> <utility> <variant> <vector>)
  file(WRITE ${PROJECT_BINARY_DIR}/precompiled.cpp "// Owner of the precompiled headers.\n")

  add_library(softfinger_library_headers STATIC ${PROJECT_BINARY_DIR}/precompiled.cpp)
  target_link_libraries(softfinger_library_headers PRIVATE softfinger_compiler Eigen3::Eigen)
  target_precompile_headers(softfinger_library_headers PRIVATE ${headers})

  if(SOFTFINGER_BUILD_TESTS)
    add_executable(softfinger_test_headers ${PROJECT_BINARY_DIR}/precompiled.cpp)
    target_link_libraries(softfinger_test_headers PRIVATE softfinger_compiler Eigen3::Eigen GTest::gmock GTest::gtest_main)
    target_compile_options(softfinger_test_headers PRIVATE ${SOFTFINGER_TEST_OPTIONS})
    target_precompile_headers(softfinger_test_headers PRIVATE ${headers} <gmock/gmock.h> <gtest/gtest.h>)
  endif()
endif()
