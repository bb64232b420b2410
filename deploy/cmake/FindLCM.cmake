# LCM, found by its files: Debian 12 has neither a config package nor a usable .pc file for it. Sets
# LCM_GEN_EXECUTABLE, LCM_INCLUDE_DIRS and the target LCM::liblcm, which only tests link: daemons
# speak LCM's wire themselves.
find_program(LCM_GEN_EXECUTABLE lcm-gen)
find_path(LCM_INCLUDE_DIRS lcm/lcm_coretypes.h)
find_library(LCM_LIBRARY lcm)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(
  LCM REQUIRED_VARS LCM_GEN_EXECUTABLE LCM_INCLUDE_DIRS LCM_LIBRARY
  REASON_FAILURE_MESSAGE "install it with: apt-get install liblcm-dev liblcm-bin")

if(LCM_FOUND AND NOT TARGET LCM::liblcm)
  add_library(LCM::liblcm UNKNOWN IMPORTED)
  set_target_properties(LCM::liblcm PROPERTIES IMPORTED_LOCATION ${LCM_LIBRARY}
                        INTERFACE_INCLUDE_DIRECTORIES ${LCM_INCLUDE_DIRS})
endif()
mark_as_advanced(LCM_GEN_EXECUTABLE LCM_INCLUDE_DIRS LCM_LIBRARY)
