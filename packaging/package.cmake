# cmake --build --preset release --target package: raysteer_<version>_<arch>.deb, the host tool and the pretend rig.
include(GNUInstallDirs)
install(TARGETS raysteer raysteer-sim RUNTIME)
install(DIRECTORY boards scenes surveys stations plans DESTINATION ${CMAKE_INSTALL_DATADIR}/raysteer)
install(FILES README.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES packaging/copyright DESTINATION ${CMAKE_INSTALL_DOCDIR})
# Debian keeps its changelog compressed; -n leaves the time out, so that the package's bytes do not depend on it.
add_custom_command(OUTPUT ${CMAKE_BINARY_DIR}/changelog.gz
  COMMAND gzip -9nc ${PROJECT_SOURCE_DIR}/packaging/changelog > ${CMAKE_BINARY_DIR}/changelog.gz
  DEPENDS packaging/changelog VERBATIM)
add_custom_command(OUTPUT ${CMAKE_BINARY_DIR}/raysteer-sim.1.gz
  COMMAND gzip -9nc ${PROJECT_SOURCE_DIR}/packaging/raysteer-sim.1 > ${CMAKE_BINARY_DIR}/raysteer-sim.1.gz
  DEPENDS packaging/raysteer-sim.1 VERBATIM)
add_custom_target(changelog ALL DEPENDS ${CMAKE_BINARY_DIR}/changelog.gz ${CMAKE_BINARY_DIR}/raysteer-sim.1.gz)
install(FILES ${CMAKE_BINARY_DIR}/raysteer-sim.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES ${CMAKE_BINARY_DIR}/changelog.gz DESTINATION ${CMAKE_INSTALL_DOCDIR})

# Manual page, completions and JSON schemas come from the program's own command tree. Sanitized programs are not
# packaged and too slow to run in every build.
if(NOT RAYSTEER_SANITIZE)
  set(tree ${CMAKE_BINARY_DIR}/tree)
  add_custom_command(OUTPUT ${tree}/raysteer.1.gz ${tree}/raysteer ${tree}/_raysteer ${tree}/raysteer.fish
    COMMAND ${CMAKE_COMMAND} -E make_directory ${tree}
    COMMAND $<TARGET_FILE:raysteer> help --man > ${tree}/raysteer.1
    COMMAND gzip -9nf ${tree}/raysteer.1
    COMMAND $<TARGET_FILE:raysteer> completion bash > ${tree}/raysteer
    COMMAND $<TARGET_FILE:raysteer> completion zsh > ${tree}/_raysteer
    COMMAND $<TARGET_FILE:raysteer> completion fish > ${tree}/raysteer.fish
    DEPENDS raysteer VERBATIM)
  add_custom_target(tree ALL DEPENDS ${tree}/raysteer.1.gz)
  install(FILES ${tree}/raysteer.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
  install(FILES ${tree}/raysteer DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
  install(FILES ${tree}/_raysteer DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions)
  install(FILES ${tree}/raysteer.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
  install(DIRECTORY docs/json/ DESTINATION ${CMAKE_INSTALL_DATADIR}/raysteer/schema)
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME raysteer)
set(CPACK_PACKAGE_VENDOR "The Raysteer developers")
set(CPACK_PACKAGE_CONTACT "The Raysteer developers <raysteer@localhost.localdomain>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "calibrate and scan with projector and cameras")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
"Raysteer puts a steered projector's picture where you said, and measures by
how many millimetres it missed. This is the tool for the laptop: it checks
recorded sessions, calibrates cameras and projectors, scans surfaces with
structured light, and reports how sure it is and where it is not. A pretend
rig in a ray-traced room stands in for one of metal and glass.")
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
include(CPack)
