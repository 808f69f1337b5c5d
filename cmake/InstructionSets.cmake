# softfinger_instruction_sets(TARGET STEM): STEM_baseline.cpp, STEM_avx2.cpp and STEM_avx512.cpp hold
# the same kernels; each is compiled for its own instruction set. Elsewhere than on x86-64 only the
# baseline remains.
function(softfinger_instruction_sets target stem)
  # GCC fuses alike in every copy of a template, Clang does not, and copies must have the same bits.
  set(common "-Wno-psabi;-ffp-contract=$<IF:$<CXX_COMPILER_ID:GNU>,fast,off>;-fno-math-errno")
  set_source_files_properties(${stem}_baseline.cpp ${stem}_avx2.cpp ${stem}_avx512.cpp
    PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
  set_source_files_properties(${stem}_baseline.cpp PROPERTIES COMPILE_OPTIONS "${common}")
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    set_source_files_properties(${stem}_avx2.cpp PROPERTIES COMPILE_OPTIONS "${common};-mavx2;-mfma")
    set_source_files_properties(${stem}_avx512.cpp PROPERTIES COMPILE_OPTIONS
      "${common};-mavx2;-mfma;-mavx512f;-mavx512vl;-mavx512dq")
  else()
    set_source_files_properties(${stem}_avx2.cpp ${stem}_avx512.cpp PROPERTIES HEADER_FILE_ONLY ON)
  endif()
endfunction()
