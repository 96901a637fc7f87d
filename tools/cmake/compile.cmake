# How everything is compiled: language, warnings, sanitizers, compiler cache.
option(RAYSTEER_TESTS "build tests and benchmarks" ON)
set(RAYSTEER_SANITIZE "" CACHE STRING "sanitizers for -fsanitize=, for example address,undefined")
option(RAYSTEER_COVERAGE "count executed lines" OFF)

option(RAYSTEER_FUZZ "build libFuzzer programs instead of tests (clang only)" OFF)
if(RAYSTEER_FUZZ)
  set(RAYSTEER_TESTS OFF)
  set(RAYSTEER_SANITIZE "fuzzer-no-link,address,undefined")
endif()

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

find_program(RAYSTEER_CCACHE ccache)
if(RAYSTEER_CCACHE)
  # The sloppiness is what ccache's manual asks for to cache files that use a precompiled header.
  set(CMAKE_CXX_COMPILER_LAUNCHER
    ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
    CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1
    ${RAYSTEER_CCACHE})
  if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    add_compile_options(-fpch-preprocess)
  else()
    add_compile_options("SHELL:-Xclang -fno-pch-timestamp")
  endif()
endif()

add_library(raysteer_options INTERFACE)
target_include_directories(raysteer_options INTERFACE ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR}/generated)
target_compile_options(raysteer_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wnon-virtual-dtor -Wold-style-cast
  -Woverloaded-virtual -Wswitch -Werror
  # g++ 12 raises these falsely for "text" + std::string (GCC bug 105651).
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
  $<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overflow>
  $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds>
  # clang tells of every `omp simd` loop that a sanitizer keeps it from vectorising.
  $<$<CXX_COMPILER_ID:Clang>:-Wno-pass-failed>)
if(RAYSTEER_SANITIZE)
  target_compile_options(raysteer_options INTERFACE -fsanitize=${RAYSTEER_SANITIZE} -fno-omit-frame-pointer
    -fno-sanitize-recover=undefined
    # In Eigen's inline functions these two double g++'s time. A null pointer still stops the address sanitizer, and what
    # reads bytes is fuzzed with both, by clang.
    $<$<CXX_COMPILER_ID:GNU>:-fno-sanitize=null,alignment>)
  target_link_options(raysteer_options INTERFACE -fsanitize=${RAYSTEER_SANITIZE})
endif()
if(RAYSTEER_COVERAGE)
  target_compile_options(raysteer_options INTERFACE --coverage -O0)
  target_link_options(raysteer_options INTERFACE --coverage)
endif()
