# libgyrotwin-dev: what the author of a peer on the bus or of a device on the line needs.
get_target_property(types gyrotwin_messages GYROTWIN_LCM_FILES)
install(FILES ${types} DESTINATION share/gyrotwin/lcm COMPONENT dev)
install(DIRECTORY ${PROJECT_BINARY_DIR}/messages/generated/gyrotwin DESTINATION include COMPONENT dev)
install(FILES ${PROJECT_SOURCE_DIR}/messages/channels.hpp DESTINATION include/gyrotwin COMPONENT dev)
install(FILES ${PROJECT_SOURCE_DIR}/messages/README.md DESTINATION share/doc/libgyrotwin-dev RENAME wire.md
        COMPONENT dev)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/services/hardware/firmware DESTINATION share/gyrotwin COMPONENT dev
        PATTERN CMakeLists.txt EXCLUDE)

include(CMakePackageConfigHelpers)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/gyrotwin-config-version.cmake
                                 COMPATIBILITY SameMinorVersion ARCH_INDEPENDENT)
install(FILES package/gyrotwin-config.cmake ${PROJECT_BINARY_DIR}/gyrotwin-config-version.cmake
        DESTINATION lib/cmake/gyrotwin COMPONENT dev)
