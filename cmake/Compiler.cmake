# Language level, warnings and sanitizers for every target of the project.
option(SOFTFINGER_WARNINGS_AS_ERRORS "Warnings stop the build" ${PROJECT_IS_TOP_LEVEL})
set(SOFTFINGER_SANITIZE "" CACHE STRING "Sanitizers for everything built: address,undefined or thread")

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(PROJECT_IS_TOP_LEVEL AND NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

set(SOFTFINGER_COUNTED "" CACHE STRING "Modules that count which of their branches are taken (GCC)")
set(SOFTFINGER_CHANGED "" CACHE STRING "Modules whose sources are changed and compiled one by one")
if(SOFTFINGER_COUNTED)
  add_link_options(--coverage)
endif()

add_library(softfinger_compiler INTERFACE)
target_compile_options(softfinger_compiler INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Wnon-virtual-dtor
  -Wold-style-cast -Woverloaded-virtual
  # Members have defaults; naming some of them is how options are given.
  -Wno-missing-field-initializers
  # Results must not depend on which expressions the compiler fuses; kernels say so where they want it.
  -ffp-contract=off)
if(SOFTFINGER_WARNINGS_AS_ERRORS)
  target_compile_options(softfinger_compiler INTERFACE -Werror)
endif()
if(NOT SOFTFINGER_SANITIZE)
  # Programs that listen and drive motors: a defect of memory ends them instead of being led on.
  add_compile_options(-fstack-protector-strong)
  add_compile_definitions($<$<CONFIG:Release,RelWithDebInfo>:_FORTIFY_SOURCE=2>)
  add_link_options(LINKER:-z,relro,-z,now)
endif()
if(SOFTFINGER_SANITIZE)
  add_compile_options(-fsanitize=${SOFTFINGER_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  if(SOFTFINGER_SANITIZE MATCHES "address.*undefined")
    # AddressSanitizer sees bad pointers too; checking each a second time triples the compile time.
    add_compile_options(-fno-sanitize=null,alignment,vptr,object-size)
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    add_compile_options(-Wno-maybe-uninitialized)  # what sanitizers add misleads it, as GCC's manual says
  endif()
  add_compile_definitions(SOFTFINGER_SANITIZED)
  add_link_options(-fsanitize=${SOFTFINGER_SANITIZE})
  if(SOFTFINGER_SANITIZE MATCHES "thread" AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    add_compile_options(-Wno-tsan)  # Asio's headers use fences, which this sanitizer does not model
  endif()
endif()
