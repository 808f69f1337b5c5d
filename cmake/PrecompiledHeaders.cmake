# Builds from nothing parse Eigen and the standard library once instead of once a file. Off by default:
# compiler caches and editors are better served without, and a header that forgets an include shows.
option(SOFTFINGER_PRECOMPILED_HEADERS "Precompile Eigen and standard headers" OFF)

# softfinger_precompile_headers(TARGET KIND): for modules (KIND library) or tests (KIND test). All of a
# kind share one precompiled header, which therefore knows no definition that any of them lacks.
function(softfinger_precompile_headers target kind)
  if(SOFTFINGER_PRECOMPILED_HEADERS)
    target_precompile_headers(${target} REUSE_FROM softfinger_${kind}_headers)
  endif()
endfunction()

if(SOFTFINGER_PRECOMPILED_HEADERS)
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
    target_precompile_headers(softfinger_test_headers PRIVATE ${headers} <gmock/gmock.h> <gtest/gtest.h>)
  endif()
endif()
