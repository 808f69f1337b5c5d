# softfinger_viewer_page(TARGET): builds the live page (viewer/page, TypeScript) with npm in the build
# folder and compiles it into TARGET, so that the program needs no files beside it.
option(SOFTFINGER_LIVE_PAGE "Build the live page into the viewer (needs Node.js 18 or newer, npm)" ON)

function(softfinger_viewer_page target)
  set(source ${CMAKE_CURRENT_SOURCE_DIR}/page)
  set(work ${CMAKE_CURRENT_BINARY_DIR}/page)
  set(client ${PROJECT_SOURCE_DIR}/clients/javascript/src)
  set(embed ${PROJECT_SOURCE_DIR}/cmake/embed_page.cmake)
  set(output ${CMAKE_CURRENT_BINARY_DIR}/live_page.cpp)
  target_sources(${target} PRIVATE ${output})

  if(NOT SOFTFINGER_LIVE_PAGE)
    file(WRITE ${work}/none/index.html
      "<!doctype html><title>softfinger</title><p>Built without the live page (SOFTFINGER_LIVE_PAGE=OFF).\n")
    add_custom_command(OUTPUT ${output}
      COMMAND ${CMAKE_COMMAND} -DPAGE=${work}/none -DOUTPUT=${output} -P ${embed}
      DEPENDS ${embed} VERBATIM)
    return()
  endif()

  find_program(SOFTFINGER_NPM npm)
  find_program(SOFTFINGER_NODE NAMES node nodejs)
  if(NOT SOFTFINGER_NPM OR NOT SOFTFINGER_NODE)
    message(FATAL_ERROR "The live page is built with Node.js 18 or newer and npm, and they were not found. "
      "On Debian: apt-get install nodejs npm. Or configure with -DSOFTFINGER_LIVE_PAGE=OFF.")
  endif()
  execute_process(COMMAND ${SOFTFINGER_NODE} --version OUTPUT_VARIABLE version OUTPUT_STRIP_TRAILING_WHITESPACE)
  string(REGEX REPLACE "^v" "" version "${version}")
  if(version VERSION_LESS 18)
    message(FATAL_ERROR "The live page is built with Node.js 18 or newer; ${SOFTFINGER_NODE} is ${version}.")
  endif()

  # Packages are fetched again only when their list changes.
  set(packages ${source}/package.json ${source}/package-lock.json ${source}/.npmrc)
  add_custom_command(OUTPUT ${work}/packages.stamp
    COMMAND ${CMAKE_COMMAND} -E make_directory ${work}
    COMMAND ${CMAKE_COMMAND} -E copy ${packages} ${work}
    COMMAND ${SOFTFINGER_NPM} ci --prefix ${work} --ignore-scripts --no-audit --no-fund --loglevel=error
    COMMAND ${CMAKE_COMMAND} -E touch ${work}/packages.stamp
    DEPENDS ${packages} WORKING_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}
    COMMENT "Fetching the packages of the live page" VERBATIM)

  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${source}/src/* ${source}/public/* ${client}/*)
  # As far from the page as in the sources.
  cmake_path(RELATIVE_PATH client BASE_DIRECTORY ${source} OUTPUT_VARIABLE client_from_page)
  cmake_path(ABSOLUTE_PATH client_from_page BASE_DIRECTORY ${work} NORMALIZE OUTPUT_VARIABLE client_copy)
  set(settings ${source}/index.html ${source}/study.html ${source}/tsconfig.json ${source}/vite.config.ts)
  add_custom_command(OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -E rm -rf ${work}/src ${work}/public ${work}/dist ${client_copy}
    COMMAND ${CMAKE_COMMAND} -E copy_directory ${client} ${client_copy}
    COMMAND ${CMAKE_COMMAND} -E copy_directory ${source}/src ${work}/src
    COMMAND ${CMAKE_COMMAND} -E copy_directory ${source}/public ${work}/public
    COMMAND ${CMAKE_COMMAND} -E copy ${settings} ${work}
    COMMAND ${SOFTFINGER_NPM} run --prefix ${work} --silent build
    COMMAND ${CMAKE_COMMAND} -DPAGE=${work}/dist -DOUTPUT=${output} -P ${embed}
    DEPENDS ${sources} ${settings} ${embed} ${work}/packages.stamp
    WORKING_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}
    COMMENT "Building the live page" VERBATIM)
endfunction()
