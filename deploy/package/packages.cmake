# Three Debian packages: cpack, or deploy/package/build.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME gyrotwin)
set(CPACK_PACKAGE_VENDOR gyrotwin)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # else it would be the first line of every package's
set(CPACK_PACKAGE_CONTACT "The gyrotwin authors <gyrotwin@localhost>")
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_SOURCE_DIR}/build/packages)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL gyrotwin dev)
if(TARGET page)
  list(APPEND CPACK_COMPONENTS_ALL dashboard)
endif()

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_SECTION science)

set(CPACK_DEBIAN_GYROTWIN_PACKAGE_NAME gyrotwin)
set(CPACK_COMPONENT_GYROTWIN_DESCRIPTION "${PROJECT_DESCRIPTION}
Daemons, clients, rig files, and systemd units that run them: integrator, hardware, controller, mirror,
gateway and recorder of a rig, on one host or several. No rig is started by itself.")
set(CPACK_DEBIAN_GYROTWIN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_GYROTWIN_PACKAGE_DEPENDS
    "systemd | systemd-standalone-sysusers, systemd | systemd-standalone-tmpfiles")
set(CPACK_DEBIAN_GYROTWIN_PACKAGE_RECOMMENDS gyrotwin-dashboard)
set(scripts ${CMAKE_CURRENT_SOURCE_DIR}/package)
set(CPACK_DEBIAN_GYROTWIN_PACKAGE_CONTROL_EXTRA ${scripts}/postinst ${scripts}/prerm ${scripts}/postrm)

set(CPACK_DEBIAN_DASHBOARD_PACKAGE_NAME gyrotwin-dashboard)
set(CPACK_COMPONENT_DASHBOARD_DESCRIPTION "Page of a gyrotwin rig, for a browser
What `gyrotwin gateway` serves: the platform in three dimensions, charts, margins, and its operation.")
set(CPACK_DEBIAN_DASHBOARD_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_DASHBOARD_PACKAGE_ENHANCES gyrotwin)

set(CPACK_DEBIAN_DEV_PACKAGE_NAME libgyrotwin-dev)
set(CPACK_COMPONENT_DEV_DESCRIPTION "Messages, firmware library and Python package of gyrotwin
For authors of peers on a rig's bus (LCM types, C++ headers, a Python package) and of devices on its
line (a library in C99, as source).")
set(CPACK_DEBIAN_DEV_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS liblcm-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SUGGESTS python3)

install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION share/doc/gyrotwin RENAME copyright COMPONENT gyrotwin)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION share/doc/libgyrotwin-dev RENAME copyright COMPONENT dev)
if(TARGET page)
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION share/doc/gyrotwin-dashboard RENAME copyright
          COMPONENT dashboard)
endif()
include(CPack)
