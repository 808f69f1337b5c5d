# Run by ctest: install, configure, build, run; each from nothing.
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  message("${output}")
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "failed (${status}): ${ARGN}")
  endif()
endfunction()

file(REMOVE_RECURSE ${WORK}/prefix ${WORK}/moved ${WORK}/c_source ${WORK}/source ${WORK}/build)
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
# The shared library, as pkg-config tells of it; from a prefix that has moved since.
file(RENAME ${WORK}/prefix ${WORK}/moved)
file(COPY ${EXAMPLE}/../c_program/ DESTINATION ${WORK}/c_source)
set(ENV{PKG_CONFIG_PATH} ${WORK}/moved/${LIBDIR}/pkgconfig)
run(make -C ${WORK}/c_source CC=${C_COMPILER})
run(${WORK}/c_source/touch ${WORK}/moved/${DATADIR}/softfinger/scenes/sphere.toml)
file(RENAME ${WORK}/moved ${WORK}/prefix)
# A copy, so that nothing of the tree can be found by a relative path.
file(COPY ${EXAMPLE}/ DESTINATION ${WORK}/source)
run(${CMAKE_COMMAND} -S ${WORK}/source -B ${WORK}/build -G ${GENERATOR} -DCMAKE_BUILD_TYPE=Release
  -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_PREFIX_PATH=${WORK}/prefix)
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${WORK}/build/own_program ${WORK}/prefix/${DATADIR}/softfinger/scenes/sphere.toml)
