# What nearly every source includes is compiled once: reading headers is most of what building takes.
# The preset asan builds without, so that a source that leans on it does not get far.
file(GENERATE OUTPUT ${PROJECT_BINARY_DIR}/headers.cpp CONTENT "")

# gyrotwin_compile_headers(NAME HEADER...): these and what everybody includes, with this directory's flags
function(gyrotwin_compile_headers name)
  add_library(${name} OBJECT ${PROJECT_BINARY_DIR}/headers.cpp)
  target_link_libraries(${name} PRIVATE Eigen3::Eigen)
  target_precompile_headers(${name} PRIVATE ${ARGN} <Eigen/Geometry> <algorithm> <array> <atomic>
                            <chrono> <cmath> <condition_variable> <cstdint> <filesystem> <fstream>
                            <functional> <iostream> <map> <memory> <mutex> <numeric> <optional> <set>
                            <span> <string> <string_view> <thread> <tuple> <utility> <variant> <vector>)
endfunction()
gyrotwin_compile_headers(gyrotwin_headers)

# gyrotwin_precompile(DIRECTORY...): for all C++ targets in them and below
function(gyrotwin_precompile)
  foreach(directory IN LISTS ARGN)
    get_property(targets DIRECTORY ${directory} PROPERTY BUILDSYSTEM_TARGETS)
    foreach(target IN LISTS targets)
      get_target_property(sources ${target} SOURCES)
      if(sources MATCHES "\\.cpp")
        target_precompile_headers(${target} REUSE_FROM gyrotwin_headers)
      endif()
    endforeach()
    get_property(folders DIRECTORY ${directory} PROPERTY SUBDIRECTORIES)
    gyrotwin_precompile(${folders})
  endforeach()
endfunction()
