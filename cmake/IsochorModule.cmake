# One helper for each kind of target, so that every layer is declared the same way.

# Compile options shared by all of Isochor's own targets.
add_library(isochor_options INTERFACE)
target_compile_features(isochor_options INTERFACE cxx_std_17)
target_compile_options(isochor_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
  -ffp-contract=off  # fused multiply-add only where the code asks for it
  $<$<BOOL:${ISOCHOR_WERROR}>:-Werror>)

# Headers to precompile, by ISOCHOR_PCH. Tests get all of the standard library from googletest anyway;
# a module whose sources forget an include shows in any build but `all`.
set(isochor_test_pch "")
set(isochor_module_pch "")
if(ISOCHOR_PCH STREQUAL "tests")
  set(isochor_test_pch <gtest/gtest.h>)
elseif(ISOCHOR_PCH STREQUAL "all")
  set(isochor_module_pch
    <algorithm> <array> <cmath> <cstdint> <functional> <limits> <map> <memory> <numeric> <optional> <set>
    <sstream> <string> <unordered_map> <utility> <vector> <Eigen/Dense>)
  set(isochor_test_pch <gmock/gmock.h> <gtest/gtest.h> <random> ${isochor_module_pch})
elseif(ISOCHOR_PCH)
  message(FATAL_ERROR "ISOCHOR_PCH is '${ISOCHOR_PCH}', not tests, all or OFF")
endif()

# Precompiles the headers for the first target that asks; the others share them, for the flags agree.
function(isochor_precompile target first)
  if(NOT ARGN)
    return()
  endif()
  if(target STREQUAL first)
    target_precompile_headers(${target} PRIVATE ${ARGN})
  else()
    target_precompile_headers(${target} REUSE_FROM ${first})
  endif()
  target_compile_options(${target} PRIVATE -fpch-preprocess)  # ccache asks for it
endfunction()

# isochor_add_module(<layer> [SOURCES ...] HEADERS ... [DEPENDS layer ...] [LINK public ...] [PRIVATE_LINK ...])
# declares the library isochor::<layer> from the files of src/isochor/<layer>. Header-only libraries
# under PRIVATE_LINK stay out of the installed package: its users never see them.
function(isochor_add_module layer)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;HEADERS;DEPENDS;LINK;PRIVATE_LINK")
  set(target isochor_${layer})
  set(private_link "")
  foreach(library IN LISTS arg_PRIVATE_LINK)
    set(type "")
    if(TARGET ${library})
      get_target_property(type ${library} TYPE)
    endif()
    if(type STREQUAL "INTERFACE_LIBRARY")
      list(APPEND private_link $<BUILD_INTERFACE:${library}>)
    else()
      list(APPEND private_link ${library})
    endif()
  endforeach()
  if(arg_SOURCES)
    set(scope PUBLIC)
    add_library(${target} ${arg_SOURCES})
    target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:isochor_options> ${private_link})
    isochor_precompile(${target} isochor_base ${isochor_module_pch})
  else()
    set(scope INTERFACE)
    add_library(${target} INTERFACE)
  endif()
  add_library(isochor::${layer} ALIAS ${target})
  set_target_properties(${target} PROPERTIES
    EXPORT_NAME ${layer}
    POSITION_INDEPENDENT_CODE ON
    VERIFY_INTERFACE_HEADER_SETS ON)
  target_compile_features(${target} ${scope} cxx_std_17)
  target_sources(${target} ${scope}
    FILE_SET HEADERS BASE_DIRS "${PROJECT_SOURCE_DIR}/src" FILES ${arg_HEADERS})
  list(TRANSFORM arg_DEPENDS PREPEND isochor_)
  target_link_libraries(${target} ${scope} ${arg_DEPENDS} ${arg_LINK})
  install(TARGETS ${target} EXPORT isochor-targets
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
    FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
endfunction()

# isochor_add_tests(<layer> SOURCES ... [SLOW_SOURCES ...] [LINK ...]) declares the test program of one
# layer. The tests of SLOW_SOURCES, a program of their own, carry the label `slow` instead of the layer's
# (gtest_discover_tests can pass on only one): the sanitizer run leaves them out.
function(isochor_add_tests layer)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;SLOW_SOURCES;LINK")
  if(arg_SOURCES)
    isochor_add_test_program(isochor_${layer}_tests ${layer} "${arg_SOURCES}" "${arg_LINK}" "${layer}")
  endif()
  if(arg_SLOW_SOURCES)
    isochor_add_test_program(isochor_${layer}_slow_tests ${layer} "${arg_SLOW_SOURCES}" "${arg_LINK}" "slow")
  endif()
endfunction()

function(isochor_add_test_program target layer sources link labels)
  add_executable(${target} ${sources})
  target_include_directories(${target} PRIVATE "${PROJECT_SOURCE_DIR}/tests")
  target_link_libraries(${target} PRIVATE isochor_options ${link} GTest::gmock GTest::gtest_main)
  target_compile_options(${target} PRIVATE ${ISOCHOR_TEST_OPTIONS})
  isochor_precompile(${target} isochor_base_tests ${isochor_test_pch})
  target_compile_definitions(${target} PRIVATE
    ISOCHOR_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
    ISOCHOR_BINARY_DIR="${CMAKE_BINARY_DIR}")
  gtest_discover_tests(${target} TEST_PREFIX "${layer}." DISCOVERY_TIMEOUT 120
    PROPERTIES TIMEOUT 600 LABELS "${labels}")
endfunction()
