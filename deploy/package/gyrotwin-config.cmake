# For peers of gyrotwin:
#   find_package(gyrotwin REQUIRED)
#   target_link_libraries(my_peer PRIVATE gyrotwin::messages)   # types, channels; and liblcm, to send them
#   target_link_libraries(my_board PRIVATE gyrotwin::firmware)  # C99, the device's side of the line
get_filename_component(gyrotwin_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)

if(NOT TARGET gyrotwin::messages)
  add_library(gyrotwin::messages INTERFACE IMPORTED)
  target_include_directories(gyrotwin::messages INTERFACE "${gyrotwin_prefix}/include")
  target_compile_features(gyrotwin::messages INTERFACE cxx_std_20)
  target_link_libraries(gyrotwin::messages INTERFACE lcm)
  # LCM's generated code stores doubles through pointers to integers.
  target_compile_options(gyrotwin::messages INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-fno-strict-aliasing>)
endif()

if(NOT TARGET gyrotwin::firmware)
  set(gyrotwin_firmware "${gyrotwin_prefix}/share/gyrotwin/firmware")
  add_library(gyrotwin::firmware INTERFACE IMPORTED)
  target_include_directories(gyrotwin::firmware INTERFACE "${gyrotwin_firmware}")
  foreach(part frame wire outbox device)
    target_sources(gyrotwin::firmware INTERFACE "${gyrotwin_firmware}/gyrotwin_${part}.c")
  endforeach()
endif()
unset(gyrotwin_prefix)
unset(gyrotwin_firmware)
